//! What the observables of a run found, and what speaks against it.

use lennard_core::State;
use lennard_observables::quantities::{Mark, has_mark, is_of_one_phase};
use lennard_observables::{
    Doubt, Findings, Fronts, LIQUID_DENSITY, Remark, front, frozen, frozen_bytes, is_response,
    leave_out, separated, tell_separated, tell_tail_of_structure,
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
                let by_bath = Doubt::of_baths(&average.name, observable.spec().dynamic, &baths);
                // What speaks against the run speaks first: one reason for all.
                average.weigh(equilibrium.doubt.clone(), [by_bath, by_scene.clone()]);
            }
            found
        });
        let mut findings: Vec<Findings> = judged.collect();
        self.leave_out_meaningless(&mut findings);
        if let Some(tail) = self.tail_in(self.state.cell.volume()) {
            tell_tail_of_structure(&mut findings, tail.pressure);
        }
        self.add_front(&mut findings);
        self.leave_out_of_frames(&mut findings);
        findings
    }

    /// Leaves out of the findings what two phases side by side, or a tail among the forces, make meaningless, and says so.
    fn leave_out_meaningless(&self, findings: &mut [Findings]) {
        let known = two_phases(&self.scene, findings);
        let found = if known.is_none() { self.separated() } else { None };
        if let Some(why) = &found {
            tell_separated(findings, why);
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
        let molecules = self.system.n_molecules();
        is_homogeneous.then(|| separated(self.system.own(), cell, positions, molecules))?
    }

    /// Bytes that a look at the last state for crystals takes.
    pub(crate) fn bytes_to_look(&self) -> usize {
        let atoms = self.system.molecules.are_atoms().then_some(self.system.len());
        atoms.map_or(0, frozen_bytes)
    }

    /// The remark that belongs beside the means of a run whose last state is a crystal, or has one in it.
    pub(crate) fn frozen(&self) -> Option<Remark> {
        let State { cell, positions, .. } = &self.state;
        self.system.molecules.are_atoms().then(|| frozen(self.system.own(), cell, positions))?
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
}

/// What bonds of no known ensemble make of means.
fn by_bonds(scene: &Scene) -> Option<Doubt> {
    let why = scene.molecule.as_ref()?.bonds.no_ensemble()?;
    Some(Doubt::Thermostat { why: why.to_owned(), sets_it: false })
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

#[cfg(test)]
mod tests {
    use lennard_observables::{Average, Estimate};

    use super::*;

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
            averages: vec![Average::new(LIQUID_DENSITY, "σ⁻³", Estimate::new(1.0, 0.1, 100.0))],
            ..Findings::default()
        };
        let why = two_phases(&scene, &[findings]).unwrap();
        assert_eq!(why, "the density has two levels");
    }
}
