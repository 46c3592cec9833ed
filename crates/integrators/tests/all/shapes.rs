//! Bonds of rings, branched molecules and rigid frames: each way against the others, and against answers that are known.

use std::sync::Arc;

use lennard_core::{
    Bond, Bonds, DVec3, ForceSum, Integrator, Masses, Molecules, NoForces, PeriodicBox, State,
    StepReport, System, Topology, Want, rigid,
};
use lennard_integrators::bonds::spring::Scheme;
use lennard_integrators::bonds::{direct, relaxation, spook, spring};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build};

fn direct(tolerance: f64, max_group: u32) -> BondOptions {
    BondOptions::Direct(direct::Options { tolerance, max_group })
}

fn shake(tolerance: f64) -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(tolerance),
        ..Default::default()
    })
}

/// A molecule at rest with the bonds that its places have, in a box so wide that nothing folds.
fn molecule(places: &[DVec3], pairs: &[[usize; 2]], bonds: Bonds) -> (System, State) {
    let joined = pairs.iter().map(|sites| Bond {
        sites: *sites,
        length: (places[sites[1]] - places[sites[0]]).length(),
    });
    let topology = Topology::new(places.len(), joined.collect()).unwrap();
    let molecules = Molecules::new(Arc::new(topology), bonds);
    let system = System::of_molecules(places.len(), molecules);
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let state = State::new(cell, places.to_vec(), vec![DVec3::ZERO; places.len()]);
    (system, state)
}

/// Velocities that turn and fold the molecule, without a part along its bonds.
fn throw(system: &System, state: &mut State) {
    for (k, v) in state.velocities.iter_mut().enumerate() {
        let t = k as f64;
        *v = DVec3::new((1.7 * t).sin(), (2.3 * t + 0.4).cos(), (0.9 * t - 1.0).sin());
    }
    rigid::project_velocities(system, &state.positions, &mut state.velocities);
}

fn method(system: &System, bonds: &BondOptions) -> Integrator {
    match bonds.build(&system.molecules) {
        BondHolder::Drift(solver) | BondHolder::InDrift(solver, _) => {
            build(&IntegratorOptions::default()).with_bonds(solver)
        }
        BondHolder::Spook(bonds, _) => lennard_integrators::spook::with_bonds(bonds),
        BondHolder::Spring(_) => panic!("springs are forces"),
    }
}

/// Takes steps without forces; returns the largest iterations and residual of all.
fn run(system: &System, state: &mut State, bonds: &BondOptions, dt: f64, steps: u32) -> StepReport {
    let mut integrator = method(system, bonds);
    let mut worst = StepReport::default();
    integrator.start(system, state, &mut NoForces, dt, Want::NOTHING).unwrap();
    for _ in 0..steps {
        let report = integrator.step(system, state, &mut NoForces, dt, Want::NOTHING);
        let report = report.unwrap_or_else(|e| panic!("{e}"));
        worst.iterations = worst.iterations.max(report.iterations);
        worst.residual = worst.residual.max(report.residual);
    }
    worst
}

fn apart(a: &State, b: &State) -> f64 {
    let both = a.positions.iter().zip(&b.positions);
    both.map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
}

fn on_a_circle(n: usize) -> Vec<DVec3> {
    (0..n)
        .map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            // Not quite flat, as a ring of a fluid is not.
            DVec3::new(angle.cos(), angle.sin(), 0.1 * (k % 3) as f64)
        })
        .collect()
}

fn ring(n: usize) -> Vec<[usize; 2]> {
    (0..n).map(|k| [k, (k + 1) % n]).collect()
}

/// Molecules of all kinds of equations: few bonds, a ring, a branched one, a rigid frame, a ring with a tail.
fn shapes() -> Vec<(Vec<DVec3>, Vec<[usize; 2]>)> {
    let frame = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let star = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X];
    let tail = [on_a_circle(5), vec![DVec3::new(2.0, 0.2, 0.0), DVec3::new(2.5, 1.0, 0.3)]];
    // Chains of 2, 5 and 10 bonds.
    let chain = |bonds: usize| {
        let place = |k: usize| DVec3::new(0.9 * k as f64, 0.4 * (k % 2) as f64, 0.1 * k as f64);
        let places: Vec<DVec3> = (0..=bonds).map(place).collect();
        (places, (1..=bonds).map(|k| [k - 1, k]).collect())
    };
    vec![
        chain(2),
        chain(5),
        chain(10),
        (on_a_circle(3), ring(3)),
        (on_a_circle(6), ring(6)),
        (star[..4].to_vec(), vec![[0, 1], [0, 2], [3, 0]]),
        (star.to_vec(), vec![[0, 1], [2, 0], [0, 3], [4, 0]]),
        (frame, vec![[0, 1], [0, 2], [0, 3], [1, 2], [2, 3], [3, 1]]),
        (tail.concat(), [ring(5), vec![[0, 5], [6, 5]]].concat()),
    ]
}

#[test]
fn relaxation_and_the_direct_solution_agree_on_molecules_of_any_shape() {
    for (places, pairs) in shapes() {
        let (system, mut one) = molecule(&places, &pairs, Bonds::Rigid);
        throw(&system, &mut one);
        let mut other = one.clone();
        run(&system, &mut one, &direct(1e-14, 0), 0.01, 1);
        run(&system, &mut other, &shake(1e-13), 0.01, 1);
        assert!(apart(&one, &other) < 1e-12, "{pairs:?} {:e}", apart(&one, &other));
        run(&system, &mut one, &direct(1e-14, 0), 0.01, 300);
        run(&system, &mut other, &shake(1e-13), 0.01, 300);
        assert!(apart(&one, &other) < 1e-9, "{pairs:?} {:e}", apart(&one, &other));
    }
}

#[test]
fn molecules_of_any_shape_keep_bonds_energy_and_momenta() {
    for (places, pairs) in shapes() {
        let (mut system, mut state) = molecule(&places, &pairs, Bonds::Rigid);
        let masses = (0..places.len()).map(|k| 1.0 + 0.5 * k as f64);
        system.masses = Masses::Each(masses.collect());
        throw(&system, &mut state);
        let momentum = system.momentum(&state.velocities);
        let angular = |state: &State| -> DVec3 {
            let sites = 0..places.len();
            let of = |k| system.masses.of(k) * state.positions[k].cross(state.velocities[k]);
            sites.map(of).sum()
        };
        let before = angular(&state);
        let kinetic = system.kinetic_energy(&state.velocities);
        let worst = run(&system, &mut state, &direct(1e-13, 0), 0.002, 2000);
        assert!(worst.residual <= 1e-13, "{pairs:?} {:e}", worst.residual);
        let after = system.kinetic_energy(&state.velocities);
        assert!((after / kinetic - 1.0).abs() < 1e-4, "{pairs:?} {kinetic} {after}");
        assert!((system.momentum(&state.velocities) - momentum).length() < 1e-11);
        assert!((angular(&state) - before).length() < 1e-9 * before.length());
        for bond in system.molecules.bonds() {
            let w = state.velocities[bond.sites[1]] - state.velocities[bond.sites[0]];
            assert!(bond.vector(&state.positions).dot(w).abs() < 1e-11);
        }
    }
}

#[test]
fn the_order_in_which_bonds_are_listed_changes_nothing_but_round_off() {
    // In order a chain is tridiagonal; out of order it has sparse equations.
    let places: Vec<DVec3> = (0..8)
        .map(|k| DVec3::new(0.9 * f64::from(k), f64::from(k % 2), 0.1 * f64::from(k * k % 5)))
        .collect();
    let chain: Vec<[usize; 2]> = (1..8).map(|k| [k - 1, k]).collect();
    let mut shuffled: Vec<[usize; 2]> = [3, 0, 6, 2, 5, 1, 4].map(|c| chain[c]).to_vec();
    shuffled[2].reverse();
    let (system, mut one) = molecule(&places, &chain, Bonds::Rigid);
    let (listed, mut other) = molecule(&places, &shuffled, Bonds::Rigid);
    assert!(system.molecules.topology().unwrap().is_chain());
    assert!(!listed.molecules.topology().unwrap().is_chain());
    throw(&system, &mut one);
    throw(&listed, &mut other);
    run(&system, &mut one, &direct(1e-14, 0), 0.005, 100);
    run(&listed, &mut other, &direct(1e-14, 0), 0.005, 100);
    assert!(apart(&one, &other) < 1e-10, "{:e}", apart(&one, &other));
}

/// Three sites with two bonds against a solution of a Runge–Kutta method of order 8 with a tolerance of 2.3e-14.
#[test]
fn a_free_trimer_meets_its_high_precision_solution_with_order_two() {
    let q = 0.04 / 3.0_f64.sqrt();
    let places = [DVec3::ZERO, DVec3::X, DVec3::new(1.5, 0.75_f64.sqrt(), 0.0)];
    let wanted = [
        DVec3::new(0.739600924900, 0.534129558068, -0.289016939732),
        DVec3::new(0.826543972109, -0.326447915509, 0.212826978746),
        DVec3::new(0.933855102990, 0.658343761226, 0.076189960986),
    ];
    // The second list has the same bonds in an order that is no chain.
    for pairs in [[[0, 1], [1, 2]], [[1, 0], [1, 2]]] {
        let error = |steps: u32| {
            let (system, mut state) = molecule(&places, &pairs, Bonds::Rigid);
            state.velocities = vec![
                DVec3::new(-q, -0.4, 0.3),
                DVec3::new(-q, 0.22, -0.4),
                DVec3::new(2.0 * q, 0.18, 0.1),
            ];
            run(&system, &mut state, &direct(1e-14, 0), 5.0 / f64::from(steps), steps);
            let both = state.positions.iter().zip(&wanted);
            both.map(|(x, y)| (*x - *y).length()).fold(0.0, f64::max)
        };
        let errors = [1000, 2000, 4000].map(error);
        assert!(errors[2] < 2e-5, "{pairs:?} {errors:?}");
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!((order - 2.0).abs() < 0.05, "{pairs:?} {order}: {errors:?}");
    }
}

#[test]
fn a_chain_that_is_cut_moves_as_a_whole_one() {
    let places: Vec<DVec3> =
        (0..11).map(|k| DVec3::new(0.9 * f64::from(k), f64::from(k % 2) * 0.3, 0.0)).collect();
    let chain: Vec<[usize; 2]> = (1..11).map(|k| [k - 1, k]).collect();
    let (system, mut whole) = molecule(&places, &chain, Bonds::Rigid);
    throw(&system, &mut whole);
    let start = whole.clone();
    run(&system, &mut whole, &direct(1e-13, 0), 0.005, 50);
    for most in [1, 3, 5] {
        let mut cut = start.clone();
        run(&system, &mut cut, &direct(1e-13, most), 0.005, 50);
        assert!(apart(&whole, &cut) < 1e-10, "{most}: {:e}", apart(&whole, &cut));
    }
}

/// Two parts of p and q bonds of a straight chain converge by pq/((p + 1)(q + 1)) a sweep.
#[test]
fn parts_of_a_straight_chain_converge_by_their_law() {
    for (p, q) in [(2_u32, 2_u32), (5, 5), (5, 3)] {
        let n = (p + q + 1) as usize;
        let places: Vec<DVec3> = (0..n).map(|k| DVec3::new(k as f64, 0.0, 0.0)).collect();
        let pairs: Vec<[usize; 2]> = (1..n).map(|k| [k - 1, k]).collect();
        let ended = |tolerance: f64| {
            let (system, mut state) = molecule(&places, &pairs, Bonds::Rigid);
            // Drifted so that each bond is a little too long.
            state.velocities = places.clone();
            run(&system, &mut state, &direct(tolerance, p), 1e-6, 1)
        };
        let law = f64::from(p * q) / f64::from((p + 1) * (q + 1));
        let (early, late) = (ended(1e-8), ended(1e-12));
        let sweeps = f64::from(late.iterations - early.iterations);
        let rate = (late.residual / early.residual).powf(1.0 / sweeps);
        assert!((rate / law - 1.0).abs() < 0.01, "{p} + {q}: {rate} against {law}");
    }
}

fn spook(compliance: f64, sweeps: u32) -> BondOptions {
    BondOptions::Spook(spook::Options { compliance, sweeps, ..Default::default() })
}

#[test]
fn sweeps_of_spook_converge_to_its_direct_solution() {
    for (places, pairs) in shapes() {
        for compliance in [0.0, 1e-4] {
            let (system, mut one) = molecule(&places, &pairs, Bonds::Rigid);
            throw(&system, &mut one);
            let mut other = one.clone();
            run(&system, &mut one, &spook(compliance, 0), 0.01, 20);
            run(&system, &mut other, &spook(compliance, 3000), 0.01, 20);
            let off = apart(&one, &other);
            assert!(off < 1e-12, "{pairs:?} {compliance}: {off:e}");
        }
    }
}

/// On a straight chain of n bonds the rate is (2cos(π/(n + 1))/(2 + mΣ))².
#[test]
fn sweeps_of_spook_converge_by_their_law() {
    let n = 6;
    let places: Vec<DVec3> = (0..=n).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)).collect();
    let pairs: Vec<[usize; 2]> = (1..=n as usize).map(|k| [k - 1, k]).collect();
    let (dt, compliance) = (0.01, 1e-5);
    let end = |sweeps: u32| {
        let (system, mut state) = molecule(&places, &pairs, Bonds::Springs);
        state.velocities = places.clone();
        run(&system, &mut state, &spook(compliance, sweeps), dt, 1);
        state
    };
    let exact = end(0);
    // Σ = 4ε/(h²(1 + 4τ/h)) with τ = 2h.
    let sigma = 4.0 * compliance / (dt * dt) / 9.0;
    let law = (2.0 * (std::f64::consts::PI / 7.0).cos() / (2.0 + sigma)).powi(2);
    let rate = (apart(&end(48), &exact) / apart(&end(40), &exact)).powf(1.0 / 8.0);
    assert!((rate / law - 1.0).abs() < 0.01, "{rate} against {law}");
}

#[test]
fn spook_with_a_compliance_takes_bonds_that_follow_from_others() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let square = square.map(|[x, y]| DVec3::new(x, y, 0.0));
    let pairs = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];
    let (system, mut state) = molecule(&square, &pairs, Bonds::Springs);
    assert_eq!(system.molecules.topology().unwrap().redundant_bond(&square, |_| false), Some(5));
    throw(&system, &mut state);
    run(&system, &mut state, &spook(1e-6, 0), 0.005, 2000);
    for bond in system.molecules.bonds() {
        let strain = bond.vector(&state.positions).length() / bond.length - 1.0;
        assert!(strain.abs() < 1e-3, "{strain}");
    }
}

#[test]
fn two_molecules_of_one_topology_are_each_solved_for() {
    let (places, pairs) = shapes().pop().unwrap();
    let (one, mut alone) = molecule(&places, &pairs, Bonds::Rigid);
    throw(&one, &mut alone);
    let system = System::of_molecules(2 * places.len(), one.molecules.clone());
    let shift = DVec3::new(30.0, 0.0, 0.0);
    let shifted = places.iter().map(|r| *r + shift);
    let positions = places.iter().copied().chain(shifted).collect();
    let velocities = [alone.velocities.clone(), vec![DVec3::ZERO; places.len()]].concat();
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let mut both = State::new(cell, positions, velocities);
    run(&one, &mut alone, &direct(1e-13, 0), 0.01, 50);
    run(&system, &mut both, &direct(1e-13, 0), 0.01, 50);
    assert_eq!(both.positions[..places.len()], alone.positions[..]);
    for (r, place) in both.positions[places.len()..].iter().zip(&places) {
        assert!((*r - *place - shift).length() < 1e-12);
    }
}

fn springs(stiffness: f64, scheme: Scheme) -> BondOptions {
    damped_springs(stiffness, 0.0, scheme)
}

fn damped_springs(stiffness: f64, damping: f64, scheme: Scheme) -> BondOptions {
    BondOptions::Spring(spring::Options { stiffness, damping, scheme })
}

/// ½k(|d| − r)² of all bonds and the kinetic energy.
fn energy(system: &System, state: &State, stiffness: f64) -> f64 {
    let strain = |bond: &Bond| bond.vector(&state.positions).length() - bond.length;
    let stretched: f64 =
        (system.molecules.bonds().iter()).map(|bond| 0.5 * stiffness * strain(bond).powi(2)).sum();
    stretched + system.kinetic_energy(&state.velocities)
}

/// A spring of ω between two unit masses along x, stretched and at rest: strain and its velocity over ω after some steps.
fn vibration(scheme: Scheme, s: f64, steps: u32) -> Vec<[f64; 2]> {
    let stiffness: f64 = 5000.0;
    let omega = (2.0 * stiffness).sqrt();
    let (system, mut state) = molecule(&[DVec3::ZERO, DVec3::X], &[[0, 1]], Bonds::Impulses);
    state.positions[1].x += 0.01;
    let bonds = springs(stiffness, scheme);
    let mut found = Vec::new();
    for _ in 0..=steps {
        let strain = state.positions[1].x - state.positions[0].x - 1.0;
        let rate = state.velocities[1].x - state.velocities[0].x;
        found.push([strain, rate / omega]);
        run(&system, &mut state, &bonds, s / omega, 1);
    }
    found
}

#[test]
fn implicit_springs_vibrate_by_their_laws_at_any_step() {
    for s in [0.3_f64, 1.0, 3.0, 40.0] {
        // The midpoint rule keeps the energy and turns by 2·atan(s/2); the implicit Euler rule damps and turns by atan(s).
        let laws = [
            (Scheme::Midpoint, 2.0 * (0.5 * s).atan(), 1.0),
            (Scheme::LinearlyImplicit, f64::atan(s), 1.0 / f64::hypot(1.0, s)),
        ];
        for (scheme, angle, factor) in laws {
            let motion = vibration(scheme, s, 8);
            for (n, [strain, rate]) in motion.iter().enumerate() {
                let (turned, amplitude) = (angle * n as f64, 0.01 * factor.powi(n as i32));
                let off =
                    f64::hypot(strain - amplitude * turned.cos(), rate + amplitude * turned.sin());
                assert!(off < 1e-12, "{scheme:?} s = {s}, step {n}: {off:e}");
            }
        }
    }
}

#[test]
fn midpoint_springs_keep_energy_and_momenta_where_explicit_ones_would_diverge() {
    let stiffness = 1e6;
    for (places, pairs) in shapes() {
        let (system, mut state) = molecule(&places, &pairs, Bonds::Impulses);
        throw(&system, &mut state);
        let momentum = system.momentum(&state.velocities);
        let angular = |state: &State| -> DVec3 {
            let both = state.positions.iter().zip(&state.velocities);
            both.map(|(x, v)| x.cross(*v)).sum()
        };
        let (before, start) = (angular(&state), energy(&system, &state, stiffness));
        // ω·h is 2.8 for one bond alone.
        run(&system, &mut state, &springs(stiffness, Scheme::Midpoint), 0.002, 2000);
        let after = energy(&system, &state, stiffness);
        assert!((after / start - 1.0).abs() < 0.1, "{pairs:?}: {start} {after}");
        assert!((system.momentum(&state.velocities) - momentum).length() < 1e-10);
        assert!((angular(&state) - before).length() < 1e-9 * before.length().max(1.0));
    }
}

/// A fast vibration has the phase π − 4/(ωh) per step: it resonates with the turn Ωh of the bond at Ω·ω·h² = 4.
#[test]
fn a_turning_midpoint_spring_is_stable_up_to_its_resonance() {
    let (omega, stiffness) = (2.0, 16_000.0_f64);
    let longest = |share: f64| {
        let places = [-0.5 * DVec3::X, 0.5 * DVec3::X];
        let bonds = springs(stiffness, Scheme::Midpoint);
        let (system, mut state) = molecule(&places, &[[0, 1]], Bonds::Impulses);
        state.velocities = places.map(|x| omega * DVec3::Z.cross(x)).to_vec();
        state.positions.iter_mut().for_each(|x| *x *= 1.001);
        let h = (share * 4.0 / (omega * (2.0 * stiffness).sqrt())).sqrt();
        let mut longest = 0.0_f64;
        for _ in 0..2000 {
            run(&system, &mut state, &bonds, h, 1);
            longest = longest.max((state.positions[1] - state.positions[0]).length());
            if longest > 1.5 {
                break;
            }
        }
        longest
    };
    assert!(longest(0.9) < 1.1, "{}", longest(0.9));
    assert!(longest(1.1) > 1.5, "{}", longest(1.1));
}

/// At a step that resolves the vibration the scheme is of order two.
#[test]
fn midpoint_springs_are_of_order_two() {
    let (places, pairs) = shapes().pop().unwrap();
    let end = |steps: u32| {
        let (system, mut state) = molecule(&places, &pairs, Bonds::Impulses);
        throw(&system, &mut state);
        let bonds = springs(200.0, Scheme::Midpoint);
        run(&system, &mut state, &bonds, 0.4 / f64::from(steps), steps);
        state
    };
    let exact = end(6400);
    let errors = [100, 400].map(|steps| apart(&end(steps), &exact));
    let order = (errors[0] / errors[1]).log2() / 2.0;
    assert!((order - 2.0).abs() < 0.05, "{order}: {errors:?}");
}

/// A step of one bond with s = ωh and b = c·κ·h, on (x, h·v): each scheme by its own equations. The energy put in, over k/2, comes with it.
fn damped_step(scheme: Scheme, s: f64, b: f64, [x, v]: [f64; 2]) -> ([f64; 2], f64) {
    let s2 = s * s;
    let energy = |x: f64, v: f64| x * x + v * v / s2;
    let [next, after] = match scheme {
        Scheme::Explicit => {
            let half = (-0.5 * b).exp();
            let kicked = v - 0.5 * s2 * x;
            let slow = half * kicked;
            let x = x + slow;
            let heat = energy(0.0, half * slow) - energy(0.0, kicked);
            return ([x, half * slow - 0.5 * s2 * x], heat);
        }
        Scheme::Midpoint => {
            let after = ((1.0 - 0.5 * b - 0.25 * s2) * v - s2 * x) / (1.0 + 0.5 * b + 0.25 * s2);
            [x + 0.5 * (v + after), after]
        }
        Scheme::LinearlyImplicit => {
            let after = (v - s2 * x) / (1.0 + b + s2);
            [x + after, after]
        }
    };
    ([next, after], energy(next, after) - energy(x, v))
}

const SCHEMES: [Scheme; 3] = [Scheme::Explicit, Scheme::Midpoint, Scheme::LinearlyImplicit];

/// A stretched bond between masses of 1 and 3, under springs that are forces too.
fn run_damped(options: &BondOptions, h: f64, steps: u32, mut look: impl FnMut(&State, f64)) {
    let places = [DVec3::ZERO, DVec3::X];
    let (mut system, mut state) = molecule(&places, &[[0, 1]], Bonds::Impulses);
    system.masses = Masses::Each(vec![1.0, 3.0]);
    state.positions[1].x += 0.01;
    let mut forces = ForceSum::new(NoForces);
    let BondHolder::InDrift(solver, term) = options.build(&system.molecules) else {
        panic!("damped springs act in drifts")
    };
    forces.push(term);
    let mut method = build(&IntegratorOptions::default()).with_bonds(solver);
    method.start(&system, &mut state, &mut forces, h, Want::TOTALS).unwrap();
    look(&state, 0.0);
    let mut heat = 0.0;
    for _ in 0..steps {
        let report = method.step(&system, &mut state, &mut forces, h, Want::TOTALS).unwrap();
        heat += report.heat;
        look(&state, heat);
    }
}

#[test]
fn damped_springs_follow_their_equations_and_count_what_they_take_as_heat() {
    let (k, kappa) = (5000.0, 4.0 / 3.0);
    let omega = f64::sqrt(k * kappa);
    for scheme in SCHEMES {
        for (s, b) in [(0.3, 0.05), (1.0, 1.0), (1.9, 4.0), (0.1, 30.0)] {
            let h = s / omega;
            let options = damped_springs(k, b / (kappa * h), scheme);
            let (mut wanted, mut wanted_heat, mut steps) = ([0.01, 0.0], 0.0, 0);
            run_damped(&options, h, 40, |state, heat| {
                let strain = state.positions[1].x - state.positions[0].x - 1.0;
                let rate = h * (state.velocities[1].x - state.velocities[0].x);
                let off = f64::hypot(strain - wanted[0], rate - wanted[1]);
                let at = format!("{scheme:?} s = {s}, b = {b}, step {steps}");
                assert!(off < 1e-12, "{at}: {off:e}");
                let off = heat / (0.5 * k) - wanted_heat;
                assert!(off.abs() < 1e-13, "{at}: {heat:e}, off by {off:e}");
                let put_in;
                (wanted, put_in) = damped_step(scheme, s, b, wanted);
                wanted_heat += put_in;
                steps += 1;
            });
        }
    }
}

/// The bound of a step is the one of springs without dashpots, ωh < 2, or above it: (ωh)² < 2·(g + 1/g) with g = e^{−cκh/2}.
#[test]
fn dashpots_do_not_make_the_longest_step_of_springs_shorter() {
    let (k, kappa) = (5000.0, 4.0 / 3.0);
    let omega = f64::sqrt(k * kappa);
    for b in [0.01, 1.0, 6.0] {
        let g = f64::exp(-0.5 * b);
        let limit = f64::sqrt(2.0 * (g + 1.0 / g));
        assert!(limit >= 2.0);
        let largest = |share: f64| {
            let h = share * limit / omega;
            let options = damped_springs(k, b / (kappa * h), Scheme::Explicit);
            let mut largest = 0.0_f64;
            run_damped(&options, h, 150, |state, _| {
                let strain = state.positions[1].x - state.positions[0].x - 1.0;
                largest = largest.max(strain.abs());
            });
            largest
        };
        assert!(largest(0.99) < 0.2, "b = {b}: {:e}", largest(0.99));
        assert!(largest(1.03) > 1.0, "b = {b}: {:e}", largest(1.03));
    }
}

/// Dashpots of bonds that share sites act in one order before the drift and in the other after it: a step is of order two.
#[test]
fn damped_springs_of_any_shape_are_of_their_order() {
    let (places, pairs) = shapes().pop().unwrap();
    for (scheme, wanted) in SCHEMES.into_iter().zip([2.0, 2.0, 1.0]) {
        let end = |steps: u32| {
            let (system, mut state) = molecule(&places, &pairs, Bonds::Impulses);
            throw(&system, &mut state);
            let bonds = damped_springs(200.0, 5.0, scheme);
            let BondHolder::InDrift(solver, term) = bonds.build(&system.molecules) else {
                panic!("damped springs act in drifts")
            };
            let mut forces = ForceSum::new(NoForces);
            forces.push(term);
            let mut method = build(&IntegratorOptions::default()).with_bonds(solver);
            let dt = 0.4 / f64::from(steps);
            method.start(&system, &mut state, &mut forces, dt, Want::NOTHING).unwrap();
            for _ in 0..steps {
                method.step(&system, &mut state, &mut forces, dt, Want::NOTHING).unwrap();
            }
            state
        };
        let exact = end(102_400);
        let errors = [400, 1600].map(|steps| apart(&end(steps), &exact));
        let order = (errors[0] / errors[1]).log2() / 2.0;
        assert!((order - wanted).abs() < 0.1, "{scheme:?}: {order}, {errors:?}");
    }
}
