//! Single hits against their laws: mirrors and projections. Springs are judged by the study of mechanics.

use lennard_core::{DVec3, ForceSum, ForceTerm, NoForces, Want};

use crate::walls::{ball, method, slit_of};

/// Gains in gravity are judged by the study of mechanics.
#[test]
fn a_mirror_keeps_the_restitution_without_a_field() {
    let h = 0.01;
    // Each hit keeps e to rounding, wherever in the step it happens.
    for e in [1.0, 0.7, 0.1] {
        let options = format!("kind = \"hard\"\nresponse = \"mirror\"\nrestitution = {e:?}");
        let (mut state, _, system) = ball(&options, h);
        state.velocities[0] = DVec3::new(0.0, 0.0, -1.234);
        let mut step = method();
        let mut alone = ForceSum::new(NoForces).with(slit_of(&options));
        step.start(&system, &mut state, &mut alone, h, Want::ENERGY).unwrap();
        while alone.walls()[0].hits == 0 {
            step.step(&system, &mut state, &mut alone, h, Want::ENERGY).unwrap();
        }
        assert!((state.velocities[0].z / (1.234 * e) - 1.0).abs() < 1e-12);
        let impulse = alone.walls()[0].impulse;
        assert!((impulse - 1.234 * (1.0 + e)).abs() < 1e-12);
    }
}

#[test]
fn a_projection_keeps_no_normal_speed_and_all_of_the_tangential_one() {
    let h = 0.01;
    let options = "kind = \"hard\"\nresponse = \"project\"";
    for phase in [0.1, 0.35, 0.6, 0.85] {
        let (mut state, _, system) = ball(options, h);
        let mut walls = ForceSum::new(NoForces).with(slit_of(options));
        state.velocities[0] = DVec3::new(0.3, -0.2, -1.0);
        state.positions[0].z = 2.0 + (10.0 + phase) * h;
        let mut step = method();
        step.start(&system, &mut state, &mut walls, h, Want::ENERGY).unwrap();
        let mut heat = 0.0;
        let mut speeds = Vec::new();
        for _ in 0..15 {
            heat += step.step(&system, &mut state, &mut walls, h, Want::ENERGY).unwrap().heat;
            speeds.push(state.velocities[0].z);
        }
        // The step of the hit leaves the fraction that was left, towards the wall; the next leaves nothing.
        assert!((speeds[9] + 1.0).abs() < 1e-12);
        assert!((speeds[10] + phase).abs() < 1e-10, "{phase}: {speeds:?}");
        assert!(speeds[11..].iter().all(|v| *v == 0.0), "{speeds:?}");
        assert_eq!(state.positions[0].z, 2.0);
        assert_eq!(state.velocities[0], DVec3::new(0.3, -0.2, 0.0));
        assert!((heat + 0.5).abs() < 1e-12);
        assert!((walls.walls()[0].impulse - 1.0).abs() < 1e-12);
    }
}
