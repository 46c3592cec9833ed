//! Bodies that bounce off each other in flight.

use super::{ContactKind, ContactSpec, Response};

lennard_core::options! {
    /// Hard spheres: where two meet in flight, their relative normal velocity becomes −e times itself. Impacts follow each other in
    /// the order of time, one after the other where several fall together.
    ///
    /// Between kicks the motion is exact. For e = 1, drift and kicks are exact flows, so that the step stays symplectic.
    #[derive(Copy)]
    pub struct Options {
        /// Restitution e: the share of the relative normal speed that two bodies keep. Below 1 impacts take energy out, which counts as heat.
        restitution: f64 = 1.0, Between(0.0, 1.0);
    }
}

/// What this kind declares about itself.
pub const SPEC: ContactSpec = ContactSpec {
    name: "hard",
    summary: "Hard spheres that bounce in flight, each impact at its time.",
    equation: "n.(v_j - v_i) -> -e n.(v_j - v_i) where r_ij = diameter",
    source: "B. J. Alder and T. E. Wainwright, Studies in molecular dynamics. I. General method, J. Chem. Phys. 31, 459 (1959): the flight from impact to impact; kicks of other forces stand between flights",
};

impl ContactKind for Options {
    fn response(&self) -> Response {
        Response::Impact { restitution: self.restitution }
    }

    fn in_words(&self) -> String {
        format!("hard contacts, restitution {}", self.restitution)
    }
}
