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

pub use fluid::Fluid;

use lennard_observables::Table;
use serde::Serialize;

use crate::claims::Claim;
use crate::jobs::Part;
use crate::measured::Measured;
use crate::report::{Given, Page};
use crate::{Progress, Study, StudyError, StudyOptions};

/// Who claims what about integrators.
const CLAIMS: &str = include_str!("claims.csv");

/// The page with its figures.
const PAGE: &str = include_str!("page.toml");

/// Share of the oscillator part in the time of the whole study.
const OSCILLATOR_SHARE: f64 = 0.03;

/// Everything found.
#[derive(Debug, Clone, Serialize)]
pub struct StabilityStudy {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// What was asked for.
    pub options: StudyOptions,
    /// The tables of numbers.
    pub tables: Vec<Table>,
    /// What is claimed, by whom, and whether it holds.
    pub claims: Vec<Claim>,
    /// Tables of curves.
    #[serde(skip)]
    curves: Vec<Table>,
    /// What else the text of the page names.
    #[serde(skip)]
    given: Given,
}

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work. An unstable method, or one that refuses,
/// is a result and no error.
pub fn run(
    fluid: &Fluid,
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<StabilityStudy, StudyError> {
    let mut found = oscillator(options.quick, progress)?;
    let rest = &mut Part::of(progress, OSCILLATOR_SHARE, 1.0);
    fluid::measure(fluid, options.quick, rest, &mut found)?;
    let claims = match fluid.is_own {
        true => crate::claims::judged(CLAIMS, &found.numbers)?,
        false => crate::claims::all_judged(CLAIMS, &found.numbers)?,
    };
    progress.update("done", 1.0);
    Ok(StabilityStudy {
        schema: lennard_io::schema!("stability", 2),
        options: options.clone(),
        tables: found.tables,
        claims,
        curves: found.curves,
        given: found.given,
    })
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

impl Study for StabilityStudy {
    fn tables(&self) -> Vec<Table> {
        let mut tables = [&self.tables[..], &self.curves].concat();
        tables.push(crate::claims::csv(&self.claims));
        tables
    }

    fn page(&self) -> Result<Page, StudyError> {
        let mut given = self.given.clone();
        given.tables.extend([&self.tables[..], &self.curves].concat());
        crate::claims::page(PAGE, &self.options, &self.claims, given)
    }
}

#[cfg(test)]
mod tests;
