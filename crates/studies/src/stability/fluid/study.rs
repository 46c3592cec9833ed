//! What the study of the fluid measured.

use serde::Serialize;

use super::limit::FluidLimit;
use super::run::FluidRun;
use super::start::{STATES, TRUNCATIONS};

/// Index of the truncation that stands for all where only one can be shown. Its energy and force are continuous,
/// so that every error is an error of the method.
pub(super) const SHOWN_TRUNCATION: usize = 2;

/// Everything found on the fluid.
#[derive(Debug, Clone, Serialize)]
pub struct FluidStudy {
    /// Methods that cannot run a fluid, with the reason.
    pub left_out: Vec<(&'static str, String)>,
    /// Drift, fluctuation and temperature error.
    pub runs: Vec<FluidRun>,
    /// The largest stable steps.
    pub limits: Vec<FluidLimit>,
    /// Velocity Verlet with the switched potential at small steps in double precision.
    pub double: Vec<FluidRun>,
    /// The same in mixed precision.
    pub mixed: Vec<FluidRun>,
    /// Methods at 1.05 to 2 times their limits; one of each group that shares its map on the oscillator.
    pub past_limit: Vec<(f64, FluidRun)>,
}

/// The limit of a method at a state point under a truncation, as indices of [`STATES`] and [`TRUNCATIONS`].
pub(super) fn limit_at<'a>(
    limits: &'a [FluidLimit],
    method: &str,
    state: usize,
    truncation: usize,
) -> Option<&'a FluidLimit> {
    let (state, truncation) = (STATES[state].name, TRUNCATIONS[truncation].1);
    limits.iter().find(|l| l.method == method && l.state == state && l.truncation == truncation)
}
