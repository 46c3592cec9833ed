//! `lennard study mechanics`: constraints, springs, collisions and SPOOK, theory beside measurement, with a verdict for each
//! claim, whoever makes it.
//!
//! Each chapter adds its tables and the numbers that judge claims. The comparison goes over the list of ways to hold bonds.
//! A way that is added there is measured and drawn here without a change of this crate.

mod ball;
mod bodies;
mod collisions;
mod comparison;
mod cradle;
mod fluid;
mod maps;
mod precise;
mod relaxing;

use crate::claims::{ClaimsStudy, Measured, Text};
use crate::{FluidStudy, Progress, StudyError, StudyOptions};

/// Who claims what about bonds, collisions and SPOOK, and the page with its figures.
const TEXT: Text = Text { claims: include_str!("claims.csv"), page: include_str!("page.toml") };

/// A chapter: whether its runs are short, and where its results go.
type Chapter = fn(bool, &mut Measured) -> Result<(), StudyError>;

/// Each chapter on few bodies with its name for progress, and the share of the time that it begins at.
const CHAPTERS: [(&str, f64, Chapter); 7] = [
    ("bonds held in each way", 0.0, comparison::measure),
    ("springs against rigid bonds", 0.15, maps::model_errors),
    ("relaxation", 0.2, relaxing::measure),
    ("pendulums and chains", 0.3, precise::measure),
    ("spook", 0.35, maps::measure),
    ("collisions", 0.4, collisions::measure),
    ("pressure between walls", 0.5, fluid::pressure),
];

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work.
pub fn run(
    fluid: &FluidStudy,
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<ClaimsStudy, StudyError> {
    let mut all = Measured::default();
    for (label, share, measure) in CHAPTERS {
        progress.update(label, share);
        measure(options.quick, &mut all)?;
    }
    progress.update("fluids", 0.55);
    fluid::measure(fluid, options.quick, &mut all)?;
    progress.update("done", 1.0);
    let schema = lennard_io::schema!("mechanics", 2);
    ClaimsStudy::new(schema, TEXT, options, all, fluid.is_own)
}
