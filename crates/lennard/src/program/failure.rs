//! What a command ends with when it fails: what it was doing, what went wrong, and an exit code.

use std::path::Path;

use lennard_engine::{EngineError, again};
use lennard_io::{CheckpointFolder, FolderError, WriteError, path_in_shell};
use lennard_scene::SceneError;

/// Exit code of work that is done.
pub const DONE: u8 = 0;
/// Exit code for wrong input.
pub const INPUT: u8 = 2;
/// Exit code for anything that is neither input nor physics.
pub const OTHER: u8 = 1;

/// Exit code of work that was asked to stop and can go on.
pub const STOPPED: u8 = 4;

/// A message for standard error and an exit code.
#[derive(Debug)]
pub struct Failure {
    /// What to print.
    pub message: String,
    /// What to exit with.
    pub code: u8,
}

impl Failure {
    /// A failure while `doing` something.
    pub fn new(doing: &str, error: impl std::fmt::Display, code: u8) -> Self {
        Self { message: format!("{doing}: {error}"), code }
    }
}

impl Failure {
    /// A failure of a run under way in `folder`: where a file cannot be written, with the way to go on.
    pub fn of_run(error: EngineError, folder: &Path) -> Self {
        let checkpoints = CheckpointFolder::new(folder).list().unwrap_or_default();
        let way = match (&error, checkpoints.first()) {
            (EngineError::Write(WriteError::NotResumable { .. }), _) => {
                format!("or, {}", again(folder))
            }
            (EngineError::Write(_), Some((step, _))) => format!(
                "whole up to step {step}; to go on from there: lennard resume {}",
                path_in_shell(folder)
            ),
            (EngineError::Write(_), None) => {
                "no step is kept: give the same command again when the cause is mended".to_owned()
            }
            _ => return error.into(),
        };
        let mut failure = Self::from(error);
        failure.message += &format!("\n  {way}");
        failure
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::new("reading the scene", error, INPUT)
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        let code = error.exit_code();
        match error {
            EngineError::Scene(e) => Self::new("reading the scene", e, code),
            EngineError::Configuration(e) => Self::new("reading the start configuration", e, code),
            EngineError::Trajectory(e) => Self::new("reading the trajectory", e, code),
            EngineError::Folder(e @ FolderError::Busy { .. }) => {
                Self::new("claiming the output folder", e, code)
            }
            EngineError::Folder(e) => Self::new("making the output folder", e, code),
            EngineError::Write(e) => e.into(),
            EngineError::Memory(e) => Self::new("asking for memory", e, code),
            EngineError::Ranks(e) => Self::new("sharing the run between ranks", e, code),
            EngineError::Resume(e) => Self::new("going on with a run", e, code),
            EngineError::Physics(e) => Self { message: e.to_string(), code },
            // These come from calls of a library alone.
            e @ (EngineError::Checkpoint(_)
            | EngineError::Start(_)
            | EngineError::Begun(_)
            | EngineError::NoSuchResult { .. }
            | EngineError::Threads(_)) => Self::new("using a simulation", e, code),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        let advice = error.advice();
        Self::new("writing results", format!("{error}\n  {advice}"), OTHER)
    }
}
