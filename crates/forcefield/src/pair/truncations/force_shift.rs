//! The linear force shift.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "force-shift",
    in_words: "force-shifted",
    summary: "Energy and force are continuous.",
    equation: "U(r) - U(r_cut) - U'(r_cut) (r - r_cut)",
    source: "S. D. Stoddard and J. Ford, Numerical experiments on the stochastic behavior of a Lennard-Jones gas system, Phys. Rev. A 8 (1973) 1504",
    jumps: false,
    weights: false,
};

/// S. D. Stoddard and J. Ford, "Numerical experiments on the stochastic behavior of a Lennard-Jones
/// gas system", Phys. Rev. A 8 (1973) 1504; Allen and Tildesley, eq. 5.10.
pub(super) fn truncation(formula: &Formula, options: &TruncationOptions) -> Truncation {
    let r_cut = options.r_cut;
    let end = formula.eval(r_cut * r_cut);
    let slope = -end.force * r_cut;
    Truncation::ForceShift { slope, constant: end.energy - slope * r_cut }
}
