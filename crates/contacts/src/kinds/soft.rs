//! Bodies that are springs where they overlap.

use lennard_forcefield::{ContactLaw, SMALLEST_SOFT_RESTITUTION, SpringLaw};

use super::{Contact, ContactSpec, Response};

lennard_core::options! {
    /// A spring between two bodies that overlap: F = k·δ or k·δ^{3/2} at the depth δ. With a restitution below 1 a dashpot takes
    /// energy, which counts as heat.
    ///
    /// Two bodies of reduced mass m that meet with the speed v reach the depth v·√(m/k) (linear) or (5m·v²/(4k))^{2/5} (Hertz)
    /// without a dashpot.
    #[derive(Copy)]
    pub struct Soft {
        /// How the force grows with the depth.
        law: SpringLaw = SpringLaw::Linear, Names(SpringLaw::names);
        /// Stiffness k; in ε/σ^{5/2} for `hertz`.
        stiffness: f64 = 1000.0, Positive, in "ε/σ²";
        /// Restitution e of a hit: it sets the dashpot. The contact never pulls. `hard` contacts take any e from 0.
        restitution: f64 = 1.0, Between(SMALLEST_SOFT_RESTITUTION, 1.0);
    }
}

impl Contact for Soft {
    const SPEC: ContactSpec = ContactSpec {
        name: "soft",
        summary: "A spring pushes bodies that overlap apart, linear or Hertzian, with a dashpot for a restitution below 1.",
        equation: "F = k d + c d' or k d^(3/2) + c d' >= 0 at depth d of the overlap; c from e and the reduced mass",
        source: "L. D. Landau and E. M. Lifshitz, Theory of Elasticity, 3rd ed. (1986), section 9: F ~ d^(3/2) for elastic spheres; the dashpot is derived here",
    };

    fn response(&self) -> Response {
        Response::Spring(ContactLaw::new(self.law, self.stiffness, self.restitution))
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
