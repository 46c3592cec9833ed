//! Molecules whose bonds are held in drifts, between walls that are hit.

use lennard_core::{
    BondSolver, Bonds, DVec3, ForceSum, ForceTerm, Molecules, NoForces, State, StepError, System,
    rigid,
};
use lennard_forcefield::{ConstantField, ContactLaw, SpringLaw};
use lennard_integrators::{
    Bodies, BondHolder, BondOptions, Contacts, IntegratorOptions, Obstacles, Response, build,
};

use super::common::{Rig, cube, random_vectors, walls};

const SIDE: f64 = 12.0;

fn solver(molecules: &Molecules) -> Box<dyn BondSolver> {
    match BondOptions::default().build(molecules) {
        BondHolder::Drift(solver) => solver,
        _ => panic!("the direct solution acts in drifts"),
    }
}

fn hard(restitution: f64) -> String {
    format!("kind = \"hard\"\nrestitution = {restitution:?}")
}

/// Chains with rigid bonds and contacts in a closed box, in gravity g.
fn boxed(
    options: &str,
    molecules: &Molecules,
    (x, v): (Vec<DVec3>, Vec<DVec3>),
    (contacts, g): (Option<Contacts>, f64),
    h: f64,
) -> Rig {
    let system = System::of_molecules(x.len(), molecules.clone());
    let walls = Obstacles::new(walls(options, SIDE, &[0, 1, 2], 2.0), contacts)
        .holding(&system, solver(molecules));
    let field = ConstantField::new(-g * DVec3::Z, system.masses.clone());
    let forces = ForceSum::new(NoForces).with(walls).with(field);
    let method = build(&IntegratorOptions::default()).with_bonds(solver(molecules));
    let system = system.pushed_along([true; 3]);
    Rig::new(method, system, State::new(cube(SIDE), x, v), forces, h)
}

/// Chains that do not see each other, in a closed box.
fn gas(options: &str, n: usize, sites: usize, h: f64) -> Rig {
    touching(options, (n, sites), h, |_| None)
}

/// Chains whose sites are bodies with contacts.
fn touching(
    options: &str,
    (n, sites): (usize, usize),
    h: f64,
    contacts: impl Fn(&Molecules) -> Option<Contacts>,
) -> Rig {
    let molecules = Molecules::chains(sites, 0.8, Bonds::Rigid);
    let centers = random_vectors(n, "centers");
    let site = |i: usize| {
        let along = (i % sites) as f64 - 0.5 * (sites - 1) as f64;
        let turned = 0.8 * [DVec3::X, DVec3::Y, DVec3::Z][i / sites % 3];
        DVec3::splat(0.5 * SIDE) + 2.5 * centers[i / sites] + along * turned
    };
    let x: Vec<DVec3> = (0..n * sites).map(site).collect();
    let mut v = random_vectors(n * sites, "velocities");
    v.iter_mut().for_each(|v| *v *= 2.0);
    rigid::project_velocities(&System::of_molecules(x.len(), molecules.clone()), &x, &mut v);
    boxed(options, &molecules, (x, v), (contacts(&molecules), 0.0), h)
}

fn residual(rig: &Rig) -> f64 {
    rigid::constraint_sums(&rig.system, &rig.state).largest_residual
}

fn outside(rig: &Rig) -> f64 {
    let beyond = |x: f64| (1.0 - x).max(x - (SIDE - 1.0));
    let all = rig.state.positions.iter();
    all.map(|x| beyond(x.x).max(beyond(x.y)).max(beyond(x.z))).fold(f64::NEG_INFINITY, f64::max)
}

fn impulse(rig: &Rig) -> f64 {
    rig.forces.walls().iter().map(|wall| wall.impulse).sum()
}

#[test]
fn rigid_dumbbells_keep_energy_and_bonds_over_300_hits() {
    let mut gas = gas(&hard(1.0), 60, 2, 0.005);
    let before = gas.kinetic_energy();
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        gas.step();
        worst = worst.max((gas.kinetic_energy() / before - 1.0).abs());
        assert!(outside(&gas) < 1e-12, "{}", outside(&gas));
    }
    assert!(worst < 1e-12, "{worst:e}");
    assert!(residual(&gas) < 1e-13, "{}", residual(&gas));
    assert!(gas.heat.abs() < 1e-11, "{}", gas.heat);
    assert!(gas.worst.iterations > 0 && gas.worst.residual < 1e-13);
    let hits: u64 = gas.forces.walls().iter().map(|wall| wall.hits).sum();
    assert!(hits > 300, "{hits}");
    // 20 τ at a speed of about 1.2: each centre hits a wall more than twice.
    assert!(impulse(&gas) > 60.0 * 2.0, "{}", impulse(&gas));
}

/// Contacts of soft bodies, held bonds and hits at planes in one flight: the energy of each step is off by h².
#[test]
fn soft_bodies_on_held_bonds_keep_their_energy_between_hard_walls() {
    let worst = |h: f64| {
        let mut gas = touching(&hard(1.0), (16, 2), h, |molecules| {
            let law = ContactLaw::new(SpringLaw::Linear, 2000.0, 1.0);
            let bodies = Bodies::alike(0.5, molecules.exclusions());
            Some(Contacts::new(Response::Spring(law), bodies))
        });
        let (before, mut worst, mut touched) = (gas.conserved(), 0.0_f64, 0);
        for _ in 0..(8.0 / h) as u32 {
            gas.step();
            worst = worst.max((gas.conserved() / before - 1.0).abs());
            touched += u32::from(gas.state.energetics.potential_energy.unwrap() > 1e-3);
        }
        let hits: u64 = gas.forces.walls().iter().map(|wall| wall.hits).sum();
        assert!(hits > 20 && touched > 100, "{hits} {touched}");
        assert!(residual(&gas) < 1e-13 && outside(&gas) < 1e-12);
        worst
    };
    let (coarse, fine) = (worst(0.002), worst(0.0005));
    assert!(coarse < 2e-2 && fine < coarse / 4.0, "{coarse:e} {fine:e}");
}

#[test]
fn a_bond_that_turns_too_far_between_walls_is_named_with_its_molecule() {
    let mut gas = gas(&hard(1.0), 3, 2, 0.005);
    let turn = DVec3::new(0.0, 0.0, 400.0);
    gas.state.velocities[2] += turn;
    gas.state.velocities[3] -= turn;
    let error = gas.tried().unwrap_err();
    let StepError::BondTurned { molecule, bond, .. } = error else {
        panic!("{error}");
    };
    assert_eq!((molecule, bond), (2, 1));
}

#[test]
fn forth_and_back_molecules_come_home_through_their_hits() {
    for sites in [2, 5] {
        let mut gas = gas(&hard(1.0), 6, sites, 0.005);
        let start = gas.state.positions.clone();
        for _ in 0..2 {
            (0..2000).for_each(|_| drop(gas.step()));
            gas.state.velocities.iter_mut().for_each(|v| *v = -*v);
        }
        let off = |(a, b): (&DVec3, &DVec3)| (*a - *b).length();
        let farthest = gas.state.positions.iter().zip(&start).map(off);
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest < 1e-7, "{sites}: {farthest:e}");
        assert!(impulse(&gas) > 5.0, "{}", impulse(&gas));
    }
}

#[test]
fn momentum_goes_to_the_walls_and_hits_that_take_energy_count_it_as_heat() {
    let mut gas = gas(&hard(0.7), 40, 3, 0.005);
    let (before, start) = (gas.kinetic_energy(), gas.system.momentum(&gas.state.velocities));
    (0..4000).for_each(|_| drop(gas.step()));
    let lost = gas.kinetic_energy() - before;
    // A free chain keeps its energy to the cube of the step.
    assert!((lost - gas.heat).abs() < 1e-4 * before, "{lost} {}", gas.heat);
    assert!(lost < -0.2 * before);
    let gained = gas.system.momentum(&gas.state.velocities) - start;
    for axis in 0..3 {
        let of = |wall: &lennard_core::WallReading| wall.outward() * wall.impulse;
        let walls = gas.forces.walls().iter().filter(|w| w.axis == axis);
        let taken: f64 = walls.map(of).sum();
        assert!((taken + gained[axis]).abs() < 1e-10, "{taken} {gained}");
    }
}

#[test]
fn thermal_walls_bring_molecules_to_their_temperature_in_every_degree_of_freedom() {
    let mut gas = gas("kind = \"thermal\"", 400, 2, 0.02);
    (0..3000).for_each(|_| drop(gas.step()));
    let (mut centers, mut inside, mut samples) = (0.0, 0.0, 0.0);
    for _ in 0..150 {
        (0..40).for_each(|_| drop(gas.step()));
        for v in gas.state.velocities.chunks(2) {
            centers += 0.25 * (v[0] + v[1]).length_squared();
            inside += 0.25 * (v[1] - v[0]).length_squared();
            samples += 1.0;
        }
    }
    // K = M·V²/2 has three degrees of freedom for the centre, and two for the rotation.
    let (centers, inside) = (2.0 * centers / samples / 3.0, 2.0 * inside / samples / 2.0);
    // Some 400·60 independent velocities: an error of about 1 %.
    assert!((centers / 1.3 - 1.0).abs() < 0.03, "{centers}");
    assert!((inside / 1.3 - 1.0).abs() < 0.03, "{inside}");
}

#[test]
fn a_dumbbell_that_falls_flat_on_a_floor_bounces_and_rests_with_both_sites() {
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    for e in [1.0, 0.5] {
        let start =
            (vec![DVec3::new(5.0, 6.0, 2.0), DVec3::new(6.0, 6.0, 2.0)], vec![DVec3::ZERO; 2]);
        let h = 0.01;
        let fall = boxed(&hard(e), &molecules, start, (None, 1.0), h).steps(2000);
        let (heat, before) = (fall.heat, impulse(&fall));
        let fall = fall.steps(1000);
        let heights: f64 = fall.state.positions.iter().map(|x| x.z - 1.0).sum();
        let energy = fall.kinetic_energy() + heights;
        if e == 1.0 {
            assert!((energy - 2.0).abs() < 2.0 * 2.0_f64.sqrt() * h, "{energy}");
            continue;
        }
        assert!(energy.abs() < 1e-3, "{energy}");
        assert_eq!(fall.heat, heat);
        let weight = impulse(&fall) - before;
        assert!((weight / (10.0 * 2.0) - 1.0).abs() < 1e-9, "{weight}");
    }
}

/// Mean over phases of the step of −v_out/v_in of a dumbbell that flies at a soft wall, at an angle to its plane.
fn rebound(law: SpringLaw, e: f64, along: DVec3) -> f64 {
    let (h, phases) = (0.005, 40);
    let law = law.name();
    let options =
        format!("kind = \"soft\"\nlaw = \"{law}\"\nstiffness = 400.0\nrestitution = {e:?}");
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    let mut sum = 0.0;
    for k in 0..phases {
        let phase = (f64::from(k) + 0.5) / f64::from(phases);
        let lower = DVec3::new(5.0, 6.0, 1.0 + (2.0 + phase) * h);
        let start = (vec![lower, lower + along], vec![DVec3::NEG_Z; 2]);
        let mut rig = boxed(&options, &molecules, start, (None, 0.0), h);
        let before = rig.kinetic_energy();
        while rig.state.positions[0].z <= 1.0 || rig.state.velocities[0].z <= 0.0 {
            rig.step();
            assert!(rig.state.step < 10_000);
        }
        let lost = rig.kinetic_energy() - before;
        // The spring alone keeps its energy to the square of the step.
        assert!((lost - rig.heat).abs() < 0.02, "{lost} {}", rig.heat);
        sum += 0.5 * (rig.state.velocities[0] + rig.state.velocities[1]).z;
    }
    sum / f64::from(phases)
}

#[test]
fn dashpots_of_soft_walls_keep_the_restitution_of_molecules_on_their_end_and_flat() {
    for law in [SpringLaw::Linear, SpringLaw::Hertz] {
        for e in [0.3, 0.5, 0.9] {
            for along in [DVec3::Z, DVec3::X] {
                let mean = rebound(law, e, along);
                assert!((mean - e).abs() < 0.005, "{law:?} {e} {along}: {mean}");
            }
        }
    }
}

#[test]
fn dashpots_take_what_they_count_from_a_gas_of_molecules() {
    let soft = "kind = \"soft\"\nrestitution = 0.5";
    for sites in [2, 3] {
        let mut gas = gas(soft, 30, sites, 0.002);
        let before = gas.kinetic_energy();
        (0..4000).for_each(|_| drop(gas.step()));
        assert!(gas.heat < -0.3 * before, "{} of {before}", gas.heat);
        let left = gas.conserved();
        assert!((left / before - 1.0).abs() < 2e-3, "{sites}: {left} {before}");
        assert!(residual(&gas) < 1e-9, "{}", residual(&gas));
    }
}
