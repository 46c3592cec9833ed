//! Unilateral contacts of SPOOK: impacts at any phase, stacks at rest, rows of balls.

use lennard_core::random::Streams;
use lennard_core::{Configuration, Part, StepError, Want};
use lennard_core::{DVec3, Exclusions, ForceError, ForceSum, ForceTerm, Masses, NoForces, System};
use lennard_forcefield::{
    ConstantField, Hard, SlitPlanes, WallContext, WallOptions, WallPair, Walls,
};
use lennard_integrators::IntegratorOptions;
use lennard_integrators::spook::Damping;
use lennard_integrators::spook::Solver;
use lennard_integrators::{Bodies, Contacts, Obstacles, Response, UnilateralLaw};

use super::common::{Rig, alone, cube, lattice, of_kind, random_vectors, spheres};

fn law(restitution: f64, compliance: f64) -> UnilateralLaw {
    UnilateralLaw { restitution, compliance, damping: Damping::Steps(2.0), solver: Solver::Exact }
}

fn spook(restitution: f64) -> Response {
    Response::Unilateral(law(restitution, 0.0))
}

/// Planes across z of a cube of side 20, at 1 and 19, that contacts solve for.
pub(crate) fn planes(restitution: f64) -> Walls {
    let planes = SlitPlanes::new(&cube(20.0), 2, 2.0, 0.0);
    let options = WallOptions::Hard(Hard {
        response: lennard_forcefield::Response::Contact,
        restitution: Some(restitution),
    });
    let pair = WallPair::new(&options, planes, &WallContext { temperature: 1.0 });
    Walls::new(vec![pair], Streams::new(1).noise("walls"))
}

fn on_planes(law: UnilateralLaw) -> Obstacles {
    let bodies = Bodies::alike(1.0, Exclusions::NONE);
    let contacts = Contacts::new(Response::Unilateral(law), bodies);
    Obstacles::new(planes(law.restitution), contacts)
}

fn rig(x: &[DVec3], v: &[DVec3], forces: ForceSum<NoForces>, dt: f64) -> Rig {
    let system = System::atoms(x.len());
    let start = (cube(20.0), x.to_vec(), v.to_vec());
    Rig::by(&IntegratorOptions::Spook(Default::default()), system, start, forces, dt)
}

#[test]
fn an_impact_keeps_its_share_at_any_phase_of_the_step() {
    let h = 0.01;
    for e in [0.0, 0.02, 0.3, 0.9, 1.0] {
        for k in 1..=20 {
            let phase = f64::from(k) / 20.0;
            // One step before the impact: the depth after it is phase·v·h.
            let above = DVec3::new(5.0, 5.0, 1.0 + (1.0 - phase) * h);
            let mut ball = rig(&[above], &[DVec3::NEG_Z], alone(on_planes(law(e, 0.0))), h);
            (0..30).for_each(|_| ball.step());
            let v = ball.state.velocities[0].z;
            assert!((v - e).abs() < 1e-13, "{e} at {phase}: {v}");
            assert!((ball.heat + 0.5 * (1.0 - e * e)).abs() < 1e-13);
            let wall = ball.forces.walls()[0].impulse;
            assert!((wall - 1.0 - e).abs() < 1e-13, "{wall}");
            if e == 0.0 {
                assert!((ball.state.positions[0].z - 1.0).abs() < 1e-13);
            }
            // Two balls: the relative speed keeps the same share, and the momentum is kept.
            let x = [DVec3::splat(5.0), DVec3::new(6.0 + (1.0 - phase) * h, 5.0, 5.0)];
            let v = [0.75 * DVec3::X, -0.25 * DVec3::X];
            let mut two = rig(&x, &v, alone(spheres(spook(e))), h);
            (0..30).for_each(|_| two.step());
            let v = &two.state.velocities;
            assert!((v[1].x - v[0].x - e).abs() < 1e-13, "{e} at {phase}");
            assert!((v[1].x + v[0].x - 0.5).abs() < 1e-13);
        }
    }
}

fn gravity() -> ConstantField {
    ConstantField::new(DVec3::new(0.0, 0.0, -1.0), Masses::Uniform(1.0))
}

#[test]
fn a_ball_in_gravity_bounces_400_times_without_loss_and_to_the_squares_of_its_share() {
    for (e, bounces) in [(1.0_f64, 400_u64), (0.7, 6)] {
        let h = 0.01;
        let forces = alone(on_planes(law(e, 0.0))).with(gravity());
        let mut ball = rig(&[DVec3::new(5.0, 5.0, 2.0)], &[DVec3::ZERO], forces, h);
        // The velocity of the method stands half a step behind; this energy is exact on a parabola.
        let energy = |ball: &Rig| {
            let v = ball.state.velocities[0].z - 0.5 * h;
            0.5 * v * v + ball.state.positions[0].z - 1.0
        };
        let start = energy(&ball);
        let (mut hits, mut impulse, mut wanted) = (0, 0.0, start);
        while hits < bounces {
            let depth = (1.0 - ball.state.positions[0].z).max(0.0);
            ball.step();
            let now = ball.forces.walls()[0].impulse;
            if now > impulse {
                (hits, impulse) = (hits + 1, now);
                // Half the square of the speed at the depth of the hit keeps e².
                wanted = e * e * (wanted + depth) - depth;
            }
            assert!((energy(&ball) - wanted).abs() < 1e-11, "{e} after {hits}");
        }
        let left = start * e.powi(2 * bounces as i32);
        assert!((energy(&ball) - left).abs() < 0.03, "{e}");
    }
}

#[test]
fn a_stack_that_fell_carries_its_weight_and_sinks_by_compliance_times_force() {
    for (n, compliance, solver) in
        [(5, 1e-3, Solver::Exact), (3, 1e-5, Solver::Exact), (5, 1e-3, Solver::Sweeps(400))]
    {
        let h = 0.005;
        let law = UnilateralLaw { solver, ..law(0.2, compliance) };
        let forces = alone(on_planes(law)).with(gravity());
        let x: Vec<DVec3> = (0..n).map(|i| DVec3::new(5.0, 5.0, 1.1 + 1.1 * i as f64)).collect();
        let mut stack = rig(&x, &vec![DVec3::ZERO; n], forces, h);
        let mut impulses = [0.0; 2];
        for impulse in &mut impulses {
            (0..8000).for_each(|_| stack.step());
            *impulse = stack.forces.walls()[0].impulse;
        }
        let weight = (impulses[1] - impulses[0]) / (8000.0 * h);
        assert!((weight / n as f64 - 1.0).abs() < 1e-9, "{n}: {weight}");
        for i in 0..n {
            let x = &stack.state.positions;
            let gap = match i {
                0 => x[0].z - 1.0,
                _ => x[i].z - x[i - 1].z - 1.0,
            };
            let wanted = -compliance * (n - i) as f64;
            assert!((gap / wanted - 1.0).abs() < 1e-8, "{n}, {i}: {gap} {wanted}");
            assert!(stack.state.velocities[i].length() < 1e-10);
        }
    }
}

#[test]
fn a_row_that_is_hit_follows_newtons_rule_for_all_contacts_at_once() {
    for n in [2_usize, 3, 5, 40] {
        let mut x: Vec<DVec3> =
            (0..n).map(|i| DVec3::new(2.0 + 0.25 * i as f64, 5.0, 5.0)).collect();
        x[0].x -= 0.1;
        let mut v = vec![DVec3::ZERO; n];
        v[0] = DVec3::X;
        let bodies = Bodies::alike(0.25, Exclusions::NONE);
        let contacts = Obstacles::new(None, Contacts::new(spook(1.0), bodies));
        // All but the first touch to the bit.
        let mut row = rig(&x, &v, alone(contacts), 0.01);
        (0..20).for_each(|_| row.step());
        let share = 2.0 / n as f64;
        for (i, v) in row.state.velocities.iter().enumerate() {
            let wanted = if i == 0 { share - 1.0 } else { share };
            assert!((v.x - wanted).abs() < 1e-12, "{n}, {i}: {}", v.x);
        }
        assert!((row.kinetic_energy() - 0.5).abs() < 1e-12);
    }
}

#[test]
fn a_gas_of_bodies_keeps_momentum_and_for_full_restitution_energy() {
    let side = 7.0;
    let x = lattice(5, side / 5.0, 0.1);
    let mut v = random_vectors(125, "gas");
    let mean = v.iter().sum::<DVec3>() / 125.0;
    v.iter_mut().for_each(|v| *v -= mean);
    for e in [1.0, 0.5] {
        let system = System::atoms(125);
        let start = (cube(side), x.clone(), v.clone());
        let spook = IntegratorOptions::Spook(Default::default());
        let mut gas = Rig::by(&spook, system, start, alone(spheres(self::spook(e))), 0.01);
        let before = gas.kinetic_energy();
        (0..500).for_each(|_| gas.step());
        let momentum: DVec3 = gas.state.velocities.iter().sum();
        assert!(momentum.length() < 1e-12, "{momentum}");
        let left = gas.kinetic_energy() / before;
        match e == 1.0 {
            true => assert!((left - 1.0).abs() < 1e-12, "{left}"),
            false => assert!(left < 0.3, "{left}"),
        }
        // Bodies that an impact left at rest on each other, and in each other, are pushed apart slowly.
        let off = gas.conserved() / before - 1.0;
        assert!(gas.heat <= 1e-12 && off.abs() < 1e-3, "{off}");
    }
}

#[test]
fn bodies_that_overlap_by_half_end_the_run_with_who_and_where() {
    let mut contacts = spheres(of_kind("spook"));
    let x = [DVec3::splat(3.0), DVec3::new(3.4, 3.0, 3.0)];
    let cell = cube(8.0);
    let at = Configuration::at_rest(&cell, &x);
    let error = contacts.evaluate(at, Part::All, Want::NOTHING, &mut [DVec3::ZERO; 2]).unwrap_err();
    let words = StepError::from(error.clone()).to_string();
    assert!(matches!(error, ForceError::ContactTooDeep { first: 0, second: 1, .. }));
    assert!(words.contains("overlap by 0.6"), "{words}");
}
