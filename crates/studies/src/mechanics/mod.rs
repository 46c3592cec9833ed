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

use lennard_observables::Table;
use serde::Serialize;

use crate::claims::{Claim, Numbers};
use crate::measured::Measured;
use crate::report::{Given, Page};
use crate::{Progress, Study, StudyError, StudyOptions};

/// Who claims what about bonds, collisions and SPOOK.
const CLAIMS: &str = include_str!("claims.csv");

/// The page with its figures.
const PAGE: &str = include_str!("page.toml");

/// A chapter: whether its runs are short, and where its results go.
type Chapter = fn(bool, &mut Measured) -> Result<(), StudyError>;

/// Each chapter with its name for progress, and the share of the time that it begins at.
const CHAPTERS: [(&str, f64, Chapter); 9] = [
    ("bonds held in each way", 0.0, comparison::measure),
    ("springs against rigid bonds", 0.15, maps::model_errors),
    ("relaxation", 0.2, relaxing::measure),
    ("pendulums and chains", 0.3, precise::measure),
    ("spook", 0.35, maps::measure),
    ("collisions", 0.4, collisions::measure),
    ("pressure between walls", 0.5, fluid::pressure),
    ("drift of fluids", 0.55, fluid::drifts),
    ("equations of state", 0.75, fluid::states),
];

/// The study: what was measured, and what follows.
#[derive(Debug, Clone, Serialize)]
pub struct MechanicsStudy {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// What was asked for.
    pub options: StudyOptions,
    /// The tables with every digit.
    pub tables: Vec<Table>,
    /// What else the text of the page names.
    #[serde(skip)]
    given: Given,
    /// The numbers that judge the claims.
    numbers: Numbers,
    /// What is claimed, by whom, and whether it holds.
    pub claims: Vec<Claim>,
}

/// Runs the study.
///
/// # Errors
/// [`StudyError`] where a method fails at a place where all must work.
pub fn run(
    options: &StudyOptions,
    progress: &mut dyn Progress,
) -> Result<MechanicsStudy, StudyError> {
    let mut all = Measured::default();
    for (label, share, measure) in CHAPTERS {
        progress.update(label, share);
        measure(options.quick, &mut all)?;
    }
    progress.update("done", 1.0);
    let Measured { tables, numbers, given, .. } = all;
    Ok(MechanicsStudy {
        schema: lennard_io::schema!("mechanics", 2),
        options: options.clone(),
        claims: crate::claims::all_judged(CLAIMS, &numbers)?,
        tables,
        given,
        numbers,
    })
}

impl Study for MechanicsStudy {
    fn tables(&self) -> Vec<Table> {
        let claims = crate::claims::csv(&self.claims);
        self.tables.iter().cloned().chain([claims]).collect()
    }

    fn page(&self) -> Result<Page, StudyError> {
        let ways = self.tables.iter().find(|table| table.name == comparison::IN_A_LINE);
        let mut given = self.given.clone();
        // A table of the page alone comes first: it has every column that the page names.
        given.tables.extend_from_slice(&self.tables);
        given.words.push(("ways", ways.map_or(0, Table::rows).to_string()));
        crate::claims::page(PAGE, &self.options, &self.claims, given)
    }
}
