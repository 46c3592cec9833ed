//! The linear force shift.

use super::{TruncationSpec, without_switch};
use crate::error::ForceFieldError;
use crate::options::TruncationOptions;
use crate::pair::{Constants, Pair, PairForm, PairPotential};
use crate::real::Real;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "force-shift",
    summary: "Energy and force are continuous.",
    equation: "U(r) - U(r_cut) - U'(r_cut) (r - r_cut)",
    source: "S. D. Stoddard and J. Ford, Numerical experiments on the stochastic behavior of a Lennard-Jones gas system, Phys. Rev. A 8 (1973) 1504",
    jumps: false,
    weights: false,
};

pub(super) fn in_words(options: &TruncationOptions) -> String {
    let at = options.length_in_words(options.r_cut);
    format!("force-shifted at {at}")
}

pub(super) fn check(options: &TruncationOptions) -> Result<(), ForceFieldError> {
    without_switch(options)
}

pub(super) fn form<P: PairPotential>(potential: P, options: &TruncationOptions) -> ForceShift<P> {
    ForceShift::new(potential, options.r_cut)
}

/// Linear force shift: U − U(r_cut) − U′(r_cut)·(r − r_cut), so that −U′/r becomes −U′/r + U′(r_cut)/r.
///
/// S. D. Stoddard and J. Ford, "Numerical experiments on the stochastic behavior of a Lennard-Jones
/// gas system", Phys. Rev. A 8 (1973) 1504; Allen and Tildesley, eq. 5.10.
#[derive(Clone, Copy, Debug)]
pub struct ForceShift<P> {
    potential: P,
    /// U′(r_cut), in units of the potential and σ.
    slope: f64,
    /// U(r_cut) − U′(r_cut)·r_cut, in units of the potential.
    constant: f64,
}

impl<P: PairPotential> ForceShift<P> {
    /// Shifts energy and force to zero at `r_cut` σ.
    pub fn new(potential: P, r_cut: f64) -> Self {
        let end = potential.eval(r_cut * r_cut, (r_cut * r_cut).recip());
        let slope = -end.force * r_cut;
        Self { potential, slope, constant: end.energy - slope * r_cut }
    }
}

impl<P: PairPotential> PairForm for ForceShift<P> {
    const RARE: bool = P::SELDOM_BENT;
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn constants(&self) -> Constants<f64> {
        [self.slope, self.constant]
    }
    #[inline(always)]
    fn eval_with<R: Real>(&self, [slope, constant]: Constants<R>, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.potential.eval(r2, inv_r2);
        let r = r2.sqrt();
        Pair {
            energy: pair.energy - r.mul_add(slope, constant),
            force: inv_r2.sqrt().mul_add(slope, pair.force),
            curvature: pair.curvature,
        }
    }
}
