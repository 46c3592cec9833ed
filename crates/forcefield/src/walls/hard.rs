//! Hard walls from which particles bounce.

use std::sync::Arc;

use lennard_core::DVec3;

use super::{Hit, Rebound, Surface, Wall, WallContext, WallSpec};

lennard_core::options! {
    /// Hard planes for the centres of particles: v_z ← −e·v_z at each hit, inside the drift (billiard rule).
    ///
    /// The drift flies to the plane, changes the velocity and flies on. For e = 1, drift and kicks are exact flows:
    /// the step stays symplectic and reversible.
    #[derive(Copy)]
    pub struct Hard {
        /// Restitution e: the share of the normal speed that a particle keeps at a hit. Below 1 the hits take energy out, which counts as heat.
        restitution: f64 = 1.0, Between(0.0, 1.0);
    }
}

impl Wall for Hard {
    const SPEC: WallSpec = WallSpec {
        name: "hard",
        summary: "Hard planes from which the centres of particles bounce inside the drift.",
        equation: "v_z -> -e v_z at z = 0",
        source: "derived here: between kicks the motion of billiard is exact, so that the sum of wall forces obeys the virial theorem step by step (docs/walls.md)",
    };

    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        Surface::Hit(Arc::new(*self))
    }
}

impl Rebound for Hard {
    fn leave(&self, hit: Hit<'_>) -> DVec3 {
        let mut v = hit.velocity;
        v[hit.axis] *= -self.restitution;
        v
    }

    fn drags(&self) -> bool {
        false
    }
}
