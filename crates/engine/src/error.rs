//! What can go wrong with a run, sorted by whose turn it is to do something about it.

use lennard_forcefield::ForceFieldError;
use lennard_io::{FormatError, WriteError};
use lennard_scene::{SceneError, Source};

use crate::resume::ResumeError;
use crate::watchdog::PhysicsFailure;

/// Why a run did not start or did not end.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene asks for something impossible: exit code 2.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A start configuration cannot be read: exit code 2.
    #[error("cannot read the start configuration: {0}")]
    Configuration(#[from] FormatError),
    /// The output folder cannot be made or is not free: exit code 2.
    #[error(transparent)]
    Folder(lennard_io::FolderError),
    /// A file cannot be written: exit code 1.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A run cannot go on from its checkpoint: exit code 2.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// Physics stopped the run: exit code 3.
    #[error(transparent)]
    Physics(Box<PhysicsFailure>),
}

impl EngineError {
    /// The exit code of the command line: 2 for input, 3 for physics, 1 for anything else.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_) | Self::Configuration(_) | Self::Folder(_) | Self::Resume(_) => 2,
            Self::Physics(_) => 3,
            Self::Write(_) => 1,
        }
    }
}

/// A force field that does not fit, put on the line of the scene that it is about.
#[must_use]
pub fn misfit(source: &Source, error: &ForceFieldError) -> EngineError {
    source
        .invalid(error.key(), error.found(), error.allowed())
        .into()
}
