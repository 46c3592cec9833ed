//! Contacts of SPOOK beside the bonds of molecules, which they are solved for with.

use lennard_core::{Bonds, DVec3, ForceSum, ForceTerm, Molecules, NoForces, State, System};
use lennard_forcefield::ConstantField;
use lennard_integrators::bonds::spook;
use lennard_integrators::spook::Damping;
use lennard_integrators::spook::Solver;
use lennard_integrators::{Bodies, Contacts, Obstacles, Response, UnilateralLaw};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, SpookBonds};

use super::common::{Rig, cube, rig};
use super::unilateral::planes;
use crate::common::farthest;

fn bonds_of(molecules: &Molecules, compliance: f64) -> SpookBonds {
    let options = BondOptions::Spook(spook::Options { compliance, ..Default::default() });
    match options.build(molecules) {
        BondHolder::Spook(bonds, _) => bonds,
        _ => panic!("SPOOK solves for its bonds"),
    }
}

/// Chains with bonds of 1 σ between planes at z = 1 and 19, with bodies of a diameter and gravity g.
fn chains(
    (x, v): (Vec<DVec3>, Vec<DVec3>),
    sites: usize,
    (restitution, compliance, of_bonds): (f64, f64, f64),
    (diameter, solver): (f64, Solver),
    g: f64,
) -> Rig {
    let kind = match of_bonds > 0.0 {
        true => Bonds::Impulses,
        false => Bonds::Rigid,
    };
    let molecules = Molecules::chains(sites, 1.0, kind);
    let system = System::of_molecules(x.len(), molecules.clone()).pushed_along([true; 3]);
    let damping = Damping::Steps(2.0);
    let law = UnilateralLaw { restitution, compliance, damping, solver };
    let bodies = Bodies::alike(diameter, molecules.exclusions());
    let contacts = Contacts::new(Response::Unilateral(law), bodies)
        .with_bonds(bonds_of(&molecules, of_bonds), system.clone());
    let forces = ForceSum::new(NoForces)
        .with(Obstacles::new(planes(restitution), contacts))
        .with(ConstantField::new(-g * DVec3::Z, system.masses.clone()));
    let spook = IntegratorOptions::Spook(Default::default());
    rig(&spook, system, (cube(20.0), x, v), forces, 0.005)
}

fn impulse(rig: &Rig) -> f64 {
    rig.forces.walls()[0].impulse
}

#[test]
fn without_contacts_bonds_move_as_by_the_method_alone() {
    for compliance in [0.0, 1e-4] {
        // A bent chain that turns, far from the planes.
        let x: Vec<DVec3> = [[0.0, 0.0], [0.8, 0.6], [1.8, 0.6], [2.4, 1.4]]
            .map(|[x, z]| DVec3::new(6.0 + x, 5.0, 9.0 + z))
            .to_vec();
        let v: Vec<DVec3> =
            (0..4).map(|k| DVec3::new(0.0, f64::from(k).cos(), f64::from(k).sin())).collect();
        let all = (0.5, 0.0, compliance);
        let with = chains((x.clone(), v.clone()), 4, all, (0.1, Solver::Exact), 0.0);
        let (system, state) = (with.system.clone(), State::new(cube(20.0), x, v));
        let options = BondOptions::Spook(spook::Options { compliance, ..Default::default() });
        let alone = Rig::held(&options, (system, state), ForceSum::new(NoForces), 0.005);
        let [with, alone] = [with, alone].map(|rig| rig.steps(200).state.positions);
        assert!(farthest(&with, &alone) < 1e-12, "{compliance}");
    }
}

#[test]
fn a_chain_that_fell_on_its_end_stands_with_its_weight_in_floor_and_bonds() {
    for (of_contacts, of_bonds, solver) in [
        (1e-3, 1e-4, Solver::Exact),
        (1e-4, 1e-3, Solver::Exact),
        (1e-3, 1e-3, Solver::Sweeps(400)),
    ] {
        let n = 3;
        let at = |k: usize| DVec3::new(5.0, 5.0, 1.2 + k as f64);
        let start = ((0..n).map(at).collect(), vec![DVec3::ZERO; n]);
        let all = (0.2, of_contacts, of_bonds);
        let chain = chains(start, n, all, (0.5, solver), 1.0).steps(6000);
        let before = impulse(&chain);
        let chain = chain.steps(6000);
        let weight = (impulse(&chain) - before) / (6000.0 * chain.dt);
        assert!((weight / n as f64 - 1.0).abs() < 1e-9, "{weight}");
        let x = &chain.state.positions;
        let sunk = 1.0 - x[0].z;
        assert!((sunk / (of_contacts * n as f64) - 1.0).abs() < 1e-8, "{sunk}");
        for k in 1..n {
            // Bond k carries what stands on it.
            let shorter = 1.0 - (x[k].z - x[k - 1].z);
            let wanted = of_bonds * (n - k) as f64;
            assert!((shorter / wanted - 1.0).abs() < 1e-8, "{k}: {shorter}");
        }
    }
}

#[test]
fn an_impact_at_one_end_passes_through_the_bond() {
    // The lower site of a dumbbell at an angle θ to the floor hits: p = (1 + e)·v/κ with κ = 1 − sin²θ/2 for unit masses.
    for degrees in [90.0_f64, 60.0, 20.0] {
        for e in [1.0, 0.3] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let lower = DVec3::new(8.0, 8.0, 1.02);
            let x = vec![lower, lower + DVec3::new(cos, 0.0, sin)];
            let v = vec![DVec3::NEG_Z; 2];
            let mut fall = chains((x, v), 2, (e, 0.0, 0.0), (0.2, Solver::Exact), 0.0);
            while impulse(&fall) == 0.0 {
                fall.step();
            }
            let kappa = 1.0 - 0.5 * sin * sin;
            let wanted = (1.0 + e) / kappa;
            assert!((impulse(&fall) - wanted).abs() < 1e-12, "{degrees} {e}");
            let v = &fall.state.velocities;
            assert!((v[0].z - e).abs() < 0.02, "{degrees} {e}: {}", v[0].z);
            let momentum = v[0] + v[1];
            assert!((momentum - DVec3::new(0.0, 0.0, wanted - 2.0)).length() < 1e-12);
            let lost = 0.5 * (e * e - 1.0) / kappa;
            assert!((fall.heat - lost).abs() < 1e-12, "{degrees} {e}: {}", fall.heat);
        }
    }
}

#[test]
fn chains_that_meet_keep_their_momentum_and_their_bonds() {
    let x = [0.0, 1.0, 2.0].map(|k| DVec3::new(5.0 + k, 5.0, 5.0));
    let y = [0.0, 1.0, 2.0].map(|k| DVec3::new(6.3, 4.4 + k, 8.0));
    let v = [DVec3::Z, DVec3::Z, DVec3::Z, -DVec3::Z, -DVec3::Z, -DVec3::Z];
    let start = ([x, y].concat(), v.to_vec());
    let mut two = chains(start, 3, (1.0, 0.0, 0.0), (1.0, Solver::Exact), 0.0);
    let before = two.kinetic_energy();
    let mut strain = 0.0_f64;
    for _ in 0..800 {
        two.step();
        for x in two.state.positions.chunks(3) {
            let bonds = [x[1] - x[0], x[2] - x[1]];
            let off = bonds.map(|d| (d.length() - 1.0).abs());
            strain = strain.max(off[0]).max(off[1]);
        }
    }
    let momentum: DVec3 = two.state.velocities.iter().sum();
    assert!(momentum.length() < 1e-12, "{momentum}");
    assert!(two.state.velocities[0].z < 0.0 || two.state.velocities[2].z < 0.0);
    assert!(strain < 0.01, "{strain}");
    let after = two.kinetic_energy();
    assert!((after / before - 1.0).abs() < 0.1, "{before} {after}");
}
