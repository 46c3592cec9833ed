//! What the observables of a run found, and what speaks against it.

use lennard_core::{State, ThermostatSpec};
use lennard_observables::quantities::{Mark, has_mark, is_of_one_phase};
use lennard_observables::{
    Doubt, Findings, Fronts, LIQUID_DENSITY, Remark, front, frozen, frozen_bytes,
    response_functions, separated,
};
use lennard_scene::Scene;

use crate::Simulation;
use crate::baths::{doubt_of_exchange, is_profile, measured_baths};

impl Simulation {
    /// Averages, tables and remarks of all observables over one part of the run, thermodynamics first. Each average has what
    /// speaks against it. The run may be too short or not in equilibrium, or the thermostat may change what is measured. An
    /// average that is no result has no standard error.
    #[must_use]
    pub fn findings(&self) -> Vec<Findings> {
        let equilibrium = self.thermodynamics().equilibrium();
        let baths = measured_baths(&self.scene);
        let by_exchange = doubt_of_exchange(&self.scene);
        let by_bonds = by_bonds(&self.scene);
        let judged = self.observers.iter().map(|observer| {
            let observable = observer.observable.as_ref();
            let by_exchange = by_exchange.clone().filter(|_| !is_profile(observable));
            let by_scene = by_exchange.or(by_bonds.clone());
            let mut found = observable.finish(equilibrium.discarded);
            for average in &mut found.averages {
                let by_bath = by_thermostat(&average.name, observable.spec().dynamic, &baths);
                // What speaks against the run speaks first: one reason for all.
                let others = [average.doubt.take(), by_bath, by_scene.clone()];
                average.doubt = others.into_iter().fold(equilibrium.doubt.clone(), Doubt::graver);
                if average.doubt.as_ref().is_some_and(Doubt::takes_the_error) {
                    average.estimate.standard_error = f64::NAN;
                }
            }
            found
        });
        let mut findings: Vec<Findings> = judged.collect();
        self.leave_out_meaningless(&mut findings);
        self.tell_tail_of_structure(&mut findings);
        self.add_front(&mut findings);
        self.leave_out_of_frames(&mut findings);
        findings
    }

    /// Leaves out of the findings what two phases side by side, or a tail among the forces, make meaningless, and says so.
    fn leave_out_meaningless(&self, findings: &mut [Findings]) {
        let known = two_phases(&self.scene, findings);
        let found = if known.is_none() { self.separated() } else { None };
        if let Some(why) = &found {
            doubt_of_pressure(findings);
            if let Some(first) = findings.first_mut() {
                first.remark(Remark::Separated { why: why.clone() });
            }
        }
        if let Some(why) = known.or(found.map(|_| "the fluid has separated".to_owned())) {
            let why = format!("{why}, and a mean over both phases belongs to neither");
            leave_out(findings, &why, is_of_one_phase);
        }
        if self.scene.planar_tail {
            let why = "the planar tail is among the forces, and response functions do not count it";
            leave_out(findings, why, is_response);
            let is_plain = |name: &str| has_mark(name, Mark::Plain);
            for table in findings.iter_mut().flat_map(|f| &mut f.tables) {
                table.columns.retain(|c| !is_plain(&c.name));
            }
            let why = "the planar tail is among the forces, and moves the particles";
            leave_out(findings, why, is_plain);
        }
    }

    /// That the last state has separated, in words; `None` where it may be homogeneous, or where the scene itself makes it
    /// something else.
    fn separated(&self) -> Option<String> {
        let State { cell, positions, .. } = &self.state;
        let is_homogeneous = self.scene.not_homogeneous().is_none();
        is_homogeneous.then(|| separated(cell, positions, self.system.n_molecules()))?
    }

    /// Bytes that a look at the last state for crystals takes.
    pub(crate) fn bytes_to_look(&self) -> usize {
        let atoms = self.system.molecules.are_atoms().then_some(self.state.len());
        atoms.map_or(0, frozen_bytes)
    }

    /// The remark that belongs beside the means of a run whose last state is a crystal, or has one in it.
    pub(crate) fn frozen(&self) -> Option<Remark> {
        let State { cell, positions, .. } = &self.state;
        self.system.molecules.are_atoms().then(|| frozen(cell, positions))?
    }

    /// Adds the velocity of the fronts to the findings of a start with a crystal beside its liquid, and says which phase grows. What
    /// moves is in no equilibrium: no test of one speaks against it.
    fn add_front(&self, findings: &mut [Findings]) {
        let Some(start) = self.scene.half_crystal() else {
            return;
        };
        // Two fronts, since the box is periodic.
        let per_share = start.n_atoms as f64 / (start.crystal_density * start.side().powi(2)) / 2.0;
        let mut tables = findings.iter().enumerate();
        let found = tables.find_map(|(at, f)| {
            let table = f.tables.iter().find(|t| t.name == "bond_order")?;
            let (time, share) = (table.numbers("time")?, table.numbers("solid_share")?);
            Some((at, front(&time, &share, per_share)?))
        });
        if let Some((at, (velocity, fronts))) = found {
            findings[at].averages.push(velocity);
            findings[at].remark(Remark::Fronts(fronts));
        } else if let Some(first) = findings.first_mut() {
            first.remark(Remark::Fronts(Fronts::NotMeasured));
        }
    }

    /// Says what compressibilities from the structure are with the tail.
    ///
    /// A tail correction moves no particle, so that the structure is of the fluid without it. Pressure and response functions have the tail:
    /// with P_tail = c·ρ², 1/κ_T = ρ·∂P/∂ρ has 2·P_tail more.
    fn tell_tail_of_structure(&self, findings: &mut [Findings]) {
        let Some(tail) = self.tail_in(self.state.cell.volume()) else {
            return;
        };
        for of_one in findings {
            let from_structure = of_one.averages.iter().filter(|average| {
                average.name.starts_with(FROM_STRUCTURE) && average.estimate.mean > 0.0
            });
            let words: Vec<String> = from_structure
                .map(|average| {
                    let kappa = average.estimate.mean;
                    let with_tail = kappa / (1.0 + 2.0 * tail.pressure * kappa);
                    format!("{} {with_tail:.4} σ³/ε", average.name)
                })
                .collect();
            if words.is_empty() || tail.pressure == 0.0 {
                continue;
            }
            of_one.remark(format!(
                "the structure is of the fluid without its tail, which adds 2·P_tail = {:.4} ε/σ³ to 1/κ_T; with the tail: {}",
                2.0 * tail.pressure,
                words.join(", ")
            ));
        }
    }
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

// What means nothing where two phases stand side by side, and is left out of a run.

/// Why a mean over the whole box belongs to no phase; `None` where the box holds one phase, as far as the run knows.
fn two_phases(scene: &Scene, findings: &[Findings]) -> Option<String> {
    if let Some(surfaces) = scene.surfaces() {
        return Some(format!("the start has surfaces ({surfaces})"));
    }
    if scene.half_crystal().is_some() {
        return Some("a crystal stands beside its liquid".to_owned());
    }
    let mut averages = findings.iter().flat_map(|f| &f.averages);
    let found = averages.any(|average| average.name == LIQUID_DENSITY);
    found.then(|| "the density has two levels".to_owned())
}

/// Whether a quantity is a response function.
pub(crate) fn is_response(name: &str) -> bool {
    response_functions().any(|function| function == name)
}

/// Takes means out, and says so by name.
pub(crate) fn leave_out(findings: &mut [Findings], why: &str, is_left_out: impl Fn(&str) -> bool) {
    let names = without(findings, is_left_out);
    tell(findings, names, why);
}

/// Takes means out, with the remarks that tell how they were found, and gives their names.
pub(crate) fn without(
    findings: &mut [Findings],
    is_left_out: impl Fn(&str) -> bool,
) -> Vec<String> {
    let no_response = response_functions().all(&is_left_out);
    let mut names = Vec::new();
    for Findings { averages, remarks, .. } in findings {
        names.extend(averages.extract_if(.., |a| is_left_out(&a.name)).map(|a| a.name));
        remarks.retain(|r| !(no_response && is_of_responses(r)));
    }
    names
}

/// Whether a remark tells how response functions were found.
fn is_of_responses(remark: &Remark) -> bool {
    matches!(remark, Remark::HeatCapacity { .. } | Remark::ResponseFunctions { .. })
}

/// Says of the pressure that it belongs to no phase.
fn doubt_of_pressure(findings: &mut [Findings]) {
    for average in findings.iter_mut().flat_map(|f| &mut f.averages) {
        if has_mark(&average.name, Mark::AcrossSurfaces) {
            average.doubt.get_or_insert_with(|| {
                Doubt::Incomplete(
                    "the fluid has separated: the mean counts both phases and the tension of the surfaces between them".into(),
                )
            });
            average.estimate.standard_error = f64::NAN;
        }
    }
}

pub(crate) fn tell(findings: &mut [Findings], left_out: Vec<String>, why: &str) {
    if let Some(first) = findings.first_mut().filter(|_| !left_out.is_empty()) {
        first.remark(Remark::LeftOut { quantities: left_out, why: why.to_owned() });
    }
}

/// Compressibilities from g(r) and from S(k) have names that begin so.
const FROM_STRUCTURE: &str = "compressibility_kirkwood_buff";

#[cfg(test)]
mod tests {
    use lennard_integrators::thermostats;
    use lennard_observables::{Average, Estimate};

    use super::*;

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

    const ESTIMATE: Estimate = Estimate {
        mean: 1.0,
        standard_error: 0.1,
        n_effective: 100.0,
        least_effective: 100.0,
        freedom: 100.0,
        equilibration_cut: 0,
    };

    #[test]
    fn a_planar_tail_alone_is_no_sign_of_two_phases_and_a_liquid_density_is() {
        let text = r#"
            [system]
            temperature = 0.8

            [start]
            kind = "file"
            file = "slab.xyz"
            [truncation]
            kind = "cut"
            r_cut = 2.5
            tail_correction = "planar"
            [integrator]
            dt = 0.004
            [[stage]]
            name = "production"
            steps = 100
        "#;
        let scene = Scene::parse(text, "test.toml", &[]).unwrap();
        assert!(scene.planar_tail);
        assert_eq!(two_phases(&scene, &[]), None);
        let findings = Findings {
            averages: vec![Average::new(LIQUID_DENSITY, "σ⁻³", ESTIMATE)],
            ..Findings::default()
        };
        let why = two_phases(&scene, &[findings]).unwrap();
        assert_eq!(why, "the density has two levels");
    }

    #[test]
    fn what_is_left_out_is_told_by_name() {
        let mut findings = [Findings {
            averages: ["pressure", "speed_of_sound"]
                .map(|name| Average::new(name, "", ESTIMATE))
                .into(),
            ..Findings::default()
        }];
        let left_out = without(&mut findings, is_of_one_phase);
        assert_eq!(left_out, ["speed_of_sound"]);
        tell(&mut findings, left_out, "there are two phases");
        assert_eq!(findings[0].averages.len(), 1);
        let words = "left out: speed_of_sound. Here there are two phases";
        assert_eq!(findings[0].remarks_in_words(), words);
    }
}
