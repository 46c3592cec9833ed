//! Velocities before the first step: drawn for a temperature, and without what a motion does not have.

use std::ops::Add;

use lennard_core::random::Streams;
use lennard_core::{DVec3, Momentum, System, rigid};
use rand_distr::{Distribution, StandardNormal};

/// Velocities from the Maxwell–Boltzmann distribution at some positions, without a part along rigid bonds.
///
/// They have zero total momentum (more than one particle) and are scaled to 2K/n_dof = `temperature` exactly.
#[must_use]
pub fn thermal_velocities(
    system: &System,
    positions: &[DVec3],
    temperature: f64,
    streams: Streams,
) -> Vec<DVec3> {
    let mut rng = streams.sequential("velocities");
    let mut normals =
        || DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut rng)));
    // One stream for all particles: a rank passes over those before its own.
    for _ in 0..system.own().first() {
        normals();
    }
    let velocity = |i: usize| (temperature / system.masses.of(i)).sqrt() * normals();
    let mut velocities: Vec<DVec3> = (0..positions.len()).map(velocity).collect();
    make_suit(system, positions, &mut velocities);
    scale_to_temperature(system, &mut velocities, temperature);
    velocities
}

/// Takes off velocities what the motion does not have: their part along rigid bonds, and the drift of all particles.
pub fn make_suit(system: &System, positions: &[DVec3], velocities: &mut [DVec3]) {
    rigid::project_velocities(system, positions, velocities);
    remove_drift(system, velocities);
}

/// Takes the velocity of the centre of mass off every particle, along axes where the forces keep the momentum.
/// A single particle keeps its velocity.
pub fn remove_drift(system: &System, velocities: &mut [DVec3]) {
    if system.len() > 1 {
        let mut mass = [0.0];
        system.own().in_turn(&mut mass, |mass| {
            mass[0] = (0..velocities.len()).map(|i| system.masses.of(i)).fold(mass[0], f64::add);
        });
        let drift = system.kept_part(system.momentum(velocities) / mass[0]);
        for v in velocities {
            *v -= drift;
        }
    }
}

/// A remark on a drift of all particles together, which a run takes off the velocities of a file; `None` where there is none but
/// rounding.
pub(super) fn remark_on_drift(system: &System, velocities: &[DVec3], file: &str) -> Option<String> {
    /// Of the mean square velocity: files hold nine digits and more.
    const ROUNDING: f64 = 1e-12;
    let n = velocities.len() as f64;
    let momentum = system.kept_part(system.momentum(velocities)) / n;
    let square = velocities.iter().map(|v| v.length_squared()).sum::<f64>() / n;
    if velocities.len() < 2 || momentum.length_squared() <= ROUNDING * square {
        return None;
    }
    let mut without = velocities.to_vec();
    remove_drift(system, &mut without);
    let [x, y, z] = momentum.to_array();
    let temperature = |velocities: &[DVec3]| system.temperature(velocities, Momentum::Conserved);
    Some(format!(
        "the velocities of {file} had a total momentum of ({x:.6}, {y:.6}, {z:.6}) per particle: removed, T changed \
         from {:.6} to {:.6}",
        temperature(velocities),
        temperature(&without)
    ))
}

/// Scales velocities so that 2K/n_dof = `temperature`; velocities that are all zero stay so.
pub fn scale_to_temperature(system: &System, velocities: &mut [DVec3], temperature: f64) {
    let now = system.temperature(velocities, Momentum::Conserved);
    if now > 0.0 {
        let factor = (temperature / now).sqrt();
        for v in velocities {
            *v *= factor;
        }
    }
}
