//! Errors that name the first particle with a number that is not finite.

use glam::DVec3;
use lennard_core::ForceError;

/// The error that names the first particle whose position is not finite.
pub fn position(positions: &[DVec3]) -> ForceError {
    ForceError::NonFinitePosition { particle: first(positions).unwrap_or_default() }
}

/// The error that names the first particle whose force is not finite.
pub fn force(forces: &[DVec3]) -> ForceError {
    ForceError::NonFiniteForce { particle: first(forces).unwrap_or_default() }
}

/// The first vector that is not finite.
pub fn first(vectors: &[DVec3]) -> Option<usize> {
    vectors.iter().position(|v| !v.is_finite())
}
