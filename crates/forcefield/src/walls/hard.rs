//! Hard walls from which particles bounce.

use lennard_core::options::OptionError;

use super::{HitRule, Rebound, Surface, Wall, WallContext, WallSpec};

lennard_core::choices! {
    /// How a particle flies from hit to hit, and what a hit does.
    pub enum Response {
        /// Along straight lines inside the drift of kick-drift-kick.
        #[default]
        Billiard = "billiard",
        /// Along parabolas: exact for one particle in a constant field.
        Event = "event",
        /// At the end of the step: x ← −e·x and v ← −e·v, counted from the plane.
        Mirror = "mirror",
        /// At the end of the drift: back to the plane, and Verlet's velocity of the displacement.
        Project = "project",
        /// As a contact of SPOOK: `[contact] kind = "spook"` solves for it in its step.
        Contact = "contact",
    }
}

lennard_core::options! {
    /// Hard planes for the centres of particles: v_z ← −e·v_z at each hit.
    ///
    /// With `billiard` the drift flies to the plane, changes the velocity and flies on. For e = 1, drift and kicks are exact
    /// flows: the step stays symplectic and reversible. With `event` the flight is the parabola of a constant acceleration.
    /// Hits then have their exact times. A particle comes to rest where the next flight would be shorter than two steps.
    ///
    /// With `mirror` a step ends first, and then position and velocity are mirrored. In a field each bounce gains 2g·|x|. With
    /// `project` a position behind the plane is moved to the plane, and its velocity becomes (x' − x)/h: e is 0.
    ///
    /// With `contact` the planes are contacts of SPOOK, as bodies are to each other. With `billiard`, `mirror` and `project`, where e
    /// is below 1, a particle rests at a plane where one kick alone has brought its speed. No heat is counted then.
    #[derive(Copy)]
    pub struct Hard {
        /// What happens at a hit; `event` for one particle under velocity Verlet alone, `mirror` under velocity Verlet, `contact` beside contacts of SPOOK.
        response: Response = Response::Billiard, Names(Response::names);
        /// Restitution e: the share of the normal speed that a particle keeps at a hit. Below 1 the hits take energy out, which counts as heat.
        restitution: Option<f64> = None, else "1; 0 with `project`", Between(0.0, 1.0);
    }
}

impl Hard {
    fn kept_share(&self) -> f64 {
        let usual = match self.response {
            Response::Project => 0.0,
            Response::Billiard | Response::Event | Response::Mirror | Response::Contact => 1.0,
        };
        self.restitution.unwrap_or(usual)
    }
}

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "hard",
    summary: "Hard planes from which the centres of particles bounce inside the drift.",
    equation: "v_z -> -e v_z at z = 0",
    source: "derived here: the motion between kicks is exact, and the momentum of hits obeys the virial theorem step by step (docs/walls.md)",
};

impl Wall for Hard {
    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        let restitution = self.kept_share();
        let rule = match self.response {
            Response::Billiard => HitRule::OnLines,
            Response::Event => HitRule::OnParabolas,
            Response::Mirror => HitRule::Mirrored { restitution },
            Response::Project => HitRule::Projected,
            Response::Contact => HitRule::ByContacts,
        };
        Surface::Hit(Rebound::Keeps { restitution, rule })
    }

    fn check_together(&self) -> Result<(), OptionError> {
        match self.restitution {
            Some(e) if self.response == Response::Project && e > 0.0 => Err(OptionError {
                key: "restitution",
                found: format!("{e} with response = \"project\""),
                allowed:
                    "0, or nothing: a projection keeps no speed; \"billiard\" takes any restitution"
                        .to_owned(),
            }),
            _ => Ok(()),
        }
    }
}
