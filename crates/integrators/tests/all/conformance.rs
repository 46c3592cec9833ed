//! What each method of the list declares about itself, measured.

use crate::common::{Cluster, Rig, cluster, farthest, free, one};
use crate::measure::{Kepler, Watched, general_methods, measured_map, orders, oscillation};
use glam::{DMat2, DVec2};
use lennard_core::{
    Configuration, DVec3, ForceTerm, Masses, Part, Persist, State, StateArchive, System, Want,
};
use lennard_integrators::oscillator::{ExactOscillator, HarmonicForces};
use lennard_integrators::{IntegratorEntry, integrators};

/// Rounding of a one-step map with entries of the order 1, as the issue sets it.
const ROUNDING: f64 = 1e-13;

fn largest_entry(m: DMat2) -> f64 {
    m.to_cols_array().iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// A small cluster with unequal masses, started with a little motion.
fn moving_cluster() -> (System, State) {
    let (positions, velocities) = cluster(3, 0.5, 3);
    let mut system = System::atoms(positions.len());
    system.masses =
        Masses::Each((0..positions.len()).map(|i| 1.0 + 0.5 * (i % 3) as f64).collect());
    (system, free(positions, velocities))
}

/// The same under a method.
fn moving(entry: &IntegratorEntry, dt: f64) -> Rig<Cluster> {
    Rig::of(entry.build(), moving_cluster(), Cluster, dt)
}

#[test]
fn strides_of_any_method_have_the_bits_of_its_steps() {
    let mut longest = 0;
    for entry in general_methods() {
        let (mut one, mut all) = (moving(entry, 0.001), moving(entry, 0.001));
        let mut evaluations = 0;
        for step in 1..=13 {
            one.want = if step == 13 { Want::TOTALS } else { Want::NOTHING };
            evaluations += one.step().force_evaluations;
        }
        while all.state.step < 13 {
            let before = all.state.step;
            let (taken, report) = all.stride(13 - before);
            assert_eq!(all.state.step, before + taken, "{}", entry.spec.name);
            evaluations -= report.force_evaluations;
            longest = longest.max(taken);
        }
        let name = entry.spec.name;
        assert!(
            format!("{:?}", one.state) == format!("{:?}", all.state),
            "{name}: {:?}\n{:?}",
            one.state,
            all.state
        );
        assert_eq!((evaluations, one.heat), (0, all.heat), "{name}");
    }
    assert_eq!(longest, 3, "two at once, and the one that ends the stride");
}

#[test]
fn steps_from_anywhere_are_the_declared_map() {
    for entry in integrators() {
        let Some(map) = entry.spec.oscillator_map else {
            continue;
        };
        // A first step can be right by the start alone; the fifth shows the memory.
        let cases = [(1.0, 0.1), (1.0, 1.9), (0.3, 2.0), (2.0, 0.7), (3.0, 1.2)];
        for (omega, dt, n) in
            cases.map(|(omega, dt)| (omega, dt, 1)).into_iter().chain([(1.0, 0.4, 5)])
        {
            let measured = measured_map(entry, (omega * omega, 0.0), dt, n);
            let declared = (0..n).fold(DMat2::IDENTITY, |m, _| map(omega, dt) * m);
            let error = largest_entry(measured - declared) / largest_entry(declared).max(1.0);
            assert!(
                error < f64::from(n) * ROUNDING,
                "{} at ω = {omega}, dt = {dt}: {error:e}\n{measured}\n{declared}",
                entry.spec.name
            );
        }
    }
}

#[test]
fn measured_orders_are_the_declared_ones() {
    for entry in general_methods() {
        let spec = entry.spec;
        let measured = orders(entry);
        for (order, declared) in
            measured.into_iter().zip([spec.position_order, spec.velocity_order])
        {
            let off = (order - f64::from(declared)).abs();
            assert!(off < 0.05, "{}: orders of x and v {measured:?}", spec.name);
        }
    }
}

#[test]
fn the_exact_solution_is_exact() {
    let entry = &integrators()[0];
    assert_eq!(entry.spec.name, "analytic");
    for damping in [0.0, 0.3, 2.0, 5.0] {
        let steps = 100;
        let map = measured_map(entry, (1.0, damping), 0.13, steps);
        let at_once = ExactOscillator::new(1.0, damping, 1.0).map(0.13 * f64::from(steps));
        // A hundred products of matrices near 1, each rounded.
        assert!(largest_entry(map - at_once) < 100.0 * 1e-15 * 10.0);
    }
}

#[test]
fn every_state_that_a_method_publishes_belongs_to_one_time() {
    // Otherwise energy and virial theorem would mix times. On the ellipse E = −½ exactly, so E − E₀ is
    // bounded by the declared order from the first step on. A velocity half a step away would show E
    // at order 1.
    for entry in general_methods() {
        let order = entry.spec.position_order as i32;
        let error = |dt: f64| {
            let mut rig = Kepler::for_orders().by(entry, dt);
            let off = (0..(1.0 / dt).round() as u32).map(|_| {
                rig.step();
                let (x, v) = (rig.state.positions[0], rig.state.velocities[0]);
                (0.5 * v.length_squared() - x.length().recip() + 0.5).abs()
            });
            off.fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(0.02), error(0.01));
        // Halving the step gains 2^order; 1.6^order leaves room for the next term.
        assert!(
            coarse / fine > 1.6_f64.powi(order) || fine < 1e-13,
            "{}: {coarse:e} {fine:e}",
            entry.spec.name
        );
    }
}

#[test]
fn forces_and_clock_belong_to_the_new_positions() {
    for entry in general_methods() {
        let mut rig = moving(entry, 0.004);
        for n in 1..=3 {
            rig.want = if n == 3 { Want::ENERGY } else { Want::NOTHING };
            rig.step();
            let state = &rig.state;
            let mut forces = vec![DVec3::ZERO; state.len()];
            let at = Configuration::at_rest(&state.cell, &state.positions);
            let found = Cluster.evaluate(at, Part::All, Want::ENERGY, &mut forces).unwrap();
            let name = entry.spec.name;
            assert_eq!(state.step, n, "{name}");
            assert!((state.time - 0.004 * n as f64).abs() < 1e-15, "{name}");
            // RESPA adds the two parts in another order.
            for (f, g) in state.forces.iter().zip(&forces) {
                assert!((*f - *g).length() <= 1e-12 * g.length().max(1.0), "{name}");
            }
            match (n, state.energetics.potential_energy) {
                (3, Some(u)) => {
                    assert!((u / found.potential_energy.unwrap() - 1.0).abs() < 1e-12);
                }
                (3, None) => panic!("{name}: no energy where it was asked for"),
                (_, Some(_)) => panic!("{name}: an energy where none was asked for"),
                (_, None) => {}
            }
        }
    }
}

#[test]
fn methods_that_kick_by_halves_move_with_the_velocities_of_half_steps_and_no_others_do() {
    let dt = 0.004;
    for entry in general_methods() {
        let rig = moving(entry, dt).steps(2);
        let before = rig.state.clone();
        let Rig { system, state, .. } = rig.steps(1);
        let mut worst = 0.0_f64;
        for i in 0..state.len() {
            let moved = (state.positions[i] - before.positions[i]) / dt;
            for (of, sign) in [(&before, 0.5), (&state, -0.5)] {
                let kick = sign * dt / system.masses.of(i) * of.forces[i];
                worst = worst.max((moved - of.velocities[i] - kick).length());
            }
        }
        // Positions are rounded, or on a grid, to some 1e-15, which dt magnifies; a force on the way shows at
        // dt² = 1e-5 times its change.
        let (declared, name) = (entry.spec.half_kicks, entry.spec.name);
        assert_eq!(worst < 1e-10, declared, "{name}: {worst:e}");
        assert!(declared || worst > 1e-8, "{name}: {worst:e}");
    }
}

#[test]
fn symplectic_methods_keep_phase_space_area_and_no_others_do() {
    for entry in integrators() {
        let map = measured_map(entry, (1.0, 0.0), 0.5, 1);
        let change = (map.determinant() - 1.0).abs();
        if entry.spec.symplectic {
            assert!(change < ROUNDING, "{}: {change:e}", entry.spec.name);
        } else {
            assert!(change > 0.1, "{}: {change:e}", entry.spec.name);
        }
    }
}

/// Runs to and fro on the cluster and returns the largest distance from the start.
fn distance_after_return(entry: &IntegratorEntry, dt: f64, n: u32) -> f64 {
    let rig = moving(entry, dt);
    let start = rig.state.clone();
    let mut rig = rig.steps(n);
    for v in &mut rig.state.velocities {
        *v = -*v;
    }
    rig.start();
    let state = rig.steps(n).state;
    let back: Vec<DVec3> = state.velocities.iter().map(|v| -*v).collect();
    farthest(&state.positions, &start.positions).max(farthest(&back, &start.velocities))
}

#[test]
fn reversible_methods_return_to_their_start_and_no_others_do() {
    for entry in general_methods() {
        let distance = distance_after_return(entry, 0.004, 100);
        if entry.spec.reversible {
            // 200 steps of rounding in velocities of the order 10 (1e-15/h for positions kept as
            // differences), grown by collisions.
            assert!(distance < 1e-9, "{}: {distance:e}", entry.spec.name);
        } else {
            assert!(distance > 1e-5, "{}: {distance:e}", entry.spec.name);
        }
    }
}

#[test]
fn force_evaluations_are_as_many_as_declared_and_reported() {
    for entry in general_methods() {
        let mut rig = Rig::of(entry.build(), moving_cluster(), Watched::new(Cluster), 0.004);
        rig.want = Want::NOTHING;
        for _ in 0..5 {
            let asked = |rig: &Rig<Watched<Cluster>>| {
                let forces = rig.forces.first();
                [forces.evaluations, forces.products]
            };
            let before = asked(&rig);
            let report = rig.step();
            let [made, products] = [0, 1].map(|k| asked(&rig)[k] - before[k]);
            let name = entry.spec.name;
            assert_eq!(made, u64::from(report.force_evaluations), "{name}");
            if entry.spec.force_evaluations != 0 {
                assert_eq!(made, u64::from(entry.spec.force_evaluations), "{name}");
            } else {
                assert_eq!(products, u64::from(report.iterations), "{name}");
                assert!(made > 0 && report.iterations > 0);
            }
        }
    }
}

#[test]
fn a_run_in_two_parts_is_the_same_run_to_the_bit() {
    for entry in general_methods() {
        let mut rig = moving(entry, 0.004);
        let whole = moving(entry, 0.004).steps(100).state;
        let again = moving(entry, 0.004).steps(40);
        let mut archive = StateArchive::default();
        again.state.save(&mut archive.writer().section("state"));
        again.method.save(&mut archive.writer().section("integrator"));
        drop(again);

        rig.method = entry.build();
        rig.state.restore(&archive.reader().section("state")).unwrap();
        rig.method.restore(&archive.reader().section("integrator")).unwrap();
        assert_eq!(rig.steps(60).state, whole, "{}", entry.spec.name);

        // Without any one of its entries an integrator must not restore quietly.
        for name in archive.arrays.keys().filter(|n| n.starts_with("integrator/")) {
            let mut without = archive.clone();
            without.arrays.remove(name);
            let restored = entry.build().restore(&without.reader().section("integrator"));
            assert!(restored.is_err(), "{} without {name}", entry.spec.name);
        }
    }
}

#[test]
fn total_momentum_is_conserved() {
    for entry in general_methods() {
        assert!(entry.spec.conserves_momentum);
        let rig = moving(entry, 0.004);
        let before = rig.momentum();
        let change = (rig.steps(500).momentum() - before).length();
        // 500 steps of 27 kicks, each rounded by some 1e-16.
        assert!(change < 1e-11, "{}: {change:e}", entry.spec.name);
    }
}

#[test]
fn symplectic_methods_keep_the_energy_within_a_bound_that_shrinks_with_the_step() {
    for entry in integrators().iter().filter(|e| e.spec.symplectic) {
        let order = entry.spec.position_order as i32;
        // The largest |E − E₀| of both halves of a run.
        let errors = |dt, steps| {
            let path = oscillation(entry, (1.0, 0.0), DVec2::new(1.0, 0.5), dt, steps);
            let off = |z: &DVec2| 0.5 * (z.length_squared() - path[0].length_squared()).abs();
            let (first, second) = path.split_at(path.len() / 2);
            [first, second].map(|half| half.iter().map(off).fold(0.0, f64::max))
        };
        let (coarse, fine) = (errors(0.2, 20_000), errors(0.1, 40_000));
        let name = entry.spec.name;
        // No drift: the second half is no worse than the first.
        assert!(coarse[1] <= coarse[0] * 1.001 + 1e-11, "{name}: {coarse:?}");
        if order > 0 {
            // (1/2)^order within 30 %: at h = 0.2 the next terms are (ωh)² = 4 % and their like.
            let gain = coarse[0] / fine[0];
            let expected = 2.0_f64.powi(order);
            assert!((gain / expected - 1.0).abs() < 0.3, "{name}: {gain}");
        }
    }
}

#[test]
fn exactly_the_methods_without_memory_take_new_velocities_without_a_new_start() {
    // Where nothing of other times is remembered, starting anew changes no bit; where something is, it must.
    let remembering =
        ["stormer-verlet", "stormer-verlet-time-corrected", "stormer-verlet-variable", "leapfrog"];
    for entry in general_methods() {
        let end = |start_anew: bool| {
            let mut rig = moving(entry, 0.004).steps(10);
            for v in &mut rig.state.velocities {
                *v *= 1.5;
            }
            if start_anew {
                rig.start();
            }
            rig.steps(10).state
        };
        let name = entry.spec.name;
        assert_eq!(end(true) != end(false), remembering.contains(&name), "{name}");
    }
}

#[test]
fn methods_that_accept_damping_follow_it_at_their_order() {
    let accepting: Vec<_> = integrators()
        .iter()
        .filter(|e| e.spec.velocity_dependent_forces)
        .map(|e| e.spec.name)
        .collect();
    let expected = ["analytic", "explicit-euler", "symplectic-euler", "spook"];
    assert_eq!(accepting, expected);
    for entry in general_methods().filter(|e| e.spec.velocity_dependent_forces) {
        let error = |steps: u32| {
            let forces = HarmonicForces::new(1.0).with_damping(0.5);
            let start = (System::atoms(1), one(DVec3::X, DVec3::ZERO));
            let rig = Rig::of(entry.build(), start, forces, 2.0 / f64::from(steps)).steps(steps);
            let exact = ExactOscillator::new(1.0, 0.5, 1.0).map(2.0).x_axis;
            (rig.state.positions[0].x - exact.x).abs()
        };
        let order = (error(2000) / error(4000)).log2();
        assert!((order - 1.0).abs() < 0.05, "{}: {order}", entry.spec.name);
    }
}

#[test]
fn methods_for_a_changing_step_keep_the_order_that_they_claim() {
    // The step swings by a half around its mean. Time-corrected Störmer–Verlet falls to order 1, as
    // its documentation says; all others keep their order.
    for entry in general_methods().filter(|e| !e.spec.fixed_step_only) {
        let order = match entry.spec.name {
            "stormer-verlet-time-corrected" => 1,
            _ => entry.spec.position_order,
        };
        let error = |mean: f64| {
            let orbit = Kepler::for_orders();
            let step_at = |t: f64| mean * (1.0 + 0.5 * (2.0 * t).sin());
            let mut rig = orbit.by(entry, step_at(0.0));
            while rig.state.time < 2.0 {
                rig.step();
                rig.dt = step_at(rig.state.time);
            }
            (rig.state.positions[0] - orbit.at(rig.state.time).0).length()
        };
        let mean = if order == 4 { 0.02 } else { 0.004 };
        let found = (error(mean) / error(0.5 * mean)).log2();
        assert!((found - f64::from(order)).abs() < 0.15, "{}: {found}", entry.spec.name);
    }
}
