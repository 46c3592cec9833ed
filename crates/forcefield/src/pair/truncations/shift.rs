//! Cut and shifted.

use super::{Truncation, TruncationOptions, TruncationSpec, without_switch};
use crate::error::ForceFieldError;
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "shift",
    summary: "Cut and shifted: the same forces, and a continuous energy.",
    equation: "U(r) - U(r_cut)",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, eq. 5.8",
    jumps: false,
    weights: false,
};

pub(super) fn in_words(options: &TruncationOptions) -> String {
    let at = options.length_in_words(options.r_cut);
    format!("cut and shifted at {at}")
}

pub(super) fn check(options: &TruncationOptions) -> Result<(), ForceFieldError> {
    without_switch(options)
}

pub(super) fn truncation(formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Plain { shift: formula.eval(options.r_cut * options.r_cut).energy }
}
