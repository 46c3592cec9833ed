//! One point of the chart, as it is stored.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::lab::{Cost, Failed, ForceErrors, Measured, Timing, TrajectoryError};
use crate::settings::Settings;

/// What came of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome<T> {
    /// What it found.
    Found(T),
    /// Why it found nothing.
    Failed(Failed),
}

impl<T> Outcome<T> {
    /// A run that failed is a result; any other error is handed back.
    pub(super) fn of(result: Result<T, StudyError>) -> Result<Self, StudyError> {
        match result {
            Ok(found) => Ok(Self::Found(found)),
            Err(error) => Ok(Self::Failed(Failed::from_error(error)?)),
        }
    }

    /// What was found, if anything.
    pub fn found(&self) -> Option<&T> {
        match self {
            Self::Found(value) => Some(value),
            Self::Failed(_) => None,
        }
    }
}

/// A point of any chart: it is stored, measured and timed.
pub(super) trait Charted: Serialize + DeserializeOwned + Send {
    /// Its number, from 1.
    fn number(&self) -> usize;
    /// Whether a stored point is of the same settings as a fresh one.
    fn is_of(&self, fresh: &Self) -> bool;
    /// Whether all is known of it but its costs.
    fn is_measured(&self) -> bool;
    /// Whether it has `repeats` timings, or cannot be timed.
    fn is_timed(&self, repeats: usize) -> bool;
}

/// All errors of one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Of the forces at the start.
    pub forces: ForceErrors,
    /// Of energy, temperature, U and P, over a run.
    pub measured: Outcome<Measured>,
    /// Of a short trajectory.
    pub trajectory: Outcome<TrajectoryError>,
    /// Distance from the start after the way there and back, σ.
    pub reversibility: Outcome<f64>,
}

/// One choice of settings with what it costs and errs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChartedPoint {
    /// Its number on the diagrams, from 1.
    pub number: usize,
    /// Another engine, by name; absent for this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<String>,
    /// The settings in a line.
    pub label: String,
    /// The settings.
    pub settings: Settings,
    /// Pair forces for each particle and τ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pair_forces_per_atom_tau: Option<f64>,
    /// Why it could not be timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_timed: Option<Failed>,
    /// The timings so far.
    #[serde(default)]
    pub timings: Vec<Timing>,
    /// The errors, once they are measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
}

impl ChartedPoint {
    /// A point of which nothing is known yet.
    #[must_use]
    pub fn new(number: usize, settings: Settings) -> Self {
        Self {
            number,
            engine: None,
            label: settings.label(),
            settings,
            pair_forces_per_atom_tau: None,
            not_timed: None,
            timings: Vec::new(),
            errors: None,
        }
    }

    /// Its cost, once it is known.
    #[must_use]
    pub fn cost(&self) -> Option<Cost> {
        Cost::of(&self.timings, self.pair_forces_per_atom_tau?)
    }

    /// What the run measured, where it came to its end.
    #[must_use]
    pub fn measured(&self) -> Option<&Measured> {
        self.errors.as_ref()?.measured.found()
    }
}

impl Charted for ChartedPoint {
    fn number(&self) -> usize {
        self.number
    }

    fn is_of(&self, fresh: &Self) -> bool {
        self.settings == fresh.settings
    }

    fn is_measured(&self) -> bool {
        self.errors.is_some()
    }

    fn is_timed(&self, repeats: usize) -> bool {
        self.not_timed.is_some() || self.timings.len() >= repeats
    }
}
