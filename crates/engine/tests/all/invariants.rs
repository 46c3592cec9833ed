//! What must hold whatever the scene: observers, conservation, and failing well.

use lennard_core::DVec3;
use lennard_engine::{
    Action, Follower, Operation, Schedule, Simulation, StopAt, Trigger, Unfollowed, prepare_from,
    start,
};

use crate::common::{self, bits, follow, prepared};

/// A liquid near its triple point, 256 particles, one measured stage.
const LIQUID: &str = r#"
    system = { n_atoms = 256, density = 0.8442, temperature = 1.4, seed = 11 }
    truncation = { kind = "switch", r_cut = 2.5 }
    integrator = { kind = "velocity-verlet", dt = 0.004 }
    stage = [{ name = "production", steps = 1000 }]
    output = { thermo_every = 10 }
"#;

fn build(overrides: &str) -> Simulation {
    prepared(common::scene(LIQUID, overrides))
}

fn ran(overrides: &str) -> Simulation {
    common::ran(common::scene(LIQUID, overrides))
}

#[test]
fn observing_changes_no_bit_of_the_trajectory() {
    let every = r#"[{kind="rdf", every=7}, {kind="msd", every=3}, {kind="vacf", every=5}, {kind="pressure-tensor", every=2}, {kind="momentum", every=1}]"#;
    // Where no operation is due, several steps are taken at once; in double precision only where particles are many.
    for (precision, n, steps) in [
        ("double", "256", "1000"),
        ("double", "2048", "90"),
        ("double", "2916", "90"),
        ("mixed", "500", "990"),
    ] {
        let fluid = format!(
            "kernel.precision={precision} system.n_atoms={n}
            stage.0.steps={steps} neighbor.mode=verlet"
        );
        let run = |more: &str| ran(&format!("{fluid} {more}"));
        let bare = run("output.thermo_every=1000");
        let watched = run(&format!("output.thermo_every=1 observable={every}"));
        let what = format!("{n} particles in {precision} precision");
        assert!(bits(&watched) == bits(&bare), "{what}");
        let samples = |s: &Simulation| s.thermodynamics().series().time.len();
        assert!(samples(&watched) > samples(&bare), "{what}");
        let (a, b) = (bare.forces.statistics(), watched.forces.statistics());
        assert_eq!((a.evaluations, a.builds), (b.evaluations, b.builds), "{what}");
    }
}

#[test]
fn a_run_that_goes_wrong_says_the_same_whether_it_was_looked_at_or_not() {
    for (dt, temperature) in [("0.05", "3.0"), ("0.5", "30.0"), ("0.03", "9.0")] {
        let run = |follower: &mut dyn Follower| {
            let mut s = build(&format!(
                "integrator.dt={dt} system.temperature={temperature}
                system.n_atoms=500 kernel.precision=mixed neighbor.mode=verlet
                output.thermo_every=1000"
            ));
            let error = s.follow(follower).expect_err("the step is too long");
            (error.to_string(), s.state.step, s.stage_run().steps_done)
        };
        let each = Operation::new(Action::Call, Trigger::Always);
        let mut onlooker = StopAt::following(Schedule::empty().with(each), u64::MAX);
        assert_eq!(run(&mut Unfollowed), run(&mut onlooker), "dt = {dt}");
    }
}

#[test]
fn momentum_is_conserved_and_the_temperature_is_the_one_asked_for_at_the_start() {
    let mut s = build("");
    assert!((s.view().temperature() - 1.4).abs() < 1e-13);
    follow(&mut s);
    // Each step adds roundings of the kicks: N·√steps·ε_machine·|v| ≈ 256·30·1e-16·3, and a margin of ten.
    assert!(s.system.momentum(&s.state.velocities).length() < 2e-10);
}

/// In single precision a full list does not cancel the two forces of a pair to the last bit, so momentum takes a random walk.
/// Each of N forces is off by δ·F_rms at each step, independently: |P| ≈ δ·F_rms·dt·√(N·steps).
#[test]
fn momentum_of_mixed_precision_stays_below_a_random_walk_of_its_rounding() {
    for steps in [100_u32, 2000] {
        let s = ran(&format!("system.n_atoms=864 kernel.precision=mixed stage.0.steps={steps}"));
        let n = s.state.forces.len() as f64;
        let squares: f64 = s.state.forces.iter().map(|f| f.length_squared()).sum();
        // δ = 7e-7 of the force in mixed precision (benches/NOTES.md); the walk reaches three times its width one time in 400.
        let walk = 7e-7 * (squares / n).sqrt() * 0.004 * (n * f64::from(steps)).sqrt();
        let momentum = s.system.momentum(&s.state.velocities).length();
        assert!(momentum < 3.0 * walk, "{steps} steps: {momentum:e} of {walk:e}");
        // It is the mixed loop that ran.
        assert!(momentum > 1e-3 * walk, "{steps} steps: {momentum:e} of {walk:e}");
    }
}

#[test]
fn a_heat_bath_costs_a_method_with_memory_no_second_force_evaluation() {
    for method in ["leapfrog", "stormer-verlet", "velocity-verlet"] {
        let s = ran(&format!("integrator.kind={method} stage.0.thermostat=bussi stage.0.steps=50"));
        assert_eq!(s.forces.statistics().evaluations, 51, "{method}");
    }
}

#[test]
fn a_bath_holds_its_temperature_with_every_method_and_its_heat_is_accounted_for() {
    for method in ["leapfrog", "stormer-verlet", "velocity-verlet"] {
        for bath in ["bussi", "langevin"] {
            let s = ran(&format!(
                "integrator.kind={method} system.temperature=1.0
                stage.0.thermostat={bath} stage.0.steps=3000"
            ));
            let series = s.thermodynamics().series();
            let late = &series.temperature[series.temperature.len() / 3..];
            let mean = late.iter().sum::<f64>() / late.len() as f64;
            // Canonical: σ_T = T·√(2/3N) = 0.05 for one sample; several tens of independent ones leave 0.01.
            assert!((mean - 1.0).abs() < 0.04, "{method} {bath}: {mean}");
            let drift = s.thermodynamics().conservation().energy_drift_per_atom_per_tau;
            // The bath moves some 0.1 ε per particle; what is left after its heat is taken off is the method's own error.
            assert!(drift.abs() < 1e-4, "{method} {bath}: {drift:e}");
        }
    }
}

#[test]
#[ignore = "a minute: run by `cargo xtask physics`"]
fn the_energy_of_the_triple_point_does_not_drift_in_a_hundred_thousand_steps() {
    let stages = r#"[{name="melt", steps=3000, thermostat="bussi", temperature=1.5}, {name="equilibrate", steps=7000, thermostat="bussi", temperature=0.722}, {name="production", steps=100000}]"#;
    let s = ran(&format!("system.n_atoms=864 integrator.dt=0.004618802153517006 stage={stages}"));
    let found = s.thermodynamics().conservation();
    let (drift, error) = (found.energy_drift_per_atom_per_tau, found.energy_drift_standard_error);
    // The 95 % interval lies inside ±5e-7 ε per particle per τ.
    assert!(drift.abs() + 1.96 * error < 5e-7, "{drift:e} ± {error:e}");
}

/// Their force is 10³⁰ ε/σ and more: single precision, which ends at 10³⁸ whatever it counts in, is not for random starts.
#[test]
fn particles_nearly_on_top_of_each_other_are_relaxed_in_any_precision() {
    for precision in ["double", "mixed"] {
        for apart in [3e-3, 1e-5] {
            let scene =
                common::scene(LIQUID, &format!("start.kind=random kernel.precision={precision}"));
            let mut beginning = start(&scene).unwrap_or_else(|e| panic!("{e}"));
            beginning.positions[1] = beginning.positions[0] + DVec3::new(0.0, apart, 0.0);
            let simulation = prepare_from(scene, beginning)
                .unwrap_or_else(|e| panic!("{precision}, {apart} σ: {e}"));
            let [a, b] = [0, 1].map(|i| simulation.state.positions[i]);
            let distance = simulation.state.cell.minimum_image(a - b).length();
            assert!(distance > 0.7, "{precision}, {apart} σ: {distance}");
        }
    }
}
