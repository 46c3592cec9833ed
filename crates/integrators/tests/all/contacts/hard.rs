//! Impacts in flight.

use lennard_core::{DVec3, Exclusions, ForceSum, ForceTerm, Masses, NoForces, State, System};
use lennard_forcefield::ConstantField;
use lennard_integrators::{Bodies, Contacts, Obstacles, Response};

use super::common::{
    Rig, alone, cube, fly, lattice, of_kind, random_vectors, spheres, verlet, walls,
};

fn hard(restitution: f64) -> Response {
    Response::Impact { restitution }
}

#[test]
fn two_bodies_meet_at_the_exact_time_and_keep_the_share() {
    for e in [0.0, 0.3, 1.0] {
        for masses in [Masses::Uniform(2.0), Masses::Each(vec![1.0, 4.0])] {
            let mut x = [DVec3::splat(3.0), DVec3::new(4.5, 3.6, 3.0)];
            let mut v = [DVec3::new(1.0, 0.0, 0.1), DVec3::new(-0.5, 0.0, 0.1)];
            let before = [v[0], v[1]];
            let mut contacts = spheres(hard(e));
            let still = [DVec3::ZERO; 2];
            let flying = (&mut x[..], &mut v[..]);
            let heat = fly(contacts.boundary().unwrap(), 8.0, flying, (&still, &masses), (1.0, 0));
            // They touch where (1.5 − 1.5·t)² + 0.6² = 1: at t = 1 − 0.8/1.5, with the normal (0.8, 0.6, 0).
            let (time, normal) = (1.0 - 0.8 / 1.5, DVec3::new(0.8, 0.6, 0.0));
            let mass = masses.reduced(0, 1);
            let rate = normal.dot(before[1] - before[0]);
            let impulse = -(1.0 + e) * mass * rate * normal;
            let wanted = [before[0] - impulse / masses.of(0), before[1] + impulse / masses.of(1)];
            let start = [DVec3::splat(3.0), DVec3::new(4.5, 3.6, 3.0)];
            for i in 0..2 {
                assert!((v[i] - wanted[i]).length() < 1e-13, "{e}: {} {}", v[i], wanted[i]);
                let place = start[i] + time * before[i] + (1.0 - time) * wanted[i];
                assert!((x[i] - place).length() < 1e-13);
            }
            assert!((heat + 0.5 * mass * rate * rate * (1.0 - e * e)).abs() < 1e-13);
        }
    }
}

#[test]
fn a_fluid_of_hard_spheres_keeps_energy_and_momentum_and_collides_as_enskog_says() {
    // 216 spheres at ρ = 0.4: more than few, so that the list is in use.
    let n = 6;
    let side = (216.0_f64 / 0.4).cbrt();
    let x = lattice(n, side / n as f64, 0.1);
    let mut v = random_vectors(216, "fluid");
    let mean = v.iter().sum::<DVec3>() / 216.0;
    v.iter_mut().for_each(|v| *v -= mean);
    let system = System::atoms(216);
    let kinetic = system.kinetic_energy(&v);
    let temperature = 2.0 * kinetic / (3.0 * 216.0);
    let dt = 0.01;
    let mut rig = verlet(system, (cube(side), x, v), ForceSum::new(NoForces), dt);
    let (mut contacts, masses) = (spheres(hard(1.0)), Masses::Uniform(1.0));
    let steps = 1500;
    let (mut struck, mut closest) = (0, f64::INFINITY);
    for step in 0..steps {
        let State { positions, velocities, forces, .. } = &mut rig.state;
        let before = velocities.clone();
        let (flying, pushed) = ((&mut positions[..], &mut velocities[..]), (&forces[..], &masses));
        fly(contacts.boundary().unwrap(), side, flying, pushed, (dt, step));
        if step >= 300 {
            struck += before.iter().zip(&rig.state.velocities).filter(|(a, b)| a != b).count();
        }
        if step % 100 == 0 {
            let x = &rig.state.positions;
            for (i, a) in x.iter().enumerate() {
                let apart = |b: &DVec3| rig.state.cell.minimum_image(*a - *b).length();
                closest = x[..i].iter().map(apart).fold(closest, f64::min);
            }
        }
    }
    assert!(closest > 1.0 - 1e-9, "{closest}");
    assert!((rig.kinetic_energy() / kinetic - 1.0).abs() < 1e-11);
    let momentum = rig.system.momentum(&rig.state.velocities);
    assert!(momentum.length() < 1e-11, "{momentum}");
    // Γ = 2·ρ·g(d)·d²·√(πT/m) collisions of each body over time, each of two; g(d) of Carnahan and Starling.
    let packing = std::f64::consts::PI / 6.0 * 0.4;
    let at_contact = (1.0 - 0.5 * packing) / (1.0 - packing).powi(3);
    let of_each = 4.0 * 0.4 * at_contact * (std::f64::consts::PI * temperature).sqrt();
    let time = (steps - 300) as f64 * dt;
    let wanted = of_each * 216.0 * time;
    let found = struck as f64;
    assert!((found / wanted - 1.0).abs() < 0.05, "{found} {wanted}");
}

/// Balls over a hard floor at z = 1 in a box of 8 σ, in gravity.
fn over_a_floor(z: &[f64], e_floor: f64, e_balls: f64) -> Rig {
    let floor = format!("kind = \"hard\"\nrestitution = {e_floor:?}");
    let walls = walls(&floor, 8.0, &[2], 2.0);
    let bodies = Bodies::alike(1.0, Exclusions::NONE);
    let contacts = Obstacles::new(walls, Contacts::new(hard(e_balls), bodies));
    let field = ConstantField::new(DVec3::NEG_Z, Masses::Uniform(1.0));
    let forces = ForceSum::new(NoForces).with(contacts).with(field);
    let x = z.iter().map(|z| DVec3::new(4.0, 4.0, 1.0 + z)).collect();
    let v = vec![DVec3::ZERO; z.len()];
    let system = System::atoms(z.len()).pushed_along(forces.properties().breaks_momentum);
    verlet(system, (cube(8.0), x, v), forces, 0.005)
}

#[test]
fn a_stack_of_hard_balls_comes_to_rest_without_overlap() {
    let mut rig = over_a_floor(&[0.5, 1.7, 2.9], 0.5, 0.5);
    let before = rig.conserved();
    (0..3000).for_each(|_| drop(rig.step()));
    let z: Vec<f64> = rig.state.positions.iter().map(|x| x.z - 1.0).collect();
    for (i, z) in z.iter().enumerate() {
        assert!((z - i as f64).abs() < 1e-9, "{i}: {z}");
        // Half a kick, which the next drift does not follow.
        assert!((rig.state.velocities[i].z + 0.0025).abs() < 1e-9);
    }
    // Steps of kick-drift-kick err by at most m·g·v·h for each bounce, and a stack at rest by nothing.
    let after = rig.conserved();
    assert!((after - before).abs() < 0.05, "{after} {before}");
    // The floor carries the weight of three.
    let floor = |rig: &Rig| rig.forces.walls()[0].impulse;
    let start = floor(&rig);
    (0..1000).for_each(|_| drop(rig.step()));
    let force = (floor(&rig) - start) / 5.0;
    assert!((force / 3.0 - 1.0).abs() < 1e-9, "{force}");
    assert!((rig.conserved() - after).abs() < 1e-9);
}

#[test]
fn an_elastic_ball_on_a_ball_keeps_its_energy() {
    // Gaps are unlike, so that no two impacts fall together.
    let mut rig = over_a_floor(&[1.0, 3.1], 1.0, 1.0);
    let before = rig.conserved();
    let mut farthest = 0.0_f64;
    for _ in 0..20_000 {
        rig.step();
        farthest = farthest.max((rig.conserved() - before).abs());
    }
    assert_eq!(rig.heat, 0.0);
    assert!(farthest < 0.05, "{farthest}");
}

#[test]
fn hard_bodies_bounce_off_held_ones_and_held_ones_stay() {
    let masses = Masses::Each(vec![f64::INFINITY, 1.0, f64::INFINITY]);
    let mut x = [DVec3::splat(2.0), DVec3::new(4.0, 2.0, 2.0), DVec3::new(6.0, 2.0, 2.0)];
    let mut v = [DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.0), DVec3::ZERO];
    let mut contacts = alone(spheres(of_kind("hard")));
    // It flies to and fro over 2 σ: after 4 τ it is where it was.
    for step in 0..40 {
        let flying = (&mut x[..], &mut v[..]);
        let still = [DVec3::ZERO; 3];
        fly(contacts.boundary().unwrap(), 8.0, flying, (&still, &masses), (0.1, step));
    }
    assert!((x[1] - DVec3::new(4.0, 2.0, 2.0)).length() < 1e-12, "{}", x[1]);
    assert_eq!((x[0], v[2]), (DVec3::splat(2.0), DVec3::ZERO));
}

#[test]
fn a_wall_at_a_temperature_lets_no_body_rest_however_hard_it_is_pressed() {
    let walls = walls("kind = \"thermal\"\ntemperature = 1e-4", 8.0, &[2], 2.0);
    let mut contacts =
        Obstacles::new(walls, Contacts::new(hard(0.5), Bodies::alike(1.0, Exclusions::NONE)));
    let (mut x, mut v) = ([DVec3::new(4.0, 4.0, 1.0)], [DVec3::NEG_Z]);
    // A kick of 2 σ/τ, more than the body is fast.
    let pushed = (&[DVec3::new(0.0, 0.0, -20.0)][..], &Masses::Uniform(1.0));
    let heat = fly(contacts.boundary().unwrap(), 8.0, (&mut x, &mut v), pushed, (0.1, 0));
    assert!(v[0].z > 0.0 && v[0].z < 0.1, "{}", v[0]);
    assert!((heat - 0.5 * (v[0].length_squared() - 1.0)).abs() < 1e-15);
}
