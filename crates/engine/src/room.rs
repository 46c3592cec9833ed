//! Whether the memory that a run will hold is there, asked before any of it is made.

use std::f64::consts::PI;

use lennard_core::PeriodicBox;
use lennard_forcefield::Precision;
use lennard_literature::bisect;
use lennard_scene::Scene;

/// Bytes per particle of state, copies and checkpoint, and per neighbor in a list, as `lennard plan` counts them.
///
/// They hold within a tenth from a thin gas to a crystal with a cutoff of 4 σ.
const fn bytes_of(precision: Precision) -> (f64, f64) {
    match precision {
        Precision::Double => (625.0, 2.9),
        Precision::Mixed => (545.0, 1.0),
    }
}
/// A usual skin of a list, σ.
const SKIN: f64 = 0.3;
/// Halvings that find the largest room.
const HALVINGS: usize = 24;

/// The system has no memory for so many particles: exit code 1.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "{particles} particles need about {:.2} GB of memory, and {:.2} GB can be had\n  \
     allowed: about {fit} particles of this density and cutoff, or more memory (`ulimit -v`, the limit of the job or of the machine)",
    needed * 1e-9, limit * 1e-9
)]
pub struct NoRoom {
    /// Number of particles.
    pub particles: usize,
    /// Bytes that they need.
    pub needed: f64,
    /// Bytes that the system gives.
    pub limit: f64,
    /// Number of particles that fit.
    pub fit: usize,
}

/// Bytes that a run of `n` particles in a box will hold, as foreseen from density and cutoff.
fn foreseen(scene: &Scene, cell: &PeriodicBox, n: usize) -> f64 {
    let (own, per_neighbor) = bytes_of(scene.kernel.precision);
    let reach = scene.longest_cutoff() + SKIN;
    let neighbors = 4.0 / 3.0 * PI * reach.powi(3) * n as f64 / cell.volume();
    n as f64 * (own + per_neighbor * neighbors.min(n as f64))
}

/// Asks the system for the memory of a run on one of so many ranks, and gives it back.
///
/// # Errors
/// [`NoRoom`] where it is not there.
pub(crate) fn is_there(
    scene: &Scene,
    cell: &PeriodicBox,
    n: usize,
    ranks: usize,
) -> Result<(), NoRoom> {
    let needed = foreseen(scene, cell, n) / ranks as f64;
    if can_be_had(needed) {
        return Ok(());
    }
    let [limit, _] = bisect(0.0, needed, HALVINGS, can_be_had);
    Err(NoRoom { particles: n, needed, limit, fit: (n as f64 * limit / needed) as usize })
}

/// Whether so many bytes can be had at once. None of them is touched.
fn can_be_had(bytes: f64) -> bool {
    Vec::<u8>::new().try_reserve_exact(bytes as usize).is_ok()
}
