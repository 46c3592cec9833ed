//! Single hits against their laws: mirrors, projections, springs with dashpots, and springs that are too stiff.

use lennard_core::{DVec3, ForceSum, ForceTerm, NoForces, State, System, Want};

use crate::walls::{ball, method, slit_of};

/// Steps until a condition holds, at most `most`; returns the heat.
fn run_until(
    (state, forces, system): &mut (State, ForceSum<NoForces>, System),
    h: f64,
    most: u32,
    done: impl Fn(&State, &ForceSum<NoForces>) -> bool,
) -> f64 {
    let mut method = method();
    method.start(system, state, forces, h, Want::ENERGY).unwrap();
    let mut heat = 0.0;
    for _ in 0..most {
        let report = method.step(system, state, forces, h, Want::ENERGY);
        heat += report.unwrap().heat;
        if done(state, forces) {
            return heat;
        }
    }
    panic!("not done after {most} steps: {:?}", state.positions[0]);
}

/// Height above the lower plane at 2 σ, and the energy of the ball there.
fn energy(state: &State) -> f64 {
    0.5 * state.velocities[0].length_squared() + state.positions[0].z - 2.0
}

#[test]
fn a_mirror_keeps_the_restitution_without_a_field_and_gains_its_energy_in_gravity() {
    // In gravity each elastic bounce gains 2g|x|, with |x| between 0 and v·h: about g·v·h on average.
    let h = 0.01;
    let mut elastic = ball("kind = \"hard\"\nresponse = \"mirror\"", h);
    let bounces = 100;
    let heat = run_until(&mut elastic, h, 100_000, |_, f| f.walls()[0].hits >= bounces);
    let gained = energy(&elastic.0) - 1.0;
    // The speed grows with the energy: dE/dn = √(2E)·g·h, so that √E grows by h/√2 per bounce.
    let wanted = (1.0 + f64::from(bounces as u32) * h / 2.0_f64.sqrt()).powi(2) - 1.0;
    assert!((gained / wanted - 1.0).abs() < 0.25, "{gained} {wanted}");
    assert_eq!(heat, 0.0);
    // Without a field each hit keeps e to rounding, wherever in the step it happens.
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

/// Mean and extremes over phases of v_out/v_in at a soft wall, where ω·h = s; without a field, v = 1.
fn rebounds(options: &str, h: f64, phases: u32) -> Vec<f64> {
    (0..phases)
        .map(|k| {
            let (mut state, _, system) = ball("kind = \"hard\"", h);
            let mut walls = ForceSum::new(NoForces).with(slit_of(options));
            let phase = (f64::from(k) + 0.5) / f64::from(phases);
            state.positions[0].z = 2.0 + (2.0 + phase) * h;
            state.velocities[0].z = -1.0;
            let mut step = method();
            step.start(&system, &mut state, &mut walls, h, Want::ENERGY).unwrap();
            for _ in 0..100_000 {
                step.step(&system, &mut state, &mut walls, h, Want::ENERGY).unwrap();
                if state.velocities[0].z > 0.0 && state.positions[0].z > 2.0 {
                    break;
                }
            }
            state.velocities[0].z
        })
        .collect()
}

#[test]
fn a_soft_wall_keeps_the_restitution_that_was_set() {
    // ω·h = 0.1 for the linear spring.
    let h = 0.005;
    for law in ["linear", "hertz"] {
        for e in [0.05, 0.3, 0.5, 0.9] {
            let options =
                format!("kind = \"soft\"\nlaw = \"{law}\"\nstiffness = 400.0\nrestitution = {e:?}");
            let found = rebounds(&options, h, 200);
            let mean = found.iter().sum::<f64>() / 200.0;
            assert!((mean - e).abs() < 0.005, "{law} {e}: {mean}");
            let farthest = found.iter().map(|v| (v - e).abs()).fold(0.0, f64::max);
            assert!(farthest < 0.03, "{law} {e}: {farthest}");
        }
    }
}

#[test]
fn a_spring_that_is_too_stiff_gains_energy_long_before_its_limit() {
    // Mean gain of energy per hit over 2000 phases at s = ω·h; from an independent calculation.
    let gain = |s: f64| {
        let h = s / 400.0_f64.sqrt();
        let found = rebounds("kind = \"soft\"\nstiffness = 400.0", h, 2000);
        found.iter().map(|v| v * v - 1.0).sum::<f64>() / 2000.0
    };
    assert!(gain(0.1) < 1e-5 && gain(0.2) < 1e-4);
    for (s, wanted) in [(0.5, 6.4e-4), (1.1, 0.03), (1.2, 0.066), (1.5, 0.068), (1.9, 1.65)] {
        let found = gain(s);
        assert!(found > 0.7 * wanted && found < 1.4 * wanted, "{s}: {found}");
    }
    // Not monotonic: s = 1.4 is better than 1.2.
    assert!(gain(1.4) < 0.01);
}
