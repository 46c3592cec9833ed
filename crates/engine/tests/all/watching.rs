//! The watchdog at work in a run.

use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceStatistics,
    ForceTerm, Part, PeriodicBox, Persist, RestoreError, StateArchive, StateReader, StateWriter,
    Want,
};
use lennard_engine::{EngineError, Simulation, Unfollowed};
use lennard_engine::{Symptom, watchdog};
use lennard_forcefield::Model;

use crate::common::{self, prepared};

const LIQUID: &str = r#"
    system = { n_atoms = 256, density = 0.8442, temperature = 1.4 }
    truncation = { kind = "switch", r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 300 }]
"#;

fn build(overrides: &str) -> Simulation {
    prepared(common::scene(LIQUID, overrides))
}

/// The particle whose farthest neighbor a provider leaves out.
const ROBBED: usize = 17;

/// Forces with a fault from some evaluation on.
struct Faulty {
    forces: Box<dyn Backend>,
    evaluations: u64,
    /// From this evaluation on, of the pairs of one particle the one nearest to the cutoff is left out.
    misses_after: u64,
    /// From this evaluation on, the first particle's force is not a number, as an overlap makes it.
    broken_after: u64,
    cell: PeriodicBox,
    model: Model,
}

impl Persist for Faulty {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.forces.save(to);
    }
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.forces.restore(from)
    }
}

impl Faulty {
    fn leave_out(&self, positions: &[DVec3], forces: &mut [DVec3]) {
        let r = |j: usize| self.cell.minimum_image(positions[ROBBED] - positions[j]);
        let inside = |j: &usize| *j != ROBBED && r(*j).length() <= self.model.r_cut;
        let farthest = (0..positions.len())
            .filter(inside)
            .max_by(|a, b| r(*a).length().total_cmp(&r(*b).length()))
            .expect("a liquid has neighbors");
        let r = r(farthest);
        let missed = self.model.eval(r.length_squared()).force * r;
        forces[ROBBED] -= missed;
        forces[farthest] += missed;
    }
}

impl ForceTerm for Faulty {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        self.evaluations += 1;
        if self.evaluations > self.broken_after {
            return Err(ForceError::NonFiniteForce { particle: 17 });
        }
        let found = self.forces.evaluate(at, part, want, forces)?;
        if self.evaluations > self.misses_after {
            self.leave_out(at.positions, forces);
        }
        Ok(found)
    }
    fn properties(&self) -> ForceProperties {
        self.forces.properties()
    }
    fn statistics(&self) -> ForceStatistics {
        self.forces.statistics()
    }
}

impl Backend for Faulty {}

/// A simulation whose forces miss a pair, or break, after so many evaluations.
fn faulty(overrides: &str, misses_after: u64, broken_after: u64) -> Simulation {
    let mut simulation = build(overrides);
    let scene = &simulation.scene;
    let model = Model::new(&scene.potential, &scene.truncation).unwrap_or_else(|e| panic!("{e}"));
    let cell = simulation.state.cell;
    let forces = std::mem::replace(&mut simulation.forces, build("").forces);
    simulation.forces =
        Box::new(Faulty { forces, evaluations: 0, misses_after, broken_after, cell, model });
    simulation
}

#[test]
fn one_missed_pair_just_inside_a_plain_cutoff_stops_the_run() {
    for precision in ["double", "mixed"] {
        let mut simulation = faulty(
            // Until each particle has had its turn.
            &format!("truncation.kind=shift kernel.precision={precision} stage.0.steps=25700"),
            130,
            u64::MAX,
        );
        let error = simulation.follow(&mut Unfollowed).expect_err("one pair was left out");
        assert_eq!(error.exit_code(), 3);
        let text = error.to_string();
        let EngineError::Physics(failure) = error else { panic!("{text}") };
        let Symptom::WrongForce { particle, found, wanted, tolerance } = failure.symptom else {
            panic!("{text}")
        };
        assert!(failure.step.is_multiple_of(watchdog::LISTS_EVERY) && failure.step > 130);
        // 24·(2r⁻¹³ − r⁻⁷) is 0.039 at 2.5 σ: its farthest neighbor is not far inside.
        let missed = (found - wanted).length();
        assert!((0.038..0.05).contains(&missed), "{text}");
        assert!(tolerance < 0.2 * missed, "{text}");
        let words = [
            &*format!("the force on particle {particle} is"),
            "where all pairs give",
            "a pair inside the cutoff was missed by the list",
        ];
        common::contains(&text, &words);
    }
}

#[test]
fn every_method_leaves_the_whole_force_which_is_checked_and_found_right() {
    let mut ran = Vec::new();
    for entry in lennard_integrators::integrators() {
        for precision in ["double", "mixed"] {
            // Explicit Euler gains energy.
            let overrides = format!(
                "integrator.kind={} integrator.dt=0.0005 kernel.precision={precision}
                    stage.0.steps=130",
                entry.spec.name
            );
            // Its equations are not to be solved with forces of mixed precision.
            if (entry.spec.name, precision) == ("implicit-euler", "mixed") {
                continue;
            }
            // Some are not for fluids, or not for mixed precision.
            let Ok(scene) = common::parse(LIQUID, &overrides) else {
                continue;
            };
            let mut simulation = prepared(scene);
            simulation
                .follow(&mut Unfollowed)
                .unwrap_or_else(|e| panic!("{}: {e}", entry.spec.name));
            // At step 100 and at the end.
            let seen = simulation.force_check.seen();
            assert_eq!(seen.forces, 2, "{}", entry.spec.name);
            let deviation = seen.largest_deviation;
            assert!(
                // Canonical forces are summed in the same order: not a bit differs.
                deviation < 0.5 && (deviation > 0.0 || entry.spec.name.starts_with("bit-")),
                "{} in {precision}: {seen:?}",
                entry.spec.name
            );
            ran.push((entry.spec.name, precision));
        }
    }
    assert!(ran.len() > 20, "{ran:?}");
}

#[test]
fn what_was_checked_is_counted_on_after_a_restart() {
    let mut whole = build("stage.0.steps=250");
    whole.follow(&mut Unfollowed).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(whole.force_check.seen().forces, 3);
    let mut archive = StateArchive::default();
    Persist::save(&whole, &mut archive.writer());
    let mut again = build("stage.0.steps=400");
    again.restore(&archive.reader()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.force_check.seen(), whole.force_check.seen());
    again.follow(&mut Unfollowed).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.force_check.seen().forces, 5);
    // Nothing that was saved has a default.
    archive.arrays.retain(|name, _| !name.starts_with("force_check"));
    let error = build("stage.0.steps=400").restore(&archive.reader());
    let missing = RestoreError::Missing("force_check/forces".into());
    assert_eq!(error, Err(missing));
}

#[test]
fn a_force_that_is_not_finite_stops_the_run_at_that_step_and_names_the_particle() {
    let mut simulation = faulty("", u64::MAX, 42);
    let error = simulation.follow(&mut Unfollowed).expect_err("a force was not finite");
    assert_eq!(error.exit_code(), 3);
    let text = error.to_string();
    let words = [
        "the force on particle 17 is not finite",
        "stage `production`",
        "velocity-verlet with dt = 0.004 τ",
        "fastest: particle",
    ];
    common::contains(&text, &words);
    let EngineError::Physics(failure) = error else { panic!("{text}") };
    // The first evaluation belongs to the start, and the forty-third to step 42.
    assert!((41..=42).contains(&failure.step), "{}", failure.step);
}

#[test]
fn a_method_that_is_stable_at_no_step_is_not_told_to_take_a_smaller_one() {
    let error = build("integrator.kind=explicit-euler")
        .follow(&mut Unfollowed)
        .expect_err("explicit Euler heats until it fails");
    let text = error.to_string();
    common::contains(&text, &["likely cause: explicit-euler is stable at no step"]);
    let (_, speed) = text.split_once("fastest: particle").expect("the fastest");
    let speed = speed.lines().next().expect("its line");
    assert!(!speed.contains("e0") && !speed.contains("e1"), "{speed}");
}
