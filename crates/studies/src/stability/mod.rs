//! `lennard study stability`: where each integrator fails, on the oscillator and on the fluid. Theory and
//! measurement stand in one picture, with a verdict for each claim.
//!
//! The oscillator part goes over the list of integrators. A new integrator of that list is measured and drawn
//! here without a change of this crate.

pub mod amplification;
pub mod discretisation;
pub mod displacement;
pub(crate) mod fit;
pub mod fluid;
pub mod groups;
pub mod infinite;
pub(crate) mod map;
mod numbers;
pub mod orders;
pub(crate) mod oscillator;
mod study;
mod tables;
pub mod variable_step;

use lennard_observables::Table;

pub use study::{OscillatorStudy, StabilityStudy};

use crate::progress::Part;
use crate::report::Page;
use crate::{Progress, Study, StudyError, StudyOptions};

/// Who claims what about integrators.
const CLAIMS: &str = include_str!("claims.csv");

/// The page with its figures.
const PAGE: &str = include_str!("page.toml");

/// Share of the oscillator part in the time of the whole study.
const OSCILLATOR_SHARE: f64 = 0.03;

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work. An unstable method, or one that refuses,
/// is a result and no error.
pub fn run(
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<StabilityStudy, StudyError> {
    let oscillator = oscillator(options.quick, progress)?;
    let fluid = fluid::measure(options.quick, &mut Part::of(progress, OSCILLATOR_SHARE, 1.0))?;
    let mut numbers = numbers::on_the_oscillator(&oscillator)?;
    numbers::on_the_fluid(&fluid, &mut numbers);
    let claims = crate::claims::all_judged(CLAIMS, &numbers)?;
    progress.update("done", 1.0);
    Ok(StabilityStudy {
        schema: lennard_io::schema!("stability", 1),
        options: options.clone(),
        oscillator,
        fluid,
        claims,
    })
}

/// Runs the oscillator part.
fn oscillator(quick: bool, progress: &mut dyn Progress) -> Result<OscillatorStudy, StudyError> {
    let mut at = |label: &str, share: f64| progress.update(label, share * OSCILLATOR_SHARE);
    at("amplification and limits", 0.0);
    let groups = groups::groups();
    let methods = amplification::measure(&groups, quick)?;
    at("displacement and energy", 0.5);
    let cases = displacement::measure(&groups)?;
    at("infinite stiffness", 0.8);
    let infinite = infinite::measure(quick)?;
    at("orders", 0.9);
    Ok(OscillatorStudy {
        methods,
        cases,
        infinite,
        growth: discretisation::measure()?,
        step_rules: variable_step::measure()?,
        refused_changes: variable_step::refused_changes()?,
        orders: orders::measure(&groups, quick)?,
        groups,
    })
}

impl Study for StabilityStudy {
    fn tables(&self) -> Vec<Table> {
        let mut tables = tables::csv(&self.oscillator);
        tables.extend(fluid::csv(&self.fluid));
        tables.push(crate::claims::csv(&self.claims));
        tables
    }

    fn page(&self) -> Result<Page, StudyError> {
        let mut given = tables::given(&self.oscillator);
        fluid::give(&self.fluid, &mut given);
        crate::claims::page(PAGE, &self.options, &self.claims, given)
    }
}

#[cfg(test)]
mod tests;
