//! A wall that is a spring.

use std::sync::Arc;

use super::{Surface, Wall, WallContext, WallForce, WallPoint, WallSpec};

lennard_core::choices! {
    /// How the force grows with the depth δ behind the plane.
    pub enum SpringLaw {
        /// F = k·δ.
        #[default]
        Linear = "linear",
        /// F = k·δ^{3/2}, the contact of elastic spheres.
        Hertz = "hertz",
    }
}

lennard_core::options! {
    /// A spring behind the plane: F = k·δ or k·δ^{3/2} at depth δ = −z > 0, and nothing before it. It takes no energy.
    ///
    /// A particle of speed v reaches the depth v·√(m/k) (linear) or (5m·v²/(4k))^{2/5} (Hertz).
    #[derive(Copy)]
    pub struct Soft {
        /// How the force grows with the depth.
        law: SpringLaw = SpringLaw::Linear, Names(SpringLaw::names);
        /// Stiffness k; in ε/σ^{5/2} for `hertz`.
        stiffness: f64 = 1000.0, Positive, in "ε/σ²";
    }
}

impl Wall for Soft {
    const SPEC: WallSpec = WallSpec {
        name: "soft",
        summary: "A spring that pushes back what has passed the plane, linear or Hertzian.",
        equation: "F = k d or k d^(3/2) at depth d behind the plane",
        source: "L. D. Landau and E. M. Lifshitz, Theory of Elasticity, 3rd ed. (1986), section 9: F ~ d^(3/2) for elastic spheres",
    };

    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        Surface::Exerts(Arc::new(*self))
    }
}

impl WallForce for Soft {
    fn at(&self, z: f64) -> WallPoint {
        let (k, depth) = (self.stiffness, -z);
        if depth <= 0.0 {
            return WallPoint::default();
        }
        match self.law {
            SpringLaw::Linear => WallPoint {
                energy: 0.5 * k * depth * depth,
                force: k * depth,
                curvature: k,
            },
            SpringLaw::Hertz => {
                let root = depth.sqrt();
                WallPoint {
                    energy: 0.4 * k * depth * depth * root,
                    force: k * depth * root,
                    curvature: 1.5 * k * root,
                }
            }
        }
    }

    fn reach(&self) -> f64 {
        0.0
    }

    fn clearance(&self) -> f64 {
        0.0
    }

    fn acts_behind_plane(&self) -> bool {
        true
    }
}
