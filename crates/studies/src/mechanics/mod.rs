//! `lennard study mechanics`: constraints, springs, collisions and SPOOK, theory beside measurement, with a verdict for each
//! claim, whoever makes it.
//!
//! The comparison goes over the list of ways to hold bonds. A way that is added there is measured and drawn here without a
//! change of this crate.

mod ball;
mod bodies;
pub mod collisions;
pub mod comparison;
pub mod cradle;
pub mod fluid;
pub mod maps;
mod numbers;
pub mod precise;
pub mod pressure;
pub mod relaxing;
mod study;
mod tables;
pub mod unilateral;
mod ways;

use lennard_observables::Table;

pub use study::{MechanicsMeasurements, MechanicsStudy};

use crate::report::Page;
use crate::{Progress, Study, StudyError, StudyOptions};

/// Who claims what about bonds, collisions and SPOOK.
const CLAIMS: &str = include_str!("claims.csv");

/// The page with its figures.
const PAGE: &str = include_str!("page.toml");

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work.
pub fn run(
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<MechanicsStudy, StudyError> {
    let quick = options.quick;
    let mut at = |label: &str, share: f64| progress.update(label, share);
    at("bonds held in each way", 0.0);
    let ways = comparison::measure(quick)?;
    at("springs against rigid bonds", 0.15);
    let model_errors = maps::model_errors(quick)?;
    at("relaxation", 0.2);
    let relaxing = relaxing::measure(quick)?;
    at("pendulums and chains", 0.3);
    let solved = precise::measure(quick)?;
    at("spook", 0.35);
    let maps = maps::measure()?;
    at("collisions", 0.4);
    let collisions = collisions::measure(quick)?;
    at("pressure between walls", 0.5);
    let pressure = pressure::measure(quick)?;
    at("drift of fluids", 0.55);
    let drifts = fluid::drifts(quick)?;
    at("equations of state", 0.75);
    let states = fluid::states(quick)?;
    at("done", 1.0);
    let found = MechanicsMeasurements {
        is_quick: quick,
        ways,
        model_errors,
        relaxing,
        solved,
        maps,
        collisions,
        drifts,
        states,
        pressure,
    };
    let claims = crate::claims::all_judged(CLAIMS, &numbers::numbers(&found))?;
    Ok(MechanicsStudy {
        schema: lennard_io::schema!("mechanics", 1),
        options: options.clone(),
        claims,
        found,
    })
}

impl Study for MechanicsStudy {
    fn tables(&self) -> Vec<Table> {
        let mut tables = tables::csv(&self.found);
        tables.push(crate::claims::csv(&self.claims));
        tables
    }

    fn page(&self) -> Result<Page, StudyError> {
        crate::claims::page(PAGE, &self.options, &self.claims, tables::given(&self.found))
    }
}
