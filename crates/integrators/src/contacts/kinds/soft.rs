//! Bodies that are springs where they overlap: the spring of soft walls, with the same options.

pub use lennard_forcefield::Soft as Options;
use lennard_forcefield::SpringLaw;

use super::{ContactKind, ContactSpec, Response};

/// What this kind declares about itself.
pub const SPEC: ContactSpec = ContactSpec {
    name: "soft",
    summary: "A spring pushes bodies that overlap apart, linear or Hertzian, with a dashpot for a restitution below 1.",
    equation: "F = k d + c d' or k d^(3/2) + c d' >= 0 at depth d of the overlap; c from e and the reduced mass",
    source: "L. D. Landau and E. M. Lifshitz, Theory of Elasticity, 3rd ed. (1986), section 9: F ~ d^(3/2) for elastic spheres; the dashpot is derived here",
};

impl ContactKind for Options {
    fn response(&self) -> Response {
        Response::Spring(self.contact())
    }

    fn in_words(&self) -> String {
        let unit = match self.law {
            SpringLaw::Linear => "ε/σ²",
            SpringLaw::Hertz => "ε/σ^(5/2)",
        };
        format!(
            "soft contacts, {} with {} {unit}, restitution {}",
            self.law.name(),
            self.stiffness,
            self.restitution
        )
    }
}
