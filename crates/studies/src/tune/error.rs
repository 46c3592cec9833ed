//! Why no settings are found.

use lennard_engine::EngineError;
use lennard_scene::SceneError;

use crate::StudyError;

/// Why no settings are found.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// The scene asks for no accuracy.
    #[error(
        "{0}: there is no `accuracy` to tune for\n  found:   a scene with settings of its own\n  \
         allowed: a scene with `accuracy = {{ potential_energy = 1e-3, pressure = 5e-3, drift = 1e-5 }}`, or some of these"
    )]
    NoAccuracy(String),
    /// The scene cannot be built, or its accuracy cannot be met.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A run of the survey failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A measurement on the workbench failed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The forces cannot be evaluated.
    #[error("the forces of the sample: {0}")]
    Force(String),
    /// A run that must not fail did.
    #[error("{0}")]
    Nothing(String),
}
