//! Unilateral contacts of SPOOK: impacts at any phase, stacks at rest, rows of balls.

use lennard_core::{Configuration, Part, StepError, Want};
use lennard_core::{
    DVec3, Exclusions, ForceError, ForceSum, ForceTerm, NoForces, PeriodicBox, System,
};
use lennard_forcefield::Walls;
use lennard_integrators::IntegratorOptions;
use lennard_integrators::spook::Damping;
use lennard_integrators::spook::Solver;
use lennard_integrators::{Bodies, Contacts, Obstacles, Response, UnilateralLaw};

use super::common::{Rig, alone, cube, lattice, of_kind, random_vectors, spheres, walls};

fn law(restitution: f64) -> UnilateralLaw {
    let (compliance, damping, solver) = (0.0, Damping::Steps(2.0), Solver::Exact);
    UnilateralLaw { restitution, compliance, damping, solver }
}

fn spook(restitution: f64) -> Response {
    Response::Unilateral(law(restitution))
}

/// Planes across z of a cube of side 20, at 1 and 19, that contacts solve for.
pub(crate) fn planes(restitution: f64) -> Walls {
    let text = format!("kind = \"hard\"\nresponse = \"contact\"\nrestitution = {restitution:?}");
    walls(&text, 20.0, &[2], 2.0)
}

fn on_planes(law: UnilateralLaw) -> Obstacles {
    let bodies = Bodies::alike(1.0, Exclusions::NONE);
    let contacts = Contacts::new(Response::Unilateral(law), bodies);
    Obstacles::new(planes(law.restitution), contacts)
}

fn rig(x: &[DVec3], v: &[DVec3], forces: ForceSum<NoForces>, dt: f64) -> Rig {
    by_spook((cube(20.0), x.to_vec(), v.to_vec()), forces, dt)
}

fn by_spook(
    start: (PeriodicBox, Vec<DVec3>, Vec<DVec3>),
    forces: ForceSum<NoForces>,
    dt: f64,
) -> Rig {
    let system = System::atoms(start.1.len());
    super::common::rig(&IntegratorOptions::Spook(Default::default()), system, start, forces, dt)
}

#[test]
fn an_impact_keeps_its_share_at_any_phase_of_the_step() {
    let h = 0.01;
    for e in [0.0, 0.02, 0.3, 0.9, 1.0] {
        for k in 1..=20 {
            let phase = f64::from(k) / 20.0;
            // One step before the impact: the depth after it is phase·v·h.
            let above = DVec3::new(5.0, 5.0, 1.0 + (1.0 - phase) * h);
            let ball = rig(&[above], &[DVec3::NEG_Z], alone(on_planes(law(e))), h).steps(30);
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
            let two = rig(&x, &v, alone(spheres(spook(e))), h).steps(30);
            let v = &two.state.velocities;
            assert!((v[1].x - v[0].x - e).abs() < 1e-13, "{e} at {phase}");
            assert!((v[1].x + v[0].x - 0.5).abs() < 1e-13);
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
        let row = rig(&x, &v, alone(contacts), 0.01).steps(20);
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
        let start = (cube(side), x.clone(), v.clone());
        let gas = by_spook(start, alone(spheres(spook(e))), 0.01);
        let before = gas.kinetic_energy();
        let gas = gas.steps(500);
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
