//! A wall that is a spring.

use super::{Surface, Wall, WallContext, WallForce, WallSpec};
use crate::contact_law::{ContactLaw, SMALLEST_SOFT_RESTITUTION, SpringLaw};

lennard_core::options! {
    /// A spring that pushes apart what overlaps: F = k·δ or k·δ^{3/2} at depth δ. At a wall it is the depth behind the plane, for two
    /// bodies the overlap. With a restitution below 1 a dashpot takes energy, which counts as heat.
    ///
    /// At the speed v and the mass m, reduced for two bodies, the depth is v·√(m/k) (linear) or (5m·v²/(4k))^{2/5} (Hertz) without a dashpot.
    #[derive(Copy)]
    pub struct Soft {
        /// How the force grows with the depth.
        law: SpringLaw = SpringLaw::Linear, Names(SpringLaw::names);
        /// Stiffness k; in ε/σ^{5/2} for `hertz`.
        stiffness: f64 = 1000.0, Positive, in "ε/σ²";
        /// Restitution e of a hit: it sets the dashpot. The contact never pulls.
        restitution: f64 = 1.0, BetweenElse(SMALLEST_SOFT_RESTITUTION, 1.0, "for less, `hard`, and between bodies also `spook`");
    }
}

impl Soft {
    /// The spring with its dashpot.
    #[must_use]
    pub fn contact(&self) -> ContactLaw {
        ContactLaw::new(self.law, self.stiffness, self.restitution)
    }
}

/// What it declares about itself.
pub const SPEC: WallSpec = WallSpec {
    name: "soft",
    summary: "A spring that pushes back what has passed the plane, linear or Hertzian, with a dashpot for a restitution below 1.",
    equation: "F = k d + c d' or k d^(3/2) + c d' >= 0 at depth d behind the plane; c from e",
    source: "L. D. Landau and E. M. Lifshitz, Theory of Elasticity, 3rd ed. (1986), section 9: F ~ d^(3/2) for elastic spheres; the dashpot is derived here",
};

impl Wall for Soft {
    fn surface(&self, _context: &WallContext, _is_upper: bool) -> Surface {
        let contact = self.contact();
        let mut force = WallForce::new(0.0, 0.0, move |z| contact.at(-z));
        force.contact = Some(contact);
        Surface::Exerts(force)
    }
}
