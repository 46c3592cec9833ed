//! The wall of one layer of Lennard-Jones sites.

use super::{Surface, Wall, WallContext, WallForce, WallSpec};
use crate::contact_law::ForcePoint;
use std::f64::consts::TAU;

lennard_core::options! {
    /// U = 2π·n_w·[(2/5)·z⁻¹⁰ − z⁻⁴] − U(cutoff) up to the cutoff, in ε with z in σ: Lennard-Jones sites spread over the
    /// plane with n_w per σ². Before the shift the minimum is −(6π/5)·n_w at z = 1.
    #[derive(Copy)]
    pub struct LennardJones104 {
        /// Sites per area, n_w.
        surface_density: f64 = 1.0, Positive, in "σ⁻²";
        /// Distance at which the force ends; U is shifted to 0 there.
        cutoff: f64 = 2.5, Between(1.0, 1e3), in "σ";
    }
}

impl LennardJones104 {
    fn unshifted(z: f64) -> ForcePoint {
        let inverse = 1.0 / z;
        let square = inverse * inverse;
        let fourth = square * square;
        let tenth = fourth * fourth * square;
        ForcePoint {
            energy: TAU * (0.4 * tenth - fourth),
            force: TAU * (4.0 * tenth - 4.0 * fourth) * inverse,
            curvature: TAU * (44.0 * tenth - 20.0 * fourth) * square,
        }
    }

    fn at(&self, z: f64) -> ForcePoint {
        let (here, end) = (Self::unshifted(z), Self::unshifted(self.cutoff));
        ForcePoint {
            energy: self.surface_density * (here.energy - end.energy),
            force: self.surface_density * here.force,
            curvature: self.surface_density * here.curvature,
        }
    }
}

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "lennard-jones-10-4",
    summary: "A layer of Lennard-Jones sites, cut and shifted.",
    equation: "U = 2 pi n_w [(2/5) z^-10 - z^-4] - U(cutoff)",
    source: "derived here: the integral of 4 (r^-12 - r^-6) over a plane",
};

impl Wall for LennardJones104 {
    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        let wall = *self;
        Surface::Exerts(WallForce::new(self.cutoff, 1.0, move |z| wall.at(z)))
    }
}
