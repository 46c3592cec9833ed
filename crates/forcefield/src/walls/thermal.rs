//! Walls at a temperature.

use lennard_core::DVec3;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::{Hit, Rebound, Surface, Wall, WallContext, WallSpec};

lennard_core::options! {
    /// Hard planes at a temperature T: a particle leaves with a new velocity. Its normal speed is √(−2T·ln u/m), which has
    /// the density of the flux, v·e^{−mv²/2T}; its tangential velocity is Gaussian of variance T/m.
    ///
    /// The kinetic energy that hits put in counts as heat.
    #[derive(Copy)]
    pub struct Thermal {
        /// Temperature of the walls.
        temperature: Option<f64> = None, else "`system.temperature`", Positive, in "ε/k_B";
        /// Temperature of the wall at the upper end.
        upper_temperature: Option<f64> = None, else "`temperature` of the same wall", Positive, in "ε/k_B";
    }
}

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "thermal",
    summary: "Hard planes that give each particle that hits them a new velocity from their temperature.",
    equation: "v_n = sqrt(-2 T ln(u)/m), v_t Gaussian of variance T/m",
    source: "derived here: particles of a gas at T cross a plane with the density v exp(-m v^2/2T) of their normal speed",
};

impl Wall for Thermal {
    fn surface(&self, context: &WallContext, is_upper: bool) -> Surface {
        let upper = self.upper_temperature.filter(|_| is_upper);
        let temperature = upper.or(self.temperature);
        let temperature = temperature.unwrap_or(context.temperature);
        Surface::Hit(Rebound::Draws { temperature })
    }
}

/// The velocity with which a particle leaves a plane at a temperature, ε/k_B.
pub(super) fn draw(temperature: f64, hit: Hit<'_>) -> DVec3 {
    let spread = (temperature / hit.mass).sqrt();
    // 1 − u lies in (0, 1]: the logarithm is finite.
    let u: f64 = 1.0 - hit.random.random::<f64>();
    let mut normal = || -> f64 { StandardNormal.sample(&mut *hit.random) };
    let mut v = DVec3::new(normal(), normal(), normal()) * spread;
    v[hit.axis] = -hit.outward * spread * (-2.0 * u.ln()).sqrt();
    v
}
