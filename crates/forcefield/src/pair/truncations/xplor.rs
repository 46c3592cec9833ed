//! The cubic switch of X-PLOR.

use super::{TruncationSpec, switch};
use crate::error::ForceFieldError;
use crate::options::TruncationOptions;
use crate::pair::smoothstep::{Smoothstep, weighted};
use crate::pair::{Constants, Pair, PairForm, PairPotential};
use crate::real::Real;
use lennard_core::number::short;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "xplor",
    summary: "Energy and force are continuous: the switch that X-PLOR, HOOMD-blue and ASE use.",
    equation: "U(r) S, S = (r_cut^2 - r^2)^2 (r_cut^2 + 2 r^2 - 3 r_s^2) / (r_cut^2 - r_s^2)^3 for r > r_s, else 1",
    source: "B. R. Brooks et al., CHARMM: A program for macromolecular energy, minimization, and dynamics calculations, J. Comput. Chem. 4 (1983) 187",
    jumps: false,
    weights: true,
};

pub(super) fn in_words(options: &TruncationOptions) -> String {
    format!(
        "switched off (xplor) from {} to {}",
        short(switch::begins(options)),
        options.length_in_words(options.r_cut)
    )
}

pub(super) fn check(options: &TruncationOptions) -> Result<(), ForceFieldError> {
    switch::check(options)
}

pub(super) fn form<P: PairPotential>(potential: P, options: &TruncationOptions) -> Xplor<P> {
    Xplor { potential, step: Smoothstep::new(switch::begins(options), options.r_cut) }
}

/// U·S(r²) with a cubic [`Smoothstep`] that ends at r_cut: energy and force are continuous, the curvature jumps at both ends.
#[derive(Clone, Copy, Debug)]
pub struct Xplor<P> {
    /// The potential.
    potential: P,
    /// The switch.
    step: Smoothstep,
}

impl<P: PairPotential> PairForm for Xplor<P> {
    const RARE: bool = true;
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn constants(&self) -> Constants<f64> {
        self.step.constants()
    }
    #[inline(always)]
    fn eval_with<R: Real>(&self, step: Constants<R>, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.potential.eval(r2, inv_r2);
        weighted(pair, Smoothstep::cubic_with(step, r2), r2)
    }
}
