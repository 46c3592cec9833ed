//! What came of the points of a study.

use lennard_engine::EngineError;
use lennard_io::RunRecord;
use serde::Serialize;

use super::{LeftOut, Setting, Sweep};
use crate::compare::{ComparedRun, Row, StateOfMatter};
use crate::readings::Blocks;

/// How a sweep ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Every point is finished.
    Finished,
    /// It was asked to stop; the same command goes on.
    Stopped,
    /// What was there was collected, and some points are not finished.
    Incomplete,
    /// It was asked to stop before any point had a step that could be kept; nothing was written.
    NotBegun,
    /// Other processes are at work on some points.
    Elsewhere,
    /// Some points failed, or do not prove what they are to prove.
    Failed,
}

/// Why a point has no result; a record holds the reason alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Failed {
    /// What happened, in words.
    pub reason: String,
    /// The exit code that `lennard run` has for it.
    pub exit_code: u8,
}

impl Failed {
    /// What the user can set right.
    pub(super) fn of_input(reason: String) -> Self {
        Self { reason, exit_code: 2 }
    }

    /// What is neither input nor physics.
    pub(super) fn otherwise(error: &dyn std::fmt::Display) -> Self {
        Self { reason: error.to_string(), exit_code: 1 }
    }
}

impl From<EngineError> for Failed {
    fn from(error: EngineError) -> Self {
        Self { reason: error.to_string(), exit_code: error.exit_code() }
    }
}

impl From<Failed> for String {
    fn from(failed: Failed) -> Self {
        failed.reason
    }
}

/// A point and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweptPoint {
    /// Its name and the name of its folder.
    pub name: String,
    /// What the study chose for it, without the seed.
    pub settings: Vec<Setting>,
    /// Its page, relative to the folder of the sweep; `None` where it has none.
    pub page: Option<String>,
    /// Where it was to lie: density and temperature asked for.
    pub planned: StateOfMatter,
    /// Whether it had been finished before, and was not run again.
    pub kept: bool,
    /// Why it has no result, where it has none.
    pub failure: Option<Failed>,
    /// The process that is at work on it, where that is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elsewhere: Option<String>,
    /// The run beside the literature.
    pub compared: Option<ComparedRun>,
    /// The record of the run, which has every mean.
    #[serde(skip)]
    pub record: Option<RunRecord>,
    /// Wall time of the run in s.
    pub wall_s: f64,
    /// Wall time for each particle and step in ns.
    pub ns_per_atom_step: f64,
}

impl SweptPoint {
    /// A point of which nothing came yet.
    pub(crate) fn not_run(name: &str, settings: Vec<Setting>, planned: StateOfMatter) -> Self {
        Self {
            name: name.to_owned(),
            settings,
            page: None,
            planned,
            kept: false,
            failure: None,
            elsewhere: None,
            compared: None,
            record: None,
            wall_s: f64::NAN,
            ns_per_atom_step: f64::NAN,
        }
    }

    /// Whether it has neither a result nor a failure.
    #[must_use]
    pub fn is_unfinished(&self) -> bool {
        self.compared.is_none() && self.failure.is_none() && self.elsewhere.is_none()
    }

    /// One quantity of the run beside the literature, where there is one.
    pub(crate) fn row(&self, quantity: &str) -> Option<&Row> {
        let rows = &self.compared.as_ref()?.rows;
        rows.iter().find(|r| r.quantity == quantity)
    }

    /// The measured state, or the state that was asked for.
    #[must_use]
    pub fn state(&self) -> &StateOfMatter {
        self.compared.as_ref().map_or(&self.planned, |c| &c.state)
    }
}

/// What a reading is given: the points of a study, planned and run.
#[derive(Clone, Copy)]
pub struct StudyPoints<'a> {
    /// The study.
    pub sweep: &'a Sweep,
    /// What came of each point.
    pub swept: &'a [SweptPoint],
    /// Names of figures that other readings have drawn.
    pub drawn: &'a [&'a str],
}

/// A sweep and what came of it, as written to `sweep.json`.
#[derive(Debug, Clone, Serialize)]
pub struct SweepRecord {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the sweep.
    pub name: String,
    /// How it ended.
    pub ending: Ending,
    /// Version of the program.
    pub version: &'static str,
    /// The processor.
    pub cpu: String,
    /// Threads for all points together.
    pub threads: usize,
    /// Point by point.
    pub points: Vec<SweptPoint>,
    /// Points that do not fit the scene, with the reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOut>,
    /// What the readings made of the points.
    #[serde(flatten)]
    pub found: Blocks,
}
