//! What acts in a drift: walls that bound the flight, what they have felt, and solvers that hold bonds.

use glam::DVec3;

use crate::{Masses, Moving, PeriodicBox, StepError, System};

/// One plane of a pair of walls, with what particles have done to it.
///
/// Momentum and force count along the outward normal: positive where particles push the wall away from them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallReading {
    /// The axis of the normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether the wall stands at the upper end of the axis.
    pub is_upper: bool,
    /// Coordinate of the plane along the axis, σ.
    pub position: f64,
    /// Σ F of all particles on the wall at the last force evaluation, ε/σ; 0 for a wall that is only hit.
    pub force: f64,
    /// Σ m·Δv handed to the wall by hits since the start of the run, m·σ/τ.
    pub impulse: f64,
    /// Hits since the start of the run.
    pub hits: u64,
}

impl WallReading {
    /// A wall that has felt nothing.
    #[must_use]
    pub fn new(axis: usize, is_upper: bool, position: f64) -> Self {
        Self { axis, is_upper, position, force: 0.0, impulse: 0.0, hits: 0 }
    }

    /// The outward direction along the axis: −1 at the lower end, +1 at the upper.
    #[inline]
    #[must_use]
    pub fn outward(&self) -> f64 {
        if self.is_upper { 1.0 } else { -1.0 }
    }

    /// The outward normal, a unit vector.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        let mut normal = DVec3::ZERO;
        normal[self.axis] = self.outward();
        normal
    }

    /// The distance of a position from the plane, σ: positive between the planes.
    #[inline]
    #[must_use]
    pub fn distance(&self, x: DVec3) -> f64 {
        self.outward() * (self.position - x[self.axis])
    }
}

/// Particles in free flight over a time h.
#[derive(Debug)]
pub struct Flight<'a> {
    /// The box.
    pub cell: &'a PeriodicBox,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, `[N]`, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// Forces at the positions, `[N]`, ε/σ.
    pub forces: &'a [DVec3],
    /// The masses.
    pub masses: &'a Masses,
    /// The time h of the flight, τ; above 0.
    pub h: f64,
    /// Steps done before this one: the counter of random numbers.
    pub step: u64,
    /// Whether particles have flown in this step before: a second flight draws other random numbers.
    pub is_later: bool,
}

impl Flight<'_> {
    /// The flight of particles that meet nothing: x ← x + h·v.
    pub fn free(self) {
        let Self { positions, velocities, forces, h, .. } = self;
        Moving { positions, velocities, forces }.drift(h);
    }
}

/// What acts on particles in flight: walls and other particles that they hit, and dashpots.
pub trait Boundary {
    /// Moves particles by h·v along straight lines from hit to hit, and changes velocities at hits. Held particles stay.
    ///
    /// E minus the sum of the energy that it puts in is conserved.
    ///
    /// # Errors
    /// [`StepError`] where bonds or contacts have no solution in the flight.
    fn fly(&mut self, flight: Flight<'_>) -> Result<Drifted, StepError>;
}

// What holds bonds during a drift.

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
