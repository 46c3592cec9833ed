//! The cubic switch of X-PLOR.

use super::{Truncation, TruncationOptions, TruncationSpec, switch};
use crate::error::ForceFieldError;
use crate::pair::Smoothstep;
use crate::pair::potentials::Formula;
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

pub(super) fn truncation(_formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Xplor(Smoothstep::new(switch::begins(options), options.r_cut))
}
