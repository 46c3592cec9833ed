//! No pair potential: particles do not see each other.

use super::{OwnEnd, Potential, PotentialSpec};
use crate::pair::{Pair, PairPotential, Side};

lennard_core::options! {
    /// No pair potential, U = 0: for bodies that meet in contacts alone, for chains in a field, and for the ideal gas.
    #[derive(Copy)]
    pub struct NoPotential {}
}

impl Potential for NoPotential {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "none",
        title: "no pair potential",
        summary: "No pair potential: particles meet in contacts, bonds and walls alone.",
        equation: "U = 0",
        source: "nothing to cite: without other forces it is the ideal gas",
        is_lennard_jones: false,
    };
    /// No pair is ever near enough, so that nothing is searched or summed.
    const END: Option<OwnEnd> = Some(OwnEnd { r: 0.0, in_words: "0" });
    /// There is no way through a formula.
    const EXAMPLES: &'static [Self] = &[];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }
}

impl PairPotential for NoPotential {
    fn on(&self, _side: Side, _r2: f64) -> Pair<f64> {
        Pair { energy: 0.0, force: 0.0, curvature: 0.0 }
    }

    fn tail_energy(&self, _r_cut: f64) -> f64 {
        0.0
    }

    fn tail_virial(&self, _r_cut: f64) -> f64 {
        0.0
    }
}
