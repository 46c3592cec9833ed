//! The sections of the page about the fluid.

use lennard_report::{Block, PageFigure, Section};

use super::figures::FluidFigures;
use super::limit::{ALLOWED_CHANGE, LEAST_STEPS, LEAST_TIME};
use super::{FluidStudy, fluid, tables};
use crate::StudyError;
use crate::files::Captioned;

fn on_page(figures: &[Captioned], command: &str) -> Result<Block, StudyError> {
    let figures: Result<Vec<PageFigure>, StudyError> =
        figures.iter().map(|f| f.on_page(command)).collect();
    Ok(Block::Figures(figures?))
}

/// The sections of the fluid part.
pub(crate) fn sections(
    study: &FluidStudy,
    figures: &FluidFigures,
    command: &str,
) -> Result<Vec<Section>, StudyError> {
    let left_out: Vec<String> = study
        .left_out
        .iter()
        .map(|(name, reason)| format!("Left out: `{name}`: {reason}."))
        .collect();
    Ok(vec![
        Section::new("The fluid: energy and temperature against dt")
            .text(format!(
                "The same methods on the Lennard-Jones fluid: {} atoms at ρ* = {}, cutoff {} σ, from one \
                 equilibrated configuration for each state point and truncation, at constant energy. Methods \
                 that are one map on the oscillator run alike here too, and one of them is drawn for all; \
                 `fluid.csv` has every run.",
                fluid::ATOMS,
                fluid::DENSITY,
                fluid::R_CUT
            ))
            .with(Block::List(left_out))
            .with(on_page(&figures.energy, command)?)
            .with(Block::Table(tables::cost_on_page(study, command)))
            .with(Block::Heading("How the potential ends".into()))
            .with(on_page(&figures.truncations, command)?),
        Section::new("The fluid: largest stable steps")
            .text(format!(
                "A step is called stable if a run of {LEAST_TIME} τ, and of {LEAST_STEPS} steps at least, \
                 reaches its end and has changed its total energy by less than {} % of the kinetic energy \
                 3/2·T an atom. The limit is bracketed by a search and bisected in the logarithm to 2 %. On \
                 a chaotic system it is no sharp number: longer runs and other starts move it by a few \
                 percent. For methods that heat or cool at every step, such as both plain Euler methods, it \
                 says how fast they do.",
                ALLOWED_CHANGE * 100.0
            ))
            .with(on_page(&figures.limits, command)?)
            .with(Block::Table(tables::limits_on_page(study, command)))
            .with(Block::Heading("Past the limit".into()))
            .with(Block::Table(tables::past_on_page(study, command)))
            .with(Block::Heading("Very small steps".into()))
            .with(on_page(&figures.floors, command)?),
    ])
}
