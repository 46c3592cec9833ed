//! Springs with dashpots.

use lennard_core::{
    Configuration, DMat3, DVec3, Exclusions, ForceError, ForceTerm, Masses, Part, PeriodicBox,
    System, Want,
};
use lennard_forcefield::{ContactLaw, SpringLaw};
use lennard_integrators::{Bodies, Contacts, Obstacles, Response};

use super::common::{Rig, alone, cube, lattice, of_kind, random_vectors, spheres, verlet};

fn spring(law: SpringLaw, restitution: f64) -> Response {
    Response::Spring(ContactLaw::new(law, 400.0, restitution))
}

fn energy(contacts: &mut Obstacles, cell: &PeriodicBox, x: &[DVec3]) -> f64 {
    let mut forces = vec![DVec3::ZERO; x.len()];
    let at = Configuration::at_rest(cell, x);
    let found = contacts.evaluate(at, Part::All, Want::ENERGY, &mut forces);
    found.unwrap().potential_energy.unwrap()
}

#[test]
fn forces_virial_and_laplacian_are_derivatives_of_the_energy() {
    let cell = cube(6.0);
    let x = lattice(3, 0.9, 0.05);
    for law in [SpringLaw::Linear, SpringLaw::Hertz] {
        let mut contacts = spheres(spring(law, 1.0));
        let mut forces = vec![DVec3::ZERO; x.len()];
        let at = Configuration::at_rest(&cell, &x);
        let want = Want { per_particle: true, ..Want::TOTALS };
        let found = contacts.evaluate(at, Part::All, want, &mut forces).unwrap();
        assert!(found.potential_energy.unwrap() > 1.0);
        let h = 1e-5;
        let mut laplacian = 0.0;
        for i in 0..x.len() {
            for axis in 0..3 {
                let mut moved = x.clone();
                let mut at = |d: f64| {
                    moved[i][axis] = x[i][axis] + d;
                    energy(&mut contacts, &cell, &moved)
                };
                let (plus, here, minus) = (at(h), at(0.0), at(-h));
                let force = -(plus - minus) / (2.0 * h);
                assert!((forces[i][axis] - force).abs() < 1e-5, "{law:?} {i}");
                laplacian += (plus - 2.0 * here + minus) / (h * h);
            }
        }
        let found_laplacian = found.laplacian.unwrap();
        assert!(
            (found_laplacian / laplacian - 1.0).abs() < 1e-3,
            "{law:?}: {found_laplacian} {laplacian}"
        );
        // −dU/d ln s for positions and box times s is the virial.
        let mut scaled = |s: f64| {
            let x: Vec<DVec3> = x.iter().map(|x| s * *x).collect();
            energy(&mut contacts, &cell.scaled(DVec3::splat(s)).unwrap(), &x)
        };
        let slope = -(scaled(1.0 + h) - scaled(1.0 - h)) / (2.0 * h);
        let w = found.scalar_virial().unwrap();
        assert!((w / slope - 1.0).abs() < 1e-5, "{w} {slope}");
        let each = found.per_particle.unwrap();
        let sum: f64 = each.iter().map(|e| e.0).sum();
        assert!((sum / found.potential_energy.unwrap() - 1.0).abs() < 1e-12);
        let virial = each.iter().fold(DMat3::ZERO, |sum, e| sum + e.1);
        let trace = virial.x_axis.x + virial.y_axis.y + virial.z_axis.z;
        assert!((trace / w - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_list_finds_all_that_touch_whatever_the_motion() {
    // 216 bodies have a list; the force on each by a sum over all others has none.
    let (cell, n) = (cube(6.6), 6);
    let mut x = lattice(n, 1.1, 0.1);
    let v = random_vectors(x.len(), "motion");
    let mut contacts = spheres(spring(SpringLaw::Linear, 1.0));
    let mut forces = vec![DVec3::ZERO; x.len()];
    let mut touching = 0;
    for _ in 0..60 {
        x.iter_mut().zip(&v).for_each(|(x, v)| *x += 0.02 * *v);
        let at = Configuration::at_rest(&cell, &x);
        match contacts.evaluate(at, Part::All, Want::NOTHING, &mut forces) {
            Ok(_) => {}
            Err(ForceError::ContactTooDeep { .. }) => break,
            Err(e) => panic!("{e}"),
        }
        for (i, force) in forces.iter().enumerate() {
            let alone = contacts.force_on(i, at);
            assert!((alone - *force).length() < 1e-10, "{i}: {alone} {force}");
            touching += usize::from(*force != DVec3::ZERO);
        }
    }
    assert!(touching > 2000, "{touching}");
}

/// Two bodies that meet head on with a relative speed of 1; returns the relative speed after it.
fn rebound(response: Response, masses: &Masses, phase: f64, dt: f64) -> (f64, Rig) {
    let gap = (2.0 + phase) * dt;
    let x = vec![DVec3::splat(3.0), DVec3::new(4.0 + gap, 3.0, 3.0)];
    let v = vec![DVec3::new(0.6, 0.2, 0.0), DVec3::new(-0.4, 0.2, 0.0)];
    let system = System::atoms(2).with_masses(masses.clone());
    let mut rig = verlet(system, (cube(8.0), x, v), alone(spheres(response)), dt);
    for _ in 0..4000 {
        rig.step();
        let (x, v) = (&rig.state.positions, &rig.state.velocities);
        if x[1].x - x[0].x > 1.0 && v[1].x > v[0].x {
            break;
        }
    }
    let v = &rig.state.velocities;
    (v[1].x - v[0].x, rig)
}

#[test]
fn two_bodies_keep_the_restitution_that_was_set_and_their_momentum() {
    let dt = 0.1 / 800.0_f64.sqrt();
    for law in [SpringLaw::Linear, SpringLaw::Hertz] {
        for e in [0.05, 0.5, 0.9, 1.0] {
            for masses in [Masses::Uniform(1.0), Masses::Each(vec![1.0, 3.0])] {
                let mut mean = 0.0;
                for k in 0..50 {
                    let phase = (f64::from(k) + 0.5) / 50.0;
                    let before = [0.6, -0.4].map(|v: f64| v * v + 0.04);
                    let before: f64 = (0..2).map(|i| 0.5 * masses.of(i) * before[i]).sum();
                    let (found, rig) = rebound(spring(law, e), &masses, phase, dt);
                    mean += found / 50.0;
                    let momentum = rig.system.momentum(&rig.state.velocities);
                    let wanted = 0.6 * masses.of(0) - 0.4 * masses.of(1);
                    assert!((momentum.x - wanted).abs() < 1e-13 && momentum.z == 0.0);
                    // What the dashpot took is the heat, but for what velocity Verlet errs by.
                    assert!((rig.conserved() / before - 1.0).abs() < 0.01);
                }
                assert!((mean - e).abs() < 0.006, "{law:?} {e} {masses:?}: {mean}");
            }
        }
    }
}

#[test]
fn a_body_bounces_off_a_held_one_as_off_a_wall() {
    let dt = 0.1 / 400.0_f64.sqrt();
    let x = vec![DVec3::splat(3.0), DVec3::new(4.1, 3.0, 3.0)];
    let v = vec![DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.0)];
    let system = System::atoms(2).holding(&[0]);
    let forces = alone(spheres(spring(SpringLaw::Linear, 0.5)));
    let mut rig = verlet(system, (cube(8.0), x, v), forces, dt);
    (0..200).for_each(|_| drop(rig.step()));
    assert_eq!(rig.state.positions[0], DVec3::splat(3.0));
    assert_eq!(rig.state.velocities[0], DVec3::ZERO);
    assert!((rig.state.velocities[1].x - 0.5).abs() < 0.02);
    assert!((rig.conserved() - 0.5).abs() < 0.005);
}

#[test]
fn bodies_that_would_pass_through_each_other_stop_the_run() {
    let mut contacts = spheres(of_kind("soft"));
    let x = [DVec3::splat(3.0), DVec3::new(3.4, 3.0, 3.0)];
    let cell = cube(8.0);
    let at = Configuration::at_rest(&cell, &x);
    let found = contacts.evaluate(at, Part::All, Want::NOTHING, &mut [DVec3::ZERO; 2]);
    let error = found.unwrap_err().to_string();
    assert!(
        error.contains("particles 0 and 1 overlap by 0.6000 σ at (3.200, 3.000, 3.000) σ: deeper than 0.5000 σ, half their contact distance"),
        "{error}"
    );
}

#[test]
fn the_ends_of_a_bond_and_bodies_of_two_species_touch_as_they_should() {
    use lennard_core::{Bonds, Molecules, Species, SpeciesTable};
    let cell = cube(8.0);
    let x = [DVec3::splat(3.0), DVec3::new(3.8, 3.0, 3.0)];
    let bonded = Molecules::chains(2, 0.8, Bonds::Rigid).exclusions();
    let response = spring(SpringLaw::Linear, 1.0);
    let mut bond = Obstacles::new(None, Contacts::new(response, Bodies::alike(1.0, bonded)));
    assert_eq!(energy(&mut bond, &cell, &x), 0.0);
    assert!((energy(&mut spheres(response), &cell, &x) - 200.0 * 0.04).abs() < 1e-12);
    let table = SpeciesTable::new([Species::unnamed(), Species::unnamed()], &[0, 1]);
    let small = |a: usize, b: usize| [0.5, 0.9, 1.0][a + b];
    let bodies = Bodies::of_species(table, small, Exclusions::NONE);
    assert_eq!(bodies.largest(), 1.0);
    let mut unlike = Obstacles::new(None, Contacts::new(response, bodies));
    assert!((energy(&mut unlike, &cell, &x) - 200.0 * 0.01).abs() < 1e-12);
}
