//! Hard walls from which particles bounce.

use std::sync::Arc;

use lennard_core::DVec3;

use super::{Hit, Rebound, Surface, Wall, WallContext, WallSpec};

lennard_core::choices! {
    /// How a particle flies from hit to hit.
    pub enum Response {
        /// Along straight lines inside the drift of kick-drift-kick.
        #[default]
        Billiard = "billiard",
        /// Along parabolas: exact for one particle in a constant field.
        Event = "event",
    }
}

lennard_core::options! {
    /// Hard planes for the centres of particles: v_z ← −e·v_z at each hit.
    ///
    /// With `billiard` the drift flies to the plane, changes the velocity and flies on. For e = 1, drift and kicks are exact
    /// flows: the step stays symplectic and reversible. With `event` the flight is the parabola of a constant acceleration.
    /// Hits then have their exact times. A particle comes to rest where the next flight would be shorter than two steps.
    #[derive(Copy)]
    pub struct Hard {
        /// Flight between hits; `event` for one particle under velocity Verlet alone.
        response: Response = Response::Billiard, Names(Response::names);
        /// Restitution e: the share of the normal speed that a particle keeps at a hit. Below 1 the hits take energy out, which counts as heat.
        restitution: f64 = 1.0, Between(0.0, 1.0);
    }
}

impl Wall for Hard {
    const SPEC: WallSpec = WallSpec {
        name: "hard",
        summary: "Hard planes from which the centres of particles bounce inside the drift.",
        equation: "v_z -> -e v_z at z = 0",
        source: "derived here: the motion between kicks is exact, and the momentum of hits obeys the virial theorem step by step (docs/walls.md)",
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

    fn follows_parabolas(&self) -> bool {
        self.response == Response::Event
    }
}
