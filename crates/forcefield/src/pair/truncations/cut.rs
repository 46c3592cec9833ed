//! The plain cutoff.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "cut",
    in_words: "cut",
    summary: "The potential as it is up to r_cut; the energy jumps there, and a tail correction may be added to means.",
    equation: "U(r) for r <= r_cut, else 0",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
    jumps: true,
    weights: false,
};

pub(super) fn truncation(_formula: &Formula, _options: &TruncationOptions) -> Truncation {
    Truncation::Plain { shift: 0.0 }
}
