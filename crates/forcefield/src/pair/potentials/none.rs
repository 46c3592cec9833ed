//! No pair potential: particles do not see each other.

use super::{EndsByItself, Potential, PotentialSpec};
use crate::pair::{Pair, PairPotential};
use crate::real::Real;

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
    /// There is no way through a formula.
    const EXAMPLES: &'static [Self] = &[];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }
}

impl EndsByItself for NoPotential {
    /// No pair is ever near enough, so that nothing is searched or summed.
    const END: f64 = 0.0;
    const END_IN_WORDS: &'static str = "0";
}

impl PairPotential for NoPotential {
    const SELDOM_BENT: bool = true;

    #[inline(always)]
    fn eval<R: Real>(&self, r2: R, _inv_r2: R) -> Pair<R> {
        let zero = r2.splat(0.0);
        Pair { energy: zero, force: zero, curvature: zero }
    }

    fn tail_energy(&self, _r_cut: f64) -> f64 {
        0.0
    }

    fn tail_virial(&self, _r_cut: f64) -> f64 {
        0.0
    }
}
