//! The wall of a half space of Lennard-Jones sites.

use super::{Surface, Wall, WallContext, WallForce, WallSpec};
use crate::contact_law::ForcePoint;

lennard_core::options! {
    /// U = ε_w·[(2/15)·z⁻⁹ − z⁻³] − U(cutoff) up to the cutoff, with z in σ: Lennard-Jones sites of density ρ_w that fill the
    /// half space behind the plane have ε_w = (2π/3)·ρ_w. Before the shift the minimum is −(√10/3)·ε_w at z = (2/5)^{1/6}.
    #[derive(Copy)]
    pub struct LennardJones93 {
        /// Strength ε_w.
        strength: f64 = 1.0, Positive, in "ε";
        /// Distance at which the force ends; U is shifted to 0 there.
        cutoff: f64 = 2.5, Between(0.9, 1e3), in "σ";
    }
}

/// (2/5)^{1/6}, the distance of the minimum, σ.
const MINIMUM: f64 = 0.858_374_218_932_559_2;

impl LennardJones93 {
    fn unshifted(z: f64) -> ForcePoint {
        let inverse = 1.0 / z;
        let third = inverse * inverse * inverse;
        let ninth = third * third * third;
        ForcePoint {
            energy: 2.0 / 15.0 * ninth - third,
            force: (1.2 * ninth - 3.0 * third) * inverse,
            curvature: (12.0 * ninth - 12.0 * third) * inverse * inverse,
        }
    }

    fn at(&self, z: f64) -> ForcePoint {
        let (here, end) = (Self::unshifted(z), Self::unshifted(self.cutoff));
        ForcePoint {
            energy: self.strength * (here.energy - end.energy),
            force: self.strength * here.force,
            curvature: self.strength * here.curvature,
        }
    }
}

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "lennard-jones-9-3",
    summary: "A half space of Lennard-Jones sites, cut and shifted.",
    equation: "U = e_w [(2/15) z^-9 - z^-3] - U(cutoff)",
    source: "derived here: the integral of 4 (r^-12 - r^-6) over a half space",
};

impl Wall for LennardJones93 {
    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        let wall = *self;
        Surface::Exerts(WallForce::new(self.cutoff, MINIMUM, move |z| wall.at(z)))
    }
}
