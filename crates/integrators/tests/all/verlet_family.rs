//! Methods of the Verlet family that are the same method, and energies that are known of them. The study of stability
//! judges the claims about their orders.

use crate::common::{Cluster, Rig, cluster, farthest, free, one};
use lennard_core::{DVec3, State, System};
use lennard_integrators::integrators;
use lennard_integrators::oscillator::HarmonicForces;

fn end_of_run(name: &str, steps: u32) -> State {
    let entry = integrators().iter().find(|e| e.spec.name == name).unwrap();
    let (positions, velocities) = cluster(3, 0.5, 3);
    let start = (System::atoms(27), free(positions, velocities));
    Rig::of(entry.build(), start, Cluster, 0.004).steps(steps).state
}

#[test]
fn velocity_verlet_leapfrog_and_stormer_verlet_with_central_velocities_are_one_method() {
    let reference = end_of_run("velocity-verlet", 100);
    for name in [
        "velocity-verlet-short",
        "leapfrog",
        "stormer-verlet",
        "stormer-verlet-time-corrected",
        "stormer-verlet-variable",
    ] {
        let other = end_of_run(name, 100);
        // Equal except for rounding: positions near 2 give 4e-16 a step, over h = 0.004 in the velocity,
        // and the cluster's collisions let 100 steps of it grow by less than 10.
        let x = farthest(&other.positions, &reference.positions);
        let v = farthest(&other.velocities, &reference.velocities);
        assert!(x < 1e-11 && v < 1e-10, "{name}: {x:e} {v:e}");
    }
    // Another method differs by far more: the comparison can tell.
    let euler = end_of_run("symplectic-euler", 100);
    assert!(farthest(&euler.positions, &reference.positions) > 1e-4);
}

/// Means of the kinetic energy on whole steps and on half steps and of the potential energy, of oscillators with ω = 1.
fn mean_energies(entry: &lennard_integrators::IntegratorEntry, dt: f64) -> (f64, f64, f64) {
    let state = one(DVec3::new(1.0, 0.0, -0.3), DVec3::new(0.0, 0.5, 0.2));
    let mut rig = Rig::of(entry.build(), (System::atoms(1), state), HarmonicForces::new(1.0), dt);
    let (mut whole, mut half, mut potential) = (0.0, 0.0, 0.0);
    // Whole turns of the discrete map leave nothing of the oscillating parts but what the last one lacks.
    let steps = 200_000;
    for _ in 0..steps {
        rig.step();
        let view = lennard_core::View {
            half_kick_step: Some(dt),
            ..lennard_core::View::of(&rig.state, &rig.system)
        };
        whole += rig.kinetic_energy();
        half += view.half_step_kinetic_energy().unwrap();
        potential += 0.5 * rig.state.positions[0].length_squared();
    }
    let n = f64::from(steps);
    (whole / n, half / n, potential / n)
}

#[test]
fn half_steps_have_the_kinetic_energy_of_the_positions_and_whole_steps_too_little() {
    for entry in integrators().iter().filter(|e| e.spec.half_kicks) {
        let dt = 0.5;
        let (whole, half, potential) = mean_energies(entry, dt);
        let name = entry.spec.name;
        assert!((half / potential - 1.0).abs() < 1e-4, "{name}: {half} {potential}");
        let exact = 1.0 - 0.25 * dt * dt;
        assert!((whole / potential - exact).abs() < 1e-4, "{name}: {whole} {potential}");
    }
}
