//! The sections of the page about the fluid.

use crate::report::Section;

use super::limit::{ALLOWED_CHANGE, LEAST_STEPS, LEAST_TIME};
use super::study::FluidStudy;
use super::{figures, start, tables};

/// The sections of the fluid part.
pub(crate) fn sections(study: &FluidStudy) -> Vec<Section> {
    let left_out: Vec<String> = study
        .left_out
        .iter()
        .map(|(name, reason)| format!("Left out: `{name}`: {reason}."))
        .collect();
    vec![
        Section::new("The fluid: energy and temperature against dt")
            .text(format!(
                "The same methods on the Lennard-Jones fluid: {} atoms at ρ* = {}, cutoff {} σ, from one \
                 equilibrated configuration for each state point and truncation, at constant energy. Methods \
                 that are one map on the oscillator run alike here too, and one of them is drawn for all; \
                 `fluid.csv` has every run.",
                start::ATOMS,
                start::DENSITY,
                start::R_CUT
            ))
            .list(left_out)
            .figures(figures::energy(study))
            .table(tables::cost_on_page(study))
            .heading("How the potential ends")
            .figures(figures::truncations(study)),
        Section::new("The fluid: largest stable steps")
            .text(format!(
                "A step is stable if a run reaches its end and has changed its total energy by \
                 less than {} % of the kinetic energy 3/2·T per atom. The run lasts {LEAST_TIME} τ, and \
                 {LEAST_STEPS} steps at least. The limit is bracketed by a search and bisected in the logarithm to 2 %. On \
                 a chaotic system it is no sharp number: longer runs and other starts move it by a few \
                 percent. For methods that heat or cool at every step, such as both plain Euler methods, it \
                 says how fast they do.",
                ALLOWED_CHANGE * 100.0
            ))
            .figures(figures::limits(study).into_iter().collect())
            .table(tables::limits_on_page(study))
            .heading("Past the limit")
            .table(tables::past_on_page(study))
            .heading("Very small steps")
            .figures(figures::floors(study).into_iter().collect()),
    ]
}
