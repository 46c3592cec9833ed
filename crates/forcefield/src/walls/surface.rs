//! What a wall does to a particle: it exerts a force, or it is hit.

use std::fmt::Debug;
use std::sync::Arc;

use lennard_core::DVec3;
use lennard_core::random::CounterRng;

/// Energy, force and curvature of a wall at one distance.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallPoint {
    /// U(z), ε.
    pub energy: f64,
    /// −dU/dz, ε/σ; positive where the wall pushes a particle away.
    pub force: f64,
    /// d²U/dz², ε/σ².
    pub curvature: f64,
}

/// A wall that exerts a force at a distance z from its plane, σ; z is positive between the planes.
pub trait WallForce: Debug + Send + Sync {
    /// Energy, force and curvature at z < [`WallForce::reach`].
    fn at(&self, z: f64) -> WallPoint;

    /// The distance beyond which the wall exerts no force, σ.
    fn reach(&self) -> f64;

    /// The distance at which the first layer of a lattice may stand, σ.
    fn clearance(&self) -> f64;

    /// Whether the force is defined behind the plane too, at z ≤ 0.
    fn acts_behind_plane(&self) -> bool {
        false
    }
}

/// A particle at the moment at which it hits a plane.
#[derive(Debug)]
pub struct Hit<'a> {
    /// The axis of the normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// The direction out of the slit along the axis: −1 or +1.
    pub outward: f64,
    /// Velocity before the hit, σ/τ.
    pub velocity: DVec3,
    /// Mass of the particle.
    pub mass: f64,
    /// Random numbers of this particle in this step.
    pub random: &'a mut CounterRng,
}

/// A wall that is hit.
pub trait Rebound: Debug + Send + Sync {
    /// The velocity with which a particle leaves, σ/τ; its outward component is 0 or less.
    fn leave(&self, hit: Hit<'_>) -> DVec3;

    /// Whether a hit changes velocities along the plane too.
    fn drags(&self) -> bool;

    /// Whether particles fly to this wall along parabolas, as under a constant acceleration.
    fn follows_parabolas(&self) -> bool {
        false
    }
}

/// What a wall does to particles.
#[derive(Debug, Clone)]
pub enum Surface {
    /// It exerts a force.
    Exerts(Arc<dyn WallForce>),
    /// It is hit.
    Hit(Arc<dyn Rebound>),
}

impl Surface {
    /// The distance at which the first layer of a lattice may stand, σ.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        match self {
            Self::Exerts(force) => force.clearance(),
            Self::Hit(_) => 0.0,
        }
    }
}
