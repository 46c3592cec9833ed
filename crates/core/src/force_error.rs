//! Why forces fail.

use glam::DVec3;

/// Why forces cannot be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForceError {
    /// A position is not a finite number.
    #[error("the position of particle {particle} is not finite")]
    NonFinitePosition {
        /// Index of the particle, from 0.
        particle: usize,
    },
    /// A force is not a finite number: two particles lie on top of each other.
    #[error("the force on particle {particle} is not finite")]
    NonFiniteForce {
        /// Index of the particle, from 0.
        particle: usize,
    },
    /// The box changed, and the cutoff exceeds half of its shortest side.
    #[error(
        "the box has shrunk to {:.3} σ, below twice the cutoff of {r_cut} σ; \
         take more particles, a shorter cutoff or a lower pressure",
        2.0 * .largest
    )]
    CutoffOverHalfBox {
        /// The cutoff, σ.
        r_cut: f64,
        /// Half the shortest side, σ.
        largest: f64,
    },
    /// The box changed, and the loop in use does not resolve positions in it.
    #[error(
        "the box has grown to {widest:.3} σ, and its pair loop resolves positions up to {largest:.0} σ a side; \
         take `kernel.precision = \"double\"` or a higher pressure"
    )]
    BoxTooWide {
        /// The longest side, σ.
        widest: f64,
        /// The longest side that the loop takes, σ.
        largest: f64,
    },
    /// A particle is beyond a wall, where the wall exerts no force that could bring it back.
    #[error("particle {particle} is {depth:.4} σ beyond the wall at the {end} end of {axis}")]
    BeyondWall {
        /// Index of the particle, from 0.
        particle: usize,
        /// The axis of the wall.
        axis: &'static str,
        /// `lower` or `upper`.
        end: &'static str,
        /// Distance beyond the plane, σ.
        depth: f64,
    },
    /// Two bodies in contact overlap so deeply that they would pass through each other.
    #[error("particles {first} and {second} overlap by {depth:.4} σ at ({:.3}, {:.3}, {:.3}) σ: deeper than {deepest:.4} σ, half their contact distance", .at.x, .at.y, .at.z)]
    ContactTooDeep {
        /// Index of the first particle, from 0.
        first: usize,
        /// Index of the second.
        second: usize,
        /// The depth of the overlap, σ.
        depth: f64,
        /// The deepest overlap that is allowed, σ.
        deepest: f64,
        /// The middle between the two, σ.
        at: DVec3,
    },
    /// The forces have no near and far part.
    #[error("these forces cannot be split into a near and a far part")]
    NotSplit,
    /// The force needs velocities and got none.
    #[error("the force depends on velocities, and the method gives none")]
    NeedsVelocities,
}
