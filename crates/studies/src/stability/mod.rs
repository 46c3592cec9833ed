//! `lennard study stability`: where each integrator fails, on the oscillator and on the fluid. Theory and
//! measurement stand in one picture, with a verdict for each claim.
//!
//! Each part adds rows of tables and numbers that judge claims. The oscillator part goes over the list of integrators. A new
//! integrator of that list is measured and drawn here without a change of this crate.

mod amplification;
mod discretisation;
mod displacement;
pub(crate) mod fit;
mod fluid;
pub(crate) mod groups;
mod infinite;
pub(crate) mod map;
mod orders;
pub(crate) mod oscillator;
mod variable_step;

use crate::claims::{ClaimsStudy, Measured, Text};
use crate::jobs::Part;
use crate::{FluidStudy, Progress, StudyError, StudyOptions};

/// Who claims what about integrators, and the page with its figures.
const TEXT: Text = Text { claims: include_str!("claims.csv"), page: include_str!("page.toml") };

/// Share of the oscillator part in the time of the whole study.
const OSCILLATOR_SHARE: f64 = 0.03;

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work. An unstable method, or one that refuses,
/// is a result and no error.
pub fn run(
    fluid: &FluidStudy,
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<ClaimsStudy, StudyError> {
    let mut found = oscillator(options.quick, progress)?;
    let rest = &mut Part::of(progress, OSCILLATOR_SHARE, 1.0);
    fluid::measure(fluid, options.quick, rest, &mut found)?;
    progress.update("done", 1.0);
    let schema = lennard_io::schema!("stability", 2);
    ClaimsStudy::new(schema, TEXT, options, found, fluid.is_own)
}

/// Runs the oscillator part.
fn oscillator(quick: bool, progress: &mut dyn Progress) -> Result<Measured, StudyError> {
    let mut at = |label: &str, share: f64| progress.update(label, share * OSCILLATOR_SHARE);
    let mut found = Measured::default();
    at("amplification and limits", 0.0);
    amplification::measure(quick, &mut found)?;
    at("displacement and energy", 0.5);
    displacement::measure(&mut found)?;
    at("infinite stiffness", 0.8);
    infinite::measure(quick, &mut found)?;
    at("orders", 0.9);
    discretisation::measure(&mut found)?;
    orders::measure(quick, &mut found)?;
    Ok(found)
}

#[cfg(test)]
mod tests;
