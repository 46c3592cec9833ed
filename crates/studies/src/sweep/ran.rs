//! How far the run of one point has come.

use lennard_engine::Ending;

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

impl Ran {
    pub(super) fn of(ending: Ending) -> Self {
        match ending {
            Ending::Finished => Self::Finished,
            Ending::Stopped | Ending::OutOfTime => Self::Stopped,
        }
    }
}
