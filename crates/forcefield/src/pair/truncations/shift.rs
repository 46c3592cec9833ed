//! Cut and shifted.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "shift",
    in_words: "cut and shifted",
    summary: "Cut and shifted: the same forces, and a continuous energy.",
    equation: "U(r) - U(r_cut)",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, eq. 5.8",
    jumps: false,
    weights: false,
};

pub(super) fn truncation(formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Plain { shift: formula.eval(options.r_cut * options.r_cut).energy }
}
