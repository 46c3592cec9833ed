//! Cut and shifted.

use super::{Plain, TruncationSpec, without_switch};
use crate::error::ForceFieldError;
use crate::options::TruncationOptions;
use crate::pair::PairPotential;

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

pub(super) fn form<P: PairPotential>(potential: P, options: &TruncationOptions) -> Plain<P> {
    let r_cut = options.r_cut;
    Plain { potential, shift: potential.eval(r_cut * r_cut, (r_cut * r_cut).recip()).energy }
}
