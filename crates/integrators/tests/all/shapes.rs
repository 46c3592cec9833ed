//! Bonds of rings, branched molecules and rigid frames: each way against the others, and against answers that are known.

use std::sync::Arc;

use lennard_core::{
    Bond, Bonds, DVec3, ForceSum, Masses, Molecules, NoForces, State, System, Topology, rigid,
};
use lennard_integrators::BondOptions;
use lennard_integrators::bonds::spring::Scheme;
use lennard_integrators::bonds::{direct, spook, spring};

use crate::common::{Rig, at, direct, farthest, shake};

fn cut(tolerance: f64, max_group: u32) -> BondOptions {
    BondOptions::Direct(direct::Options { tolerance, max_group })
}

/// A molecule at rest with the bonds that its places have, in a box so wide that nothing folds.
fn molecule(places: &[DVec3], pairs: &[[usize; 2]], bonds: Bonds) -> (System, State) {
    let joined = pairs.iter().map(|sites| Bond {
        sites: *sites,
        length: (places[sites[1]] - places[sites[0]]).length(),
    });
    let topology = Topology::new(places.len(), joined.collect()).unwrap();
    let molecules = Molecules::new(Arc::new(topology), bonds);
    at(&molecules, places.to_vec(), vec![DVec3::ZERO; places.len()])
}

/// The same with velocities that turn and fold the molecule, without a part along rigid bonds.
fn thrown(places: &[DVec3], pairs: &[[usize; 2]], bonds: Bonds) -> (System, State) {
    let (system, mut state) = molecule(places, pairs, bonds);
    for (k, v) in state.velocities.iter_mut().enumerate() {
        let t = k as f64;
        *v = DVec3::new((1.7 * t).sin(), (2.3 * t + 0.4).cos(), (0.9 * t - 1.0).sin());
    }
    rigid::project_velocities(&system, &state.positions, &mut state.velocities);
    (system, state)
}

/// Steps without forces beside the bonds.
fn moved(bonds: &BondOptions, start: &(System, State), dt: f64, steps: u32) -> Rig<NoForces> {
    Rig::held(bonds, start.clone(), ForceSum::new(NoForces), dt).steps(steps)
}

fn apart(a: &Rig<NoForces>, b: &Rig<NoForces>) -> f64 {
    farthest(&a.state.positions, &b.state.positions)
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
        let start = thrown(&places, &pairs, Bonds::Rigid);
        for (steps, near) in [(1, 1e-12), (300, 1e-9)] {
            let [one, other] =
                [direct(1e-14), shake(1e-13)].map(|bonds| moved(&bonds, &start, 0.01, steps));
            assert!(apart(&one, &other) < near, "{pairs:?} {:e}", apart(&one, &other));
        }
    }
}

#[test]
fn molecules_of_any_shape_keep_bonds_energy_and_momenta() {
    for (places, pairs) in shapes() {
        let (system, mut state) = thrown(&places, &pairs, Bonds::Rigid);
        let masses = (0..places.len()).map(|k| 1.0 + 0.5 * k as f64);
        let system = system.with_masses(Masses::Each(masses.collect()));
        rigid::project_velocities(&system, &state.positions, &mut state.velocities);
        let start = moved(&direct(1e-13), &(system, state), 0.002, 0);
        let (momentum, angular) = (start.momentum(), start.angular_momentum(0.0));
        let kinetic = start.kinetic_energy();
        let end = start.steps(2000);
        assert!(end.worst.residual <= 1e-13, "{pairs:?} {:e}", end.worst.residual);
        let after = end.kinetic_energy();
        assert!((after / kinetic - 1.0).abs() < 1e-4, "{pairs:?} {kinetic} {after}");
        assert!((end.momentum() - momentum).length() < 1e-11);
        assert!((end.angular_momentum(0.0) - angular).length() < 1e-9 * angular.length());
        for bond in end.system.molecules.bonds() {
            let (d, w) = (bond.vector(&end.state.positions), bond.vector(&end.state.velocities));
            assert!(d.dot(w).abs() < 1e-11);
        }
    }
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
            let mut start = molecule(&places, &pairs, Bonds::Rigid);
            start.1.velocities = vec![
                DVec3::new(-q, -0.4, 0.3),
                DVec3::new(-q, 0.22, -0.4),
                DVec3::new(2.0 * q, 0.18, 0.1),
            ];
            let end = moved(&direct(1e-14), &start, 5.0 / f64::from(steps), steps);
            farthest(&end.state.positions, &wanted)
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
    let start = thrown(&places, &chain, Bonds::Rigid);
    let whole = moved(&direct(1e-13), &start, 0.005, 50);
    for most in [1, 3, 5] {
        let cut = moved(&cut(1e-13, most), &start, 0.005, 50);
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
            let mut start = molecule(&places, &pairs, Bonds::Rigid);
            // Drifted so that each bond is a little too long.
            start.1.velocities = places.clone();
            moved(&cut(tolerance, p), &start, 1e-6, 1).worst
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
            let start = thrown(&places, &pairs, Bonds::Rigid);
            let [one, other] =
                [0, 3000].map(|sweeps| moved(&spook(compliance, sweeps), &start, 0.01, 20));
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
        let mut start = molecule(&places, &pairs, Bonds::Springs);
        start.1.velocities = places.clone();
        moved(&spook(compliance, sweeps), &start, dt, 1)
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
    let start = thrown(&square, &pairs, Bonds::Springs);
    assert_eq!(start.0.molecules.topology().unwrap().redundant_bond(&square, |_| false), Some(5));
    let end = moved(&spook(1e-6, 0), &start, 0.005, 2000);
    for bond in end.system.molecules.bonds() {
        let strain = bond.vector(&end.state.positions).length() / bond.length - 1.0;
        assert!(strain.abs() < 1e-3, "{strain}");
    }
}

#[test]
fn two_molecules_of_one_topology_are_each_solved_for() {
    let (places, pairs) = shapes().pop().unwrap();
    let one = thrown(&places, &pairs, Bonds::Rigid);
    let shift = DVec3::new(30.0, 0.0, 0.0);
    let shifted: Vec<DVec3> = places.iter().map(|r| *r + shift).collect();
    let velocities = [one.1.velocities.clone(), vec![DVec3::ZERO; places.len()]].concat();
    let x = [places.clone(), shifted.clone()].concat();
    let mut two = at(&one.0.molecules, x, vec![DVec3::ZERO; 2 * places.len()]);
    two.1.velocities = velocities;
    let alone = moved(&direct(1e-13), &one, 0.01, 50).state.positions;
    let both = moved(&direct(1e-13), &two, 0.01, 50).state.positions;
    let (first, second) = both.split_at(places.len());
    assert_eq!(first, alone);
    assert!(farthest(second, &shifted) < 1e-12);
}

fn springs(stiffness: f64, damping: f64, scheme: Scheme) -> BondOptions {
    BondOptions::Spring(spring::Options { stiffness, damping, scheme })
}

#[test]
fn midpoint_springs_keep_energy_and_momenta_where_explicit_ones_would_diverge() {
    for (places, pairs) in shapes() {
        let start = thrown(&places, &pairs, Bonds::Impulses);
        // ω·h is 2.8 for one bond alone.
        let start = moved(&springs(1e6, 0.0, Scheme::Midpoint), &start, 0.002, 0);
        let (momentum, angular) = (start.momentum(), start.angular_momentum(0.0));
        let energy = start.conserved();
        let end = start.steps(2000);
        let after = end.conserved();
        assert!((after / energy - 1.0).abs() < 0.1, "{pairs:?}: {energy} {after}");
        assert!((end.momentum() - momentum).length() < 1e-10);
        let turned = (end.angular_momentum(0.0) - angular).length();
        assert!(turned < 1e-9 * angular.length().max(1.0));
    }
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

/// A stretched bond between masses of 1 and 3.
fn damped(options: &BondOptions, h: f64) -> Rig<NoForces> {
    let (system, mut state) = molecule(&[DVec3::ZERO, DVec3::X], &[[0, 1]], Bonds::Impulses);
    state.positions[1].x += 0.01;
    moved(options, &(system.with_masses(Masses::Each(vec![1.0, 3.0])), state), h, 0)
}

fn strain(rig: &Rig<NoForces>) -> f64 {
    rig.state.positions[1].x - rig.state.positions[0].x - 1.0
}

#[test]
fn damped_springs_follow_their_equations_and_count_what_they_take_as_heat() {
    let (k, kappa) = (5000.0, 4.0 / 3.0);
    let omega = f64::sqrt(k * kappa);
    for scheme in SCHEMES {
        // Implicit springs are stable at any step, and need no damping.
        let any = [(0.3, 0.0), (3.0, 0.0), (40.0, 0.0)];
        let any = any.into_iter().filter(|_| scheme != Scheme::Explicit);
        for (s, b) in [(0.3, 0.05), (1.0, 1.0), (1.9, 4.0), (0.1, 30.0)].into_iter().chain(any) {
            let h = s / omega;
            let mut rig = damped(&springs(k, b / (kappa * h), scheme), h);
            let (mut wanted, mut wanted_heat) = ([0.01, 0.0], 0.0);
            for step in 0..=40 {
                let rate = h * (rig.state.velocities[1].x - rig.state.velocities[0].x);
                let off = f64::hypot(strain(&rig) - wanted[0], rate - wanted[1]);
                let at = format!("{scheme:?} s = {s}, b = {b}, step {step}");
                assert!(off < 1e-12, "{at}: {off:e}");
                let off = rig.heat / (0.5 * k) - wanted_heat;
                assert!(off.abs() < 1e-13, "{at}: {:e}, off by {off:e}", rig.heat);
                let put_in;
                (wanted, put_in) = damped_step(scheme, s, b, wanted);
                wanted_heat += put_in;
                rig.step();
            }
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
            let mut rig = damped(&springs(k, b / (kappa * h), Scheme::Explicit), h);
            (0..150).fold(0.0_f64, |largest, _| {
                rig.step();
                largest.max(strain(&rig).abs())
            })
        };
        assert!(largest(0.99) < 0.2, "b = {b}: {:e}", largest(0.99));
        assert!(largest(1.03) > 1.0, "b = {b}: {:e}", largest(1.03));
    }
}

/// Dashpots of bonds that share sites act in one order before the drift and in the other after it: a step is of order two.
#[test]
fn damped_springs_of_any_shape_are_of_their_order() {
    let (places, pairs) = shapes().pop().unwrap();
    let start = thrown(&places, &pairs, Bonds::Impulses);
    for (scheme, wanted) in SCHEMES.into_iter().zip([2.0, 2.0, 1.0]) {
        let bonds = springs(200.0, 5.0, scheme);
        let end = |steps: u32| moved(&bonds, &start, 0.4 / f64::from(steps), steps);
        let exact = end(102_400);
        let errors = [400, 1600].map(|steps| apart(&end(steps), &exact));
        let order = (errors[0] / errors[1]).log2() / 2.0;
        assert!((order - wanted).abs() < 0.1, "{scheme:?}: {order}, {errors:?}");
    }
}
