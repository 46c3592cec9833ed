//! Why a study fails. That a method fails at a step is no failure of a study: it is a result.

use crate::report::ReportError;
use lennard_core::StepError;
use lennard_core::parallel::PoolError;
use lennard_forcefield::ForceFieldError;
use lennard_io::WriteError;
use lennard_scene::SceneError;

/// Why a study fails.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A method failed where every method must work.
    #[error("`{method}` failed at dt = {dt}: {source}")]
    Step {
        /// Name of the method.
        method: &'static str,
        /// The step.
        dt: f64,
        /// What happened.
        source: StepError,
    },
    /// The list of integrators lacks a method that the study is about.
    #[error("the list of integrators has no `{0}`")]
    NoSuchMethod(&'static str),
    /// A box that a study makes itself is no box.
    #[error("a box of the study: {0}")]
    Box(#[from] lennard_core::BoxError),
    /// Forces that a study makes itself cannot be built.
    #[error("forces of the study: {0}")]
    ForceField(#[from] ForceFieldError),
    /// A scene, or a setting laid over it, is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Settings that do not go together, or what was asked for in vain.
    #[error("{label}: {reason}")]
    Settings {
        /// The settings in a line, or what they stand in.
        label: String,
        /// What is wrong with them.
        reason: String,
    },
    /// A run of the scene cannot be built or fails.
    #[error(transparent)]
    Engine(#[from] lennard_engine::EngineError),
    /// The forces cannot be evaluated where a run starts.
    #[error("the forces of {label}: {source}")]
    Force {
        /// The settings in a line.
        label: String,
        /// What happened.
        source: lennard_core::ForceError,
    },
    /// Forces failed while they were timed, or at the end of a run.
    #[error("the forces failed: {0}")]
    Forces(#[from] lennard_core::ForceError),
    /// A run that must not fail did, or nothing is left to choose among.
    #[error("{0}")]
    Nothing(String),
    /// There is no pool of so many threads.
    #[error("starting threads: {0}")]
    Threads(#[from] PoolError),
    /// The file with the claims of a study is no table of claims.
    #[error("the table of claims: {0}")]
    Claims(#[from] csv::Error),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The output folder cannot be made.
    #[error("cannot create the folder {path}: {source}")]
    Folder {
        /// The folder.
        path: String,
        /// What the operating system said.
        source: std::io::Error,
    },
}
