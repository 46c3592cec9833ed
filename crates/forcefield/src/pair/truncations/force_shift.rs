//! The linear force shift.

use super::{Truncation, TruncationOptions, TruncationSpec, without_switch};
use crate::error::ForceFieldError;
use crate::pair::potentials::Formula;

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

/// S. D. Stoddard and J. Ford, "Numerical experiments on the stochastic behavior of a Lennard-Jones
/// gas system", Phys. Rev. A 8 (1973) 1504; Allen and Tildesley, eq. 5.10.
pub(super) fn truncation(formula: &Formula, options: &TruncationOptions) -> Truncation {
    let r_cut = options.r_cut;
    let end = formula.eval(r_cut * r_cut);
    let slope = -end.force * r_cut;
    Truncation::ForceShift { slope, constant: end.energy - slope * r_cut }
}
