//! One point of the chart, as it is stored.

use serde::{Deserialize, Serialize};

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
    /// What was found, if anything.
    pub fn found(&self) -> Option<&T> {
        match self {
            Self::Found(value) => Some(value),
            Self::Failed(_) => None,
        }
    }
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

    /// Whether the point has `repeats` timings, or cannot be timed.
    #[must_use]
    pub fn is_timed(&self, repeats: usize) -> bool {
        self.not_timed.is_some() || self.timings.len() >= repeats
    }

    /// What the run measured, where it came to its end.
    #[must_use]
    pub fn measured(&self) -> Option<&Measured> {
        self.errors.as_ref()?.measured.found()
    }
}
