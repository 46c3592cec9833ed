//! How far the run of one point has come.

use lennard_engine::{Ending, EngineError};
use serde::Serialize;

/// What is in the folder of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    /// A finished run of the same scene.
    Finished,
    /// A run of the same scene that can go on.
    Begun,
    /// Nothing of use.
    Nothing,
}

/// How the run of one point ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Ran {
    /// It had been finished before.
    Kept,
    /// It was run to its end.
    Finished,
    /// It can go on.
    Stopped,
    /// Another process is at work there; which, in words.
    Elsewhere(String),
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

impl Ran {
    pub(super) fn of(ending: Ending) -> Self {
        match ending {
            Ending::Finished => Self::Finished,
            Ending::Stopped | Ending::OutOfTime => Self::Stopped,
        }
    }
}
