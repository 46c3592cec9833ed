//! What acts on the motion of measured stages: heat baths, barostats and the exchange of velocities.

use std::any::Any;

use lennard_core::{Integrator, Ramp, ThermostatSpec};
use lennard_integrators::{ExchangeOptions, Exchanged};
use lennard_observables::{
    BuildContext, Doubt, Driven, Ensemble, ExchangeProfile, HeldTemperature, Observable,
};
use lennard_scene::{Scene, Stage};

use crate::Simulation;
use crate::own::OwnParts;

/// The thermostats of the measured stages.
pub(crate) fn measured_baths(scene: &Scene) -> Vec<&'static ThermostatSpec> {
    scene.measured_stages().filter_map(|s| Some(s.thermostat.as_ref()?.spec())).collect()
}

/// The ensemble that a stage samples; `None` where its dynamics sample none that is known.
pub(crate) fn ensemble(scene: &Scene, stage: &Stage, own: &OwnParts) -> Option<Ensemble> {
    let molecule = scene.molecule.as_ref();
    let by_bonds = molecule.is_some_and(|molecule| molecule.bonds.no_ensemble().is_some());
    if stage.is_ramp() || stage.exchange.is_some() || by_bonds {
        return None;
    }
    let canonical = stage.thermostat.as_ref().is_none_or(|bath| bath.spec().canonical);
    if let Some(control) = &stage.barostat {
        // A barostat without a thermostat beside it has one of its own.
        let pressure = control.pressure;
        return canonical.then_some(Ensemble::Isobaric { pressure });
    }
    match &stage.thermostat {
        Some(bath) => bath.spec().canonical.then_some(Ensemble::Canonical),
        // A method that loses energy stays at no energy.
        None => method(scene, own).spec().symplectic.then_some(Ensemble::Microcanonical),
    }
}

/// A fresh method: of the program where it brings one, else of the scene.
pub(crate) fn method(scene: &Scene, own: &OwnParts) -> Integrator {
    own.make_method().unwrap_or_else(|| lennard_integrators::build(&scene.integrator.method))
}

/// The temperature that the bath of the measured stages holds; `None` where they have none, or not all the same.
#[must_use]
pub fn held_temperature(scene: &Scene) -> Option<HeldTemperature> {
    let mut measured = scene.measured_stages();
    let first = measured.next()?;
    let options = first.thermostat.as_ref()?;
    let bath = options.spec();
    let same = |s: &Stage| s.thermostat == first.thermostat && s.temperature == first.temperature;
    (bath.canonical && !first.is_ramp() && measured.all(same)).then_some(HeldTemperature {
        temperature: first.temperature,
        half_steps: bath.holds_half_steps,
        relaxation: options.relaxation(),
    })
}

/// The pressure that the barostat of the measured stages holds at each step; `None` without one.
pub(crate) fn measured_pressure(scene: &Scene) -> Option<Ramp> {
    let index = scene.stages.iter().position(|s| s.measure)?;
    let first = scene.steps_before(index);
    scene.stages[index].pressure_ramp(first)
}

/// The exchange of the measured stages, which all have the same.
fn measured_exchange(scene: &Scene) -> Option<&ExchangeOptions> {
    scene.measured_stages().next()?.exchange.as_ref()
}

/// The observable that measured stages with an exchange have besides the ones of the scene.
pub(crate) fn profile_of_exchange(
    scene: &Scene,
    context: &BuildContext,
) -> Option<ExchangeProfile> {
    let options = measured_exchange(scene)?;
    let driven = match options.kind {
        Exchanged::Heat => Driven::Heat,
        Exchanged::Momentum => Driven::Momentum(options.along()),
    };
    Some(ExchangeProfile::new(driven, options.axis, options.slabs, context))
}

/// What an exchange makes of the means of other observables.
pub(crate) fn doubt_of_exchange(scene: &Scene) -> Option<Doubt> {
    let options = measured_exchange(scene)?;
    Some(Doubt::Thermostat {
        why: format!(
            "an exchange drives {} through the fluid: a mean over the profile",
            options.kind.name()
        ),
        sets_it: false,
    })
}

/// Whether an observable is the profile of the exchange itself.
pub(crate) fn is_profile(observable: &dyn Observable) -> bool {
    let any: &dyn Any = observable;
    any.is::<ExchangeProfile>()
}

impl Simulation {
    /// Exchanges velocities where that is due. Energy and momentum stay, so that nothing else has to know.
    pub(crate) fn exchange(&mut self) {
        let step = self.state.step;
        let stage = self.current_stage();
        let (measure, options) = (stage.measure, stage.exchange.clone());
        let Some(options) = options.filter(|o| step.is_multiple_of(o.every)) else {
            return;
        };
        let mass = self.system.masses.of(0);
        let state = &mut self.state;
        let carried = options.apply(&state.cell, &state.positions, mass, &mut state.velocities);
        if !measure {
            return;
        }
        for observer in &mut self.observers {
            let any: &mut dyn Any = observer.observable.as_mut();
            if let Some(profile) = any.downcast_mut::<ExchangeProfile>() {
                profile.add_carried(carried);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_a_driven_fluid_say_so_and_keep_their_errors() {
        let text = "[system]\nn_atoms = 256\ndensity = 0.3\ntemperature = 1.5\n[[stage]]\nname = \"a\"\nsteps = 10\n";
        let with = |exchange: &str| {
            let overrides = [("stage.a.exchange".to_owned(), exchange.to_owned())];
            doubt_of_exchange(
                &Scene::parse(text, "scene.toml", &overrides).unwrap_or_else(|e| panic!("{e}")),
            )
        };
        assert_eq!(with("none"), None);
        let doubt = with("momentum").expect("a doubt");
        assert!(!doubt.takes_the_error());
        assert_eq!(
            doubt.reason(1),
            "an exchange drives momentum through the fluid: a mean over the profile"
        );
    }
}
