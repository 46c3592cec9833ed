//! The dashpots of soft contacts: what acts on velocities before and after a flight.

use lennard_core::{DVec3, Masses, PeriodicBox};
use lennard_forcefield::ContactLaw;

use super::bodies::Bodies;
use super::bodies::reduced_mass;

/// Bodies in flight, as dashpots see them.
pub(crate) struct Moving<'a> {
    pub cell: &'a PeriodicBox,
    pub positions: &'a [DVec3],
    pub velocities: &'a mut [DVec3],
    pub masses: &'a Masses,
}

/// Lets the dashpots of all pairs act for a time h, τ, one pair after the other; returns the kinetic energy put in, 0 or less, ε.
///
/// The decay of each pair is exact. Before the flight pairs come in their order and after it in reverse, so that the whole step is
/// symmetric in time.
pub(crate) fn damp(
    law: &ContactLaw,
    bodies: &Bodies,
    pairs: &[[u32; 2]],
    moving: &mut Moving<'_>,
    h: f64,
    is_after: bool,
) -> f64 {
    let mut heat = 0.0;
    for k in 0..pairs.len() {
        let [i, j] = pairs[if is_after { pairs.len() - 1 - k } else { k }];
        let (i, j) = (i as usize, j as usize);
        let apart = moving.cell.minimum_image(moving.positions[j] - moving.positions[i]);
        let distance = bodies.distance(i, j);
        let r2 = apart.length_squared();
        if r2 >= distance * distance || r2 == 0.0 {
            continue;
        }
        let Some(mass) = reduced_mass(moving.masses, i, j) else {
            continue;
        };
        let r = r2.sqrt();
        let normal = apart / r;
        let approach = -normal.dot(moving.velocities[j] - moving.velocities[i]);
        let after = law.damped(distance - r, approach, mass, h);
        push(moving, (i, j), mass * (approach - after) * normal);
        heat += 0.5 * mass * (after * after - approach * approach);
    }
    heat
}

/// Hands an impulse to two bodies: to j as it is, to i with the other sign.
fn push(moving: &mut Moving<'_>, (i, j): (usize, usize), impulse: DVec3) {
    moving.velocities[i] -= impulse / moving.masses.of(i);
    moving.velocities[j] += impulse / moving.masses.of(j);
}
