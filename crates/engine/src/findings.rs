//! What the observables of a run found, and what speaks against it.

use lennard_core::{Average, Doubt, Findings, ThermostatSpec};
use lennard_observables::Equilibrium;
use lennard_observables::quantities::{Mark, has_mark};
use lennard_scene::Scene;

use crate::Simulation;
use crate::baths::measured_baths;
use crate::exchange;

impl Simulation {
    /// Averages, tables and remarks of all observables over one part of the run, thermodynamics first. Each average has what
    /// speaks against it. The run may be too short or not in equilibrium, or the thermostat may change what is measured. An
    /// average that is no result has no standard error.
    #[must_use]
    pub fn findings(&self) -> Vec<Findings> {
        let equilibrium = self.thermodynamics().equilibrium();
        let baths = measured_baths(&self.scene);
        let by_exchange = exchange::doubt(&self.scene);
        let by_bonds = by_bonds(&self.scene);
        let mut findings: Vec<Findings> = self
            .observers
            .iter()
            .map(|observer| {
                let observable = &observer.observable;
                let is_profile = exchange::is_profile(observable.as_ref());
                judged(
                    observable.finish(equilibrium.discarded),
                    &equilibrium,
                    observable.spec().dynamic,
                    &baths,
                    by_exchange.clone().filter(|_| !is_profile).or(by_bonds.clone()),
                )
            })
            .collect();
        self.leave_out_meaningless(&mut findings);
        self.tell_tail_of_structure(&mut findings);
        self.add_front(&mut findings);
        self.leave_out_of_frames(&mut findings);
        findings
    }
}

/// Averages with what speaks against each of them; an average that is no result loses its standard error.
pub(crate) fn judged(
    mut findings: Findings,
    equilibrium: &Equilibrium,
    dynamic: bool,
    baths: &[&'static ThermostatSpec],
    by_the_scene: Option<Doubt>,
) -> Findings {
    let judge = |average: Average| {
        let by_bath = by_thermostat(&average.name, dynamic, baths);
        // What speaks against the run speaks first: one reason for all.
        let own = average.doubt.clone();
        let average = Average { doubt: equilibrium.doubt.clone(), ..average };
        with_error_if_earned(average.doubted(own).doubted(by_bath).doubted(by_the_scene.clone()))
    };
    findings.averages = findings.averages.into_iter().map(judge).collect();
    findings
}

/// What bonds of no known ensemble make of means.
fn by_bonds(scene: &Scene) -> Option<Doubt> {
    let why = scene.molecule.as_ref()?.bonds.no_ensemble()?;
    Some(Doubt::Thermostat { why: why.to_owned(), sets_it: false })
}

/// What a thermostat does to a quantity.
fn by_thermostat(
    quantity: &str,
    dynamic: bool,
    baths: &[&'static ThermostatSpec],
) -> Option<Doubt> {
    if let Some(bath) = baths.iter().find(|b| dynamic && !b.keeps_motion) {
        return Some(Doubt::Thermostat {
            why: format!(
                "`{}` kicks each particle: this is the motion with its friction, not the fluid's own",
                bath.name
            ),
            sets_it: false,
        });
    }
    let bath = baths.iter().find(|b| !b.canonical)?;
    let sets_it = has_mark(quantity, Mark::SetByScaling);
    let why = if sets_it {
        format!("set by `{}`, not measured", bath.name)
    } else {
        format!("`{}` samples no known ensemble", bath.name)
    };
    Some(Doubt::Thermostat { why, sets_it })
}

fn with_error_if_earned(mut average: Average) -> Average {
    if average.doubt.as_ref().is_some_and(Doubt::takes_the_error) {
        average.estimate.standard_error = f64::NAN;
    }
    average
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_integrators::thermostats;

    fn spec(name: &str) -> Vec<&'static ThermostatSpec> {
        let found = thermostats().iter().find(|s| s.name == name);
        vec![found.expect("a thermostat of the list")]
    }

    #[test]
    fn friction_is_told_beside_motion_and_scaling_beside_everything() {
        let langevin = spec("langevin");
        assert!(by_thermostat("diffusion_coefficient", true, &langevin).is_some());
        assert_eq!(by_thermostat("pressure", false, &langevin), None);
        assert_eq!(by_thermostat("diffusion_coefficient", true, &spec("bussi")), None);
        let rescale = spec("rescale");
        assert!(by_thermostat("pressure", false, &rescale).is_some());
        let temperature = by_thermostat("temperature", false, &rescale).expect("a doubt");
        let why = temperature.reason(1);
        assert!(why.starts_with("set by `rescale`"), "{why}");
        assert!(temperature.takes_the_error());
    }
}
