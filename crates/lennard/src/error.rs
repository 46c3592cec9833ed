//! What can go wrong.

use std::fmt;

use lennard_core::parallel::PoolError;
use lennard_engine::{EngineError, StartError};
use lennard_io::CheckpointError;
use lennard_scene::SceneError;

/// A result, or what went wrong.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a simulation cannot be made, run, saved or asked.
///
/// Its `Debug` form is the message too, so that a `main` that returns it prints what a reader understands.
#[derive(thiserror::Error)]
pub enum Error {
    /// The scene is wrong, physics stopped the run, or a file cannot be read or written.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A saved simulation cannot be read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Arrays are no start.
    #[error(transparent)]
    Start(#[from] StartError),
    /// The run has no such mean or table.
    #[error("the run has no {kind} `{name}`\n  allowed: {known}{}", hint(.nearest))]
    NoSuchResult {
        /// `average` or `table`.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: String,
        /// The nearest of them.
        nearest: Option<String>,
    },
    /// A folder holds whole runs.
    #[error(
        "a folder takes a whole run, and this simulation has done {0} steps\n  allowed: a new simulation of the same scene"
    )]
    Begun(u64),
    /// There is no pool of so many threads.
    #[error("starting threads: {0}")]
    Threads(#[from] PoolError),
}

fn hint(nearest: &Option<String>) -> String {
    let line = |name| format!("\n  nearest: {name}");
    nearest.as_ref().map_or_else(String::new, line)
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        Self::Engine(error.into())
    }
}
