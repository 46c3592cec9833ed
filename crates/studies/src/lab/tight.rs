//! Tight trajectories that others are compared with, each computed once.

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use lennard_forcefield::TruncationOptions;

/// Where a tight trajectory ends, and how well that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct TightTrajectory {
    /// Unwrapped positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Root mean square distance from a trajectory with twice the step, σ.
    pub floor: f64,
}

type Slot = Arc<OnceLock<Arc<TightTrajectory>>>;

/// The tight trajectories made so far, each with its truncation and its time.
#[derive(Default)]
pub(super) struct References(Vec<(TruncationOptions, f64, Slot)>);

impl References {
    pub(super) fn slot(&mut self, truncation: TruncationOptions, time: f64) -> Slot {
        // A tail correction moves no particle.
        let key = TruncationOptions { tail_correction: false, ..truncation };
        if let Some((_, _, slot)) = self.0.iter().find(|(t, at, _)| *t == key && *at == time) {
            return Arc::clone(slot);
        }
        let slot = Slot::default();
        self.0.push((key, time, Arc::clone(&slot)));
        slot
    }
}
