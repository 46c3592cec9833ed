//! Flights of single particles between walls: hits on lines, too many hits, and walls at a temperature.

use lennard_core::random::Streams;
use lennard_core::{
    DVec3, ForceSum, ForceTerm, Masses, NoForces, PeriodicBox, State, Step, System, WallReading,
    Want,
};
use lennard_integrators::Obstacles;
use rand::RngExt;

use super::common::{fly, walls};

/// Walls across z of a cube of side 10, between 2 and 8.
fn slit(text: &str) -> Obstacles {
    Obstacles::new(walls(text, 10.0, &[2], 4.0), None)
}

/// One drift of 1 τ of a particle from the middle between the walls.
fn flown(walls: Obstacles, velocity: DVec3) -> (State, Vec<WallReading>, f64) {
    let system = System::atoms(1);
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let mut state = State::new(cell, vec![DVec3::new(0.0, 0.0, 5.0)], vec![velocity]);
    let mut forces = ForceSum::new(NoForces).with(walls);
    let spec = &lennard_integrators::velocity_verlet::SPEC;
    let mut step = Step::new(&system, &mut state, &mut forces, spec, 1.0, Want::NOTHING);
    step.drift(1.0);
    let heat = step.finish().heat;
    let readings = forces.walls().to_vec();
    (state, readings, heat)
}

#[test]
fn a_billiard_flight_keeps_the_restitution_to_rounding_and_hands_over_its_momentum() {
    for e in [1.0_f64, 0.9, 0.5, 0.1] {
        let (state, walls, heat) = flown(
            slit(&format!("kind = \"hard\"\nrestitution = {e:?}")),
            DVec3::new(0.5, 0.0, 4.0),
        );
        // Up 3 σ in 0.75 τ, then back at 4e for 0.25 τ.
        assert!((state.velocities[0].z + 4.0 * e).abs() < 1e-12);
        assert!((state.positions[0] - DVec3::new(0.5, 0.0, 8.0 - e)).length() < 1e-12);
        assert!((walls[1].impulse - 4.0 * (1.0 + e)).abs() < 1e-12);
        assert_eq!((walls[0].hits, walls[1].hits), (0, 1));
        assert!((heat + 8.0 * (1.0 - e * e)).abs() < 1e-12);
    }
    // Several hits in one flight: 3 up, 6 down, 6 up, 5 down.
    let (state, walls, heat) = flown(slit("kind = \"hard\""), DVec3::new(0.0, 0.0, 20.0));
    assert!((state.positions[0].z - 3.0).abs() < 1e-12);
    assert_eq!((walls[0].hits, walls[1].hits, heat), (1, 2, 0.0));
    assert!((walls[1].impulse - 80.0).abs() < 1e-12);
}

#[test]
fn a_particle_with_too_many_hits_rests_at_the_plane() {
    let (state, walls, _) = flown(slit("kind = \"hard\""), DVec3::new(0.0, 0.0, 1000.0));
    assert_eq!(walls[0].hits + walls[1].hits, 16);
    assert_eq!(state.velocities[0].z, 0.0);
    assert!((2.0..=8.0).contains(&state.positions[0].z));
}

#[test]
fn thermal_walls_give_the_speeds_of_the_flux() {
    let (mut normal, mut square, mut tangential) = (0.0, 0.0, 0.0);
    let n = 40_000_u64;
    let mut walls = slit("kind = \"thermal\"\ntemperature = 2.0\nupper_temperature = 0.5");
    let mut heat = 0.0;
    let system = System::atoms(1);
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    for step in 0..n {
        let mut positions = [DVec3::new(0.0, 0.0, 7.999)];
        let mut velocities = [DVec3::new(3.0, 0.0, 1.0)];
        let flying = (&mut positions[..], &mut velocities[..]);
        let still = (&[DVec3::ZERO][..], &system.masses);
        heat += fly(walls.boundary().unwrap(), 10.0, flying, still, (0.0011, step));
        let v = velocities[0];
        assert!(v.z <= 0.0 && cell.wrap(positions[0]).z < 8.0 + 1e-12);
        normal += -v.z / n as f64;
        square += v.z * v.z / n as f64;
        tangential += v.x * v.x / n as f64;
    }
    // The flux at T = 0.5: ⟨v⟩ = √(πT/2), ⟨v²⟩ = 2T; along the wall ⟨v²⟩ = T. Errors: four standard ones.
    let error = 4.0 / (n as f64).sqrt();
    assert!((normal - (std::f64::consts::PI * 0.25).sqrt()).abs() < error * 0.5);
    assert!((square - 1.0).abs() < error);
    assert!((tangential - 0.5).abs() < error * 0.8);
    let kinetic = 0.5 * (square + 2.0 * tangential) - 5.0;
    assert!((heat / n as f64 - kinetic).abs() < 4.0 * error);
}

#[test]
fn a_gas_without_collisions_between_two_temperatures_conducts_as_theory_says() {
    let (lower, upper) = (2.0_f64, 0.5_f64);
    let mut walls = slit(&format!(
        "kind = \"thermal\"\ntemperature = {lower:?}\nupper_temperature = {upper:?}"
    ));
    const N: usize = 2000;
    let mut random = Streams::new(5).sequential("gas");
    let mut positions: Vec<DVec3> =
        (0..N).map(|_| DVec3::new(0.0, 0.0, 2.0 + 6.0 * random.random::<f64>())).collect();
    let mut velocities = vec![DVec3::new(0.3, -0.2, 1.0); N];
    let (mut temperature, mut flux, mut lower_half, mut samples) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..3000 {
        let flying = (&mut positions[..], &mut velocities[..]);
        let still = (&[DVec3::ZERO; N][..], &Masses::Uniform(1.0));
        fly(walls.boundary().unwrap(), 10.0, flying, still, (1.0, step));
        if step < 200 {
            continue;
        }
        samples += N as f64;
        for (x, v) in positions.iter().zip(&velocities) {
            temperature += v.length_squared() / 3.0;
            flux += 0.5 * v.length_squared() * v.z;
            lower_half += f64::from(x.z < 5.0);
        }
    }
    let wanted = (lower * upper).sqrt();
    assert!((temperature / samples / wanted - 1.0).abs() < 0.01, "{temperature}");
    // Of n = 1: q = 2n·√(2·T₁·T₂/π)·(√T₁ − √T₂).
    let heat =
        2.0 * (2.0 * lower * upper / std::f64::consts::PI).sqrt() * (lower.sqrt() - upper.sqrt());
    assert!((flux / samples / heat - 1.0).abs() < 0.02, "{} {heat}", flux / samples);
    assert!((lower_half / samples - 0.5).abs() < 0.005, "{lower_half}");
}
