//! The quintic switch.

use super::{Truncation, TruncationOptions, TruncationSpec};
use crate::error::ForceFieldError;
use crate::pair::Smoothstep;
use crate::pair::potentials::Formula;
use lennard_core::number::short;

pub(super) const SPEC: TruncationSpec = TruncationSpec {
    name: "switch",
    summary: "Energy, force and curvature are continuous: for energy conservation and the configurational temperature.",
    equation: "U(r) S(x), S = 1 - x^3 (10 - 15 x + 6 x^2), x = (r^2 - r_s^2)/(r_cut^2 - r_s^2) held to [0, 1]",
    source: "quintic smoothstep in r^2; switches in M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
    jumps: false,
    weights: true,
};

/// Where the switch begins if the scene does not say: this share of r_cut.
const DEFAULT_SHARE: f64 = 0.8;

/// Where the switch of these options begins, σ.
pub(super) fn begins(options: &TruncationOptions) -> f64 {
    options.switch_from.unwrap_or(DEFAULT_SHARE * options.r_cut)
}

pub(super) fn in_words(options: &TruncationOptions) -> String {
    format!(
        "switched off from {} to {}",
        short(begins(options)),
        options.length_in_words(options.r_cut)
    )
}

pub(super) fn check(options: &TruncationOptions) -> Result<(), ForceFieldError> {
    let r_cut = options.r_cut;
    match options.switch_from {
        Some(found) if !(found > 0.0 && found < r_cut) => {
            Err(ForceFieldError::BadSwitch { found, r_cut })
        }
        _ => Ok(()),
    }
}

pub(super) fn truncation(_formula: &Formula, options: &TruncationOptions) -> Truncation {
    Truncation::Switch(Smoothstep::new(begins(options), options.r_cut))
}
