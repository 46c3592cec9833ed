//! The quintic switch.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::pair::Smoothstep;
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "switch",
    in_words: "switched off",
    summary: "Energy, force and curvature are continuous: for energy conservation and the configurational temperature.",
    equation: "U(r) S(x), S = 1 - x^3 (10 - 15 x + 6 x^2), x = (r^2 - r_s^2)/(r_cut^2 - r_s^2) held to [0, 1]",
    source: "quintic smoothstep in r^2; switches in M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
    jumps: false,
    weights: true,
};

pub(super) fn truncation(_formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Switch(Smoothstep::new(options.switch_begins(), options.r_cut))
}
