//! What holds bonds during a drift.

use crate::{DVec3, StepError, System};

/// What happened in one drift.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drifted {
    /// Iterations or sweeps of the molecule, or of the group of contacts, that needed most.
    pub iterations: u32,
    /// The largest | |d|/r − 1 | of a bond that is left; for contacts the residual of their solver.
    pub residual: f64,
    /// Energy that the drift put in, ε: by hits, by dashpots, or by a way to hold bonds that damps on purpose; else zero.
    pub heat: f64,
}

impl Drifted {
    /// A drift in which nothing was solved for, and which put in this energy, ε.
    #[must_use]
    pub fn with_heat(heat: f64) -> Self {
        Self { heat, ..Self::default() }
    }

    /// What happened in this drift and in another one.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            iterations: self.iterations + other.iterations,
            residual: self.residual.max(other.residual),
            heat: self.heat + other.heat,
        }
    }
}

/// A drift under way, with the kick that goes before it.
#[derive(Debug)]
pub struct BoundDrift<'a> {
    /// Positions, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// Forces, ε/σ.
    pub forces: &'a [DVec3],
    /// The time of the kick v ← v + (h/m)·F that comes first, τ; `None` where there is none.
    pub kick: Option<f64>,
    /// The time of the drift, τ.
    pub h: f64,
}

/// A way to hold bonds by what happens in a drift.
///
/// The velocity stage after each kick, v ← v − M⁻¹Gᵀ·A⁻¹·Gv, is [`crate::rigid::project_velocities`].
pub trait BondSolver: Send {
    /// Whether velocities lose their part along the bonds after each kick, as RATTLE demands.
    fn has_velocity_stage(&self) -> bool {
        true
    }

    /// Kicks, drifts, and brings the bonds to where they belong, molecule by molecule.
    ///
    /// Velocities change by what sites are displaced over h, so that they belong to the corrected positions.
    ///
    /// # Errors
    /// [`StepError::BondTurned`] where a bond has no solution, [`StepError::BondsNotConverged`] where iterations end early.
    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError>;
}
