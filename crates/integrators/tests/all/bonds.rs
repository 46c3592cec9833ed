//! Rigid bonds and springs, against answers that are known. The study of mechanics judges the claims about them.

use lennard_core::{
    Backend, Bonds, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceSum,
    ForceTerm, Masses, Molecules, NoForces, Part, PeriodicBox, State, System, Want, rigid,
};
use lennard_forcefield::ConstantField;
use lennard_integrators::bonds::{relaxation, spring};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build};

use crate::common::{Rig, add_pairs, at, direct, farthest, shake};

const G: f64 = 9.81;

fn projection() -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(1e-13),
        direction: relaxation::Direction::New,
        ..Default::default()
    })
}

fn falling() -> ForceSum<NoForces> {
    ForceSum::new(NoForces).with(ConstantField::new(-G * DVec3::Z, Masses::Uniform(1.0)))
}

/// Chains in gravity whose first site is held.
fn hanging(molecules: &Molecules, x: Vec<DVec3>, v: Vec<DVec3>, dt: f64) -> Rig<NoForces> {
    let (system, state) = at(molecules, x, v);
    Rig::held(&direct(1e-14), (system.holding(&[0]), state), falling(), dt)
}

/// Lennard-Jones forces between the sites of different dumbbells, without a cutoff.
struct BetweenDumbbells;

lennard_core::remembers_nothing!(BetweenDumbbells);

impl ForceTerm for BetweenDumbbells {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        _part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        forces.fill(DVec3::ZERO);
        let energy = add_pairs(at.positions, (1.0, 1.0), 2, forces);
        Ok(Energetics::of(want, energy, DMat3::ZERO, 0.0))
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties::default()
    }
}

impl Backend for BetweenDumbbells {}

#[test]
fn a_bond_that_turns_too_far_stops_the_step() {
    for bonds in [direct(1e-14), shake(1e-12)] {
        let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
        let turning =
            at(&molecules, vec![DVec3::ZERO, DVec3::X], vec![-10.5 * DVec3::Y, 10.5 * DVec3::Y]);
        let mut rig = Rig::held(&bonds, turning, ForceSum::new(NoForces), 0.05);
        let failed = (0..50).find_map(|_| rig.tried().err());
        let text = failed.expect("a bond turned too far").to_string();
        assert!(text.contains("molecule 1"), "{text}");
    }
}

/// Two dumbbells that meet.
fn two_dumbbells(bonds: &BondOptions, kind: Bonds, push: DVec3, dt: f64) -> Rig<BetweenDumbbells> {
    let half = 0.335;
    let x =
        [[-1.5, 0.1, -half], [-1.5, 0.1, half], [1.5, -0.1 - half, 0.0], [1.5, -0.1 + half, 0.0]];
    let mut v = [1.0, 1.0, -1.0, -1.0].map(|v| v * DVec3::X);
    v[0] += push;
    let start =
        at(&Molecules::chains(2, 0.67, kind), x.map(DVec3::from_array).to_vec(), v.to_vec());
    Rig::held(bonds, start, ForceSum::new(BetweenDumbbells), dt)
}

/// The error of a method of order two falls by four with half the step.
#[test]
fn velocities_and_the_energy_of_two_dumbbells_are_of_order_two() {
    let after = |steps: u32| {
        let dt = 2.5 / f64::from(steps);
        let rig = two_dumbbells(&direct(1e-14), Bonds::Rigid, DVec3::ZERO, dt).steps(steps);
        (rig.conserved(), rig.state.velocities)
    };
    let [a, b, c] = [2000, 4000, 8000].map(after);
    let of_velocities = (farthest(&a.1, &b.1) / farthest(&b.1, &c.1)).log2();
    assert!((of_velocities - 2.0).abs() < 0.05, "{of_velocities}");
    let of_energy = ((a.0 - b.0) / (b.0 - c.0)).abs().log2();
    assert!((of_energy - 2.0).abs() < 0.05, "{of_energy}");
    // The parts of the kinetic energy belong to a high-precision solution: a Runge–Kutta method of order 8.
    let (energy, v) = c;
    let centers: f64 = v.chunks(2).map(|v| (0.5 * (v[0] + v[1])).length_squared()).sum();
    let inside: f64 = v.chunks(2).map(|v| (0.5 * (v[1] - v[0])).length_squared()).sum();
    assert!((centers - 0.760835326120).abs() < 1e-5, "{centers}");
    assert!((inside - 1.233605923153).abs() < 1e-5, "{inside}");
    assert!((energy - 1.979878613169).abs() < 1e-5, "{energy}");
}

#[test]
fn every_way_but_the_projection_keeps_both_momenta() {
    let spring = |scheme, damping| {
        BondOptions::Spring(spring::Options { stiffness: 4000.0, damping, scheme })
    };
    let ways = [
        (direct(1e-14), Bonds::Rigid),
        (shake(1e-12), Bonds::Rigid),
        (BondOptions::Spook(Default::default()), Bonds::Rigid),
        (spring(spring::Scheme::Explicit, 0.0), Bonds::Springs),
        (spring(spring::Scheme::Explicit, 9.0), Bonds::Impulses),
        (spring(spring::Scheme::Midpoint, 0.0), Bonds::Impulses),
        (spring(spring::Scheme::Midpoint, 9.0), Bonds::Impulses),
        (spring(spring::Scheme::LinearlyImplicit, 0.0), Bonds::Impulses),
        (spring(spring::Scheme::LinearlyImplicit, 9.0), Bonds::Impulses),
        (projection(), Bonds::Rigid),
    ];
    for (bonds, kind) in ways {
        // Velocities of SPOOK stand half a step behind the positions: positions are taken back by half a step.
        let dt = 2.5 / 4000.0;
        let lag = if matches!(bonds, BondOptions::Spook(_)) { dt } else { 0.0 };
        let rig = two_dumbbells(&bonds, kind, DVec3::new(0.1, 0.4, -0.2), dt);
        let (momentum, before) = (rig.momentum(), rig.angular_momentum(lag));
        let rig = rig.steps(4000);
        let lost = (rig.momentum() - momentum).length();
        assert!(lost < 4e-13, "{bonds:?}: {lost:e}");
        let turned = (rig.angular_momentum(lag) - before).length() / before.length();
        match bonds == projection() {
            true => assert!(turned > 1e-4, "{turned:e}"),
            false => assert!(turned < 1e-12, "{bonds:?}: {turned:e}"),
        }
    }
}

#[test]
fn closed_form_bonds_keep_their_length_at_any_of_a_million_steps() {
    // Five dumbbells under forces of pairs fill a register, and leave one over.
    let molecules = Molecules::chains(2, 0.67, Bonds::Rigid);
    let x = (0..10).map(|i| DVec3::new(3.0 * f64::from(i / 2), 0.67 * f64::from(i % 2), 0.0));
    let v = (0..10).map(|i| {
        let k = f64::from(i);
        DVec3::new((1.7 * k).sin(), (0.9 * k).cos(), (2.3 * k).sin())
    });
    let start = at(&molecules, x.collect(), v.collect());
    let mut rig = Rig::held(&direct(1e-14), start, ForceSum::new(NoForces), 0.01);
    let mut worst = 0.0_f64;
    for _ in 0..1_000_000 {
        rig.step();
        let d = rig.state.positions.chunks_exact(2).map(|x| (x[1] - x[0]).length());
        worst = d.map(|d| (d / 0.67 - 1.0).abs()).fold(worst, f64::max);
        // Free dumbbells would fly out of the range where positions have all their digits.
        if rig.state.step.is_multiple_of(1000) {
            for x in rig.state.positions.chunks_mut(2) {
                let center = 0.5 * (x[0] + x[1]);
                x.iter_mut().for_each(|x| *x -= center);
            }
        }
    }
    assert!(worst < 1e-14 && rig.worst.residual < 1e-14, "{worst:e} {:e}", rig.worst.residual);
}

#[test]
fn a_hanging_chain_at_rest_has_the_weight_below_as_its_tensions() {
    for n in [2_usize, 5, 12] {
        let molecules = Molecules::chains(n + 1, 0.2, Bonds::Rigid);
        let x = (0..=n).map(|k| DVec3::new(0.0, 0.0, -0.2 * k as f64)).collect();
        let rig = hanging(&molecules, x, vec![DVec3::ZERO; n + 1], 1e-3).steps(100);
        // T_j = (n − j + 1)·m·g, so that Σ λ·|d|² is −Σ T_j·r.
        let sums = rigid::constraint_sums(&rig.system, &rig.state);
        let wanted = -G * 0.2 * (n * (n + 1)) as f64 / 2.0;
        assert!((sums.virial.z_axis.z / wanted - 1.0).abs() < 1e-12, "{sums:?}");
        let moved = (rig.state.positions[n].z + 0.2 * n as f64).abs();
        assert!(moved < 1e-13, "{moved:e}");
    }
}

/// Small swings of n beads on a string have ω²·l/g at the zeros of the Laguerre polynomial L_n.
#[test]
fn small_swings_of_a_chain_have_the_frequencies_of_laguerre() {
    let (g, l) = (G, 0.2);
    for zeros in [&[0.585786_f64, 3.414214][..], &[0.415775, 2.294280, 6.289945]] {
        let n = zeros.len();
        for zero in zeros {
            let omega = (zero * g / l).sqrt();
            // The angle of each string in this mode, from the outermost bead inwards: the k-th from below carries k beads.
            // x_k − x_{k−1} follows from the equation of bead k.
            let mut shape = vec![1.0_f64];
            let mut next = shape[0] - zero;
            for carried in 2..=n {
                let last = shape.last().copied().unwrap_or_default();
                shape.push(next);
                let tension = carried as f64;
                next += ((tension - 1.0) * (next - last) - zero * next) / tension;
            }
            assert!(next.abs() < 1e-4, "the pivot stays: {next}");
            let amplitude = 2e-5;
            shape.reverse();
            let bead = |k: usize| {
                if k == 0 { 0.0 } else { amplitude * shape[k - 1] }
            };
            let mut x = vec![DVec3::ZERO];
            for k in 1..=n {
                let dx = bead(k) - bead(k - 1);
                let last = x[k - 1];
                x.push(last + DVec3::new(dx, 0.0, -(l * l - dx * dx).sqrt()));
            }
            let molecules = Molecules::chains(n + 1, l, Bonds::Rigid);
            let first: Vec<f64> = x.iter().map(|x| x.x).collect();
            let dt = std::f64::consts::TAU / omega / 4000.0;
            let rig = hanging(&molecules, x, vec![DVec3::ZERO; n + 1], dt).steps(1000);
            // After a quarter of the period all beads pass through the middle.
            let largest = first.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (k, x) in rig.state.positions.iter().enumerate() {
                assert!(x.x.abs() < 1e-4 * largest, "{n}, {zero}, {k}: {x}");
            }
            let rig = rig.steps(3000);
            for (x, first) in rig.state.positions.iter().zip(&first) {
                assert!((x.x - first).abs() < 1e-4 * largest, "{n}, {zero}: {x} {first}");
            }
        }
    }
}

#[test]
fn a_conical_pendulum_turns_at_its_speed_and_has_its_tension() {
    let (omega, tension) = (3.365651836049, 11.327612281500);
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    let x = vec![DVec3::ZERO, DVec3::new(sin, 0.0, -cos)];
    let v = vec![DVec3::ZERO, DVec3::new(0.0, omega * sin, 0.0)];
    let turn = |steps: u32| {
        let dt = std::f64::consts::TAU / omega / f64::from(steps);
        let rig = hanging(&molecules, x.clone(), v.clone(), dt).steps(steps);
        farthest(&rig.state.positions, &x)
    };
    let (coarse, fine) = (turn(1000), turn(2000));
    assert!(fine < 1e-5 && (coarse / fine / 4.0 - 1.0).abs() < 0.05, "{coarse} {fine}");
    let rig = hanging(&molecules, x.clone(), v.clone(), 1e-3);
    let sums = rigid::constraint_sums(&rig.system, &rig.state);
    let virial = sums.virial.x_axis.x + sums.virial.y_axis.y + sums.virial.z_axis.z;
    assert!((-virial / tension - 1.0).abs() < 1e-12, "{virial}");
}

#[test]
fn multipliers_are_the_tension_of_a_turning_chain() {
    // A straight chain turning at Ω about its middle: T_j = Ω²·Σ radii of the outer beads.
    let omega = 1.7;
    let molecules = Molecules::chains(4, 1.0, Bonds::Rigid);
    let x: Vec<DVec3> = [-1.5, -0.5, 0.5, 1.5].map(|x| DVec3::new(x, 0.0, 0.0)).to_vec();
    let v = x.iter().map(|x| DVec3::new(0.0, omega * x.x, 0.0)).collect();
    let (system, state) = at(&molecules, x, v);
    let sums = rigid::constraint_sums(&system, &state);
    let tensions = [1.5, 2.0, 1.5].map(|radii| omega * omega * radii);
    // The force on the site at the end of d is λ·d, and the tension −λ|d|.
    let wanted = -tensions.iter().sum::<f64>();
    assert!((sums.virial.x_axis.x - wanted).abs() < 1e-12, "{sums:?}");
    assert!(sums.largest_residual < 1e-15);
    let squares: f64 = [1.5_f64, 0.5, 0.5, 1.5].map(|r| (omega * omega * r).powi(2)).iter().sum();
    assert!((sums.squared_forces - squares).abs() < 1e-12);
}

#[test]
fn a_stiff_spring_swings_at_its_frequency_and_its_virial_is_its_force() {
    let stiffness = 900.0;
    let options = BondOptions::Spring(spring::Options { stiffness, ..Default::default() });
    let omega = options.frequency();
    assert!((omega - (2.0 * stiffness).sqrt()).abs() < 1e-12);
    let x = vec![DVec3::new(-0.51, 0.0, 0.0), DVec3::new(0.51, 0.0, 0.0)];
    let start = at(&Molecules::chains(2, 1.0, Bonds::Springs), x.clone(), vec![DVec3::ZERO; 2]);
    let dt = std::f64::consts::TAU / omega / 1000.0;
    let rig = Rig::held(&options, start, ForceSum::new(NoForces), dt);
    let virial = rig.state.energetics.scalar_virial().unwrap();
    let wanted: f64 = x.iter().zip(&rig.state.forces).map(|(x, f)| x.dot(*f)).sum();
    assert!((virial - wanted).abs() < 1e-12, "{virial} {wanted}");
    assert!((rig.conserved() - 0.5 * stiffness * 0.02_f64.powi(2)).abs() < 1e-12);
    assert!(farthest(&rig.steps(1000).state.positions, &x) < 1e-6);
}

/// The Laplacian of springs is the divergence of their forces.
#[test]
fn the_laplacian_of_springs_is_the_divergence_of_their_forces() {
    let molecules = Molecules::chains(3, 1.0, Bonds::Springs);
    let options = BondOptions::Spring(spring::Options { stiffness: 50.0, ..Default::default() });
    let BondHolder::Spring(mut term) = options.build(&molecules) else {
        panic!("springs are forces")
    };
    let x = vec![DVec3::new(0.0, 0.1, 0.2), DVec3::new(0.9, 0.3, -0.1), DVec3::new(1.2, 1.3, 0.4)];
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let mut at = |x: &[DVec3]| {
        let mut forces = vec![DVec3::ZERO; 3];
        let found = term
            .evaluate(Configuration::at_rest(&cell, x), Part::All, Want::TOTALS, &mut forces)
            .unwrap();
        (forces, found.laplacian.unwrap())
    };
    let (_, laplacian) = at(&x);
    let mut divergence = 0.0;
    for site in 0..3 {
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[site][axis] += by;
                x
            };
            let eta = 1e-5;
            divergence +=
                (at(&moved(eta)).0[site][axis] - at(&moved(-eta)).0[site][axis]) / (2.0 * eta);
        }
    }
    assert!((laplacian + divergence).abs() < 1e-6 * laplacian, "{laplacian} {divergence}");
}

#[test]
fn leapfrog_and_positions_alone_hold_bonds_as_velocity_verlet_does() {
    let molecules = Molecules::chains(6, 0.2, Bonds::Rigid);
    for bonds in [direct(1e-14), shake(1e-14)] {
        let moved = |options: &IntegratorOptions| {
            let x = (0..6).map(|k| DVec3::new(0.2 * f64::from(k), 0.0, 0.0)).collect();
            let (system, state) = at(&molecules, x, vec![DVec3::ZERO; 6]);
            let BondHolder::Drift(solver) = bonds.build(&molecules) else {
                panic!("rigid bonds are held in drifts");
            };
            let method = build(options).with_bonds(solver);
            let rig = Rig::new(method, system, state, falling(), 0.002).steps(500);
            assert!(rig.worst.residual < 1e-13);
            rig.state
        };
        let wanted = moved(&IntegratorOptions::default());
        for method in [
            IntegratorOptions::Leapfrog(Default::default()),
            IntegratorOptions::StormerVerlet(Default::default()),
        ] {
            let found = moved(&method);
            assert!(farthest(&found.positions, &wanted.positions) < 1e-9, "{method:?}");
            assert!(farthest(&found.velocities, &wanted.velocities) < 1e-7, "{method:?}");
        }
    }
}

#[test]
fn methods_without_a_form_for_the_bonds_of_a_system_say_so() {
    for (method, bonds, words) in [
        (
            IntegratorOptions::StormerVerletTimeCorrected(Default::default()),
            Bonds::Rigid,
            "it has rigid bonds, and the method has no form that holds them",
        ),
        (
            IntegratorOptions::Spook(Default::default()),
            Bonds::Rigid,
            "it has rigid bonds, and the method was told of none",
        ),
        (
            IntegratorOptions::StormerVerlet(Default::default()),
            Bonds::Impulses,
            "its springs leave velocities that positions do not tell",
        ),
    ] {
        let molecules = Molecules::chains(2, 1.0, bonds);
        let (system, mut state): (System, State) =
            at(&molecules, vec![DVec3::ZERO, DVec3::X], vec![DVec3::ZERO; 2]);
        let refused = build(&method).start(&system, &mut state, &mut NoForces, 0.01, Want::NOTHING);
        let text = refused.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}
