//! What holds rigid bonds during a drift.

use crate::{DVec3, StepError, System};

/// What a solver did for one drift.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BondsSolved {
    /// Iterations or sweeps of the molecule that needed most.
    pub iterations: u32,
    /// The largest | |d|/r − 1 | that is left.
    pub residual: f64,
}

/// A way to hold rigid bonds: the position stage after each drift.
///
/// The velocity stage after each kick, v ← v − M⁻¹Gᵀ·A⁻¹·Gv, is [`crate::rigid::project_velocities`].
pub trait BondSolver: Send {
    /// Remembers the bonds before a drift.
    fn before_drift(&mut self, system: &System, positions: &[DVec3]);

    /// Whether velocities lose their part along the bonds after each kick, as RATTLE demands.
    fn has_velocity_stage(&self) -> bool {
        true
    }

    /// Brings the bonds back to their length after a drift of `h` τ, and corrects each velocity by the displacement of its
    /// site over `h`.
    ///
    /// # Errors
    /// [`StepError::BondTurned`] where a bond has no solution, [`StepError::BondsNotConverged`] where iterations end early.
    fn after_drift(
        &mut self,
        system: &System,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        h: f64,
    ) -> Result<BondsSolved, StepError>;
}
