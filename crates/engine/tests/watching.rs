//! The watchdog at work in a run, and what it costs.

use std::time::Instant;

use lennard_core::{
    Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceProvider, ForceStatistics,
    Part, Persist, RestoreError, StateReader, StateWriter, Want,
};
use lennard_engine::watchdog::{self, Symptom};
use lennard_engine::{EngineError, Nobody, Simulation, prepare};
use lennard_scene::Scene;

const LIQUID: &str = r#"
    [system]
    n_atoms = 256
    density = 0.8442
    temperature = 1.4
    [truncation]
    kind = "switch"
    r_cut = 2.5
    [integrator]
    dt = 0.004
    [[stage]]
    name = "production"
    steps = 300
"#;

fn build(overrides: &[(&str, &str)]) -> Simulation {
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
        .collect();
    let scene = Scene::parse(LIQUID, "liquid.toml", &overrides).unwrap_or_else(|e| panic!("{e}"));
    prepare(scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Forces that are right, and what is said of them is not.
struct Confessing {
    forces: Box<dyn ForceProvider + Send>,
    late_after: u64,
    evaluations: u64,
    /// From this evaluation on, the first particle's force is not a number, as an overlap makes it.
    broken_after: u64,
}

impl Persist for Confessing {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.forces.save(to);
    }
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.forces.restore(from)
    }
}

impl ForceProvider for Confessing {
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
        self.forces.evaluate(at, part, want, forces)
    }
    fn properties(&self) -> ForceProperties {
        self.forces.properties()
    }
    fn statistics(&self) -> ForceStatistics {
        let late_builds = u64::from(self.evaluations > self.late_after);
        ForceStatistics {
            late_builds,
            ..self.forces.statistics()
        }
    }
}

/// A simulation whose forces own up to a late list, or break, after so many evaluations.
fn confessing(late_after: u64, broken_after: u64) -> Simulation {
    let mut simulation = build(&[]);
    let forces = std::mem::replace(&mut simulation.forces, build(&[]).forces);
    simulation.forces = Box::new(Confessing {
        forces,
        late_after,
        broken_after,
        evaluations: 0,
    });
    simulation
}

#[test]
fn a_late_list_stops_the_run_at_the_next_look() {
    let mut simulation = confessing(130, u64::MAX);
    let error = simulation.run(&mut Nobody).expect_err("a list was late");
    assert_eq!(error.exit_code(), 3);
    let EngineError::Physics(failure) = error else {
        panic!("{error}")
    };
    assert_eq!(failure.symptom, Symptom::LateLists { builds: 1 });
    assert_eq!(
        failure.step,
        200,
        "late at step 130, seen at the next multiple of {}",
        watchdog::LISTS_EVERY
    );
}

#[test]
fn a_force_that_is_not_finite_stops_the_run_at_that_step_and_names_the_particle() {
    let mut simulation = confessing(u64::MAX, 42);
    let error = simulation
        .run(&mut Nobody)
        .expect_err("a force was not finite");
    assert_eq!(error.exit_code(), 3);
    let text = error.to_string();
    for wanted in [
        "the force on particle 17 is not finite",
        "stage `production`",
        "velocity-verlet with dt = 0.004 τ",
        "fastest: particle",
    ] {
        assert!(text.contains(wanted), "wanted `{wanted}` in\n{text}");
    }
    let EngineError::Physics(failure) = error else {
        panic!("{text}")
    };
    // The first evaluation is of the start; the forty-third that of step 42.
    assert!((41..=42).contains(&failure.step), "{}", failure.step);
}

/// Run with `cargo test --release -p lennard-engine --test watching -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement: prints what watching costs"]
#[allow(clippy::print_stdout)] // a measurement is read by a person
fn what_watching_costs() {
    for n in ["864", "32000", "256000"] {
        let mut simulation = build(&[("system.n_atoms", n), ("stage.0.steps", "200")]);
        let clock = Instant::now();
        simulation
            .run(&mut Nobody)
            .unwrap_or_else(|e| panic!("{e}"));
        let step = clock.elapsed().as_secs_f64() / 200.0;
        let repeats = 100;
        let clock = Instant::now();
        for _ in 0..repeats {
            watchdog::check_speeds(&simulation.state, 0.004).unwrap_or_else(|e| panic!("{e:?}"));
        }
        let speeds = clock.elapsed().as_secs_f64() / f64::from(repeats);
        let clock = Instant::now();
        for _ in 0..repeats {
            watchdog::check_lists(simulation.forces.statistics().late_builds)
                .unwrap_or_else(|e| panic!("{e:?}"));
        }
        let lists = clock.elapsed().as_secs_f64() / f64::from(repeats);
        let mut aside = simulation.state.clone();
        let clock = Instant::now();
        for _ in 0..repeats {
            aside.positions.clone_from(&simulation.state.positions);
            aside.velocities.clone_from(&simulation.state.velocities);
        }
        let copy = clock.elapsed().as_secs_f64() / f64::from(repeats);
        let cost = speeds / watchdog::EVERY as f64 + (lists + copy) / watchdog::LISTS_EVERY as f64;
        println!(
            "{n} particles: a step {:.1} µs; a look at speeds {:.2} µs, at lists {:.2} µs, a state set aside {:.2} µs; watching costs {:.3} % of a step",
            1e6 * step,
            1e6 * speeds,
            1e6 * lists,
            1e6 * copy,
            100.0 * cost / step
        );
    }
}
