//! A wall that repels as Lennard-Jones does.

use super::{Surface, Wall, WallContext, WallForce, WallSpec};
use crate::contact_law::ForcePoint;

lennard_core::options! {
    /// U = ε_w·[4·(z⁻¹² − z⁻⁶) + 1] up to z = 2^{1/6} σ, where U and force end at 0.
    #[derive(Copy)]
    pub struct WcaWall {
        /// Strength ε_w.
        strength: f64 = 1.0, Positive, in "ε";
    }
}

/// 2^{1/6}, where the wall ends, σ.
const END: f64 = 1.122_462_048_309_373;

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "wca",
    summary: "The repulsive part of 12-6 in the distance from the plane, ending smoothly.",
    equation: "U = e_w [4 (z^-12 - z^-6) + 1] for z <= 2^(1/6), else 0",
    source: "J. D. Weeks, D. Chandler and H. C. Andersen, Role of repulsive forces in determining the equilibrium structure of simple liquids, J. Chem. Phys. 54 (1971) 5237, eq. 4, with z in place of r",
};

impl Wall for WcaWall {
    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        let wall = *self;
        Surface::Exerts(WallForce::new(END, 1.0, move |z| wall.at(z)))
    }
}

impl WcaWall {
    fn at(&self, z: f64) -> ForcePoint {
        let inverse = 1.0 / z;
        let square = inverse * inverse;
        let sixth = square * square * square;
        let twelfth = sixth * sixth;
        ForcePoint {
            energy: self.strength * (4.0 * (twelfth - sixth) + 1.0),
            force: self.strength * (48.0 * twelfth - 24.0 * sixth) * inverse,
            curvature: self.strength * (624.0 * twelfth - 168.0 * sixth) * square,
        }
    }
}
