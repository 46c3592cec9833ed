//! The cubic switch of X-PLOR.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::pair::Smoothstep;
use crate::pair::potentials::Formula;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "xplor",
    in_words: "switched off (xplor)",
    summary: "Energy and force are continuous: the switch that X-PLOR, HOOMD-blue and ASE use.",
    equation: "U(r) S, S = (r_cut^2 - r^2)^2 (r_cut^2 + 2 r^2 - 3 r_s^2) / (r_cut^2 - r_s^2)^3 for r > r_s, else 1",
    source: "B. R. Brooks et al., CHARMM: A program for macromolecular energy, minimization, and dynamics calculations, J. Comput. Chem. 4 (1983) 187",
    jumps: false,
    weights: true,
};

pub(super) fn truncation(_formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Xplor(Smoothstep::new(options.switch_begins(), options.r_cut))
}
