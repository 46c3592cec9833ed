//! Why a sweep cannot be run.

use std::path::PathBuf;

use lennard_scene::SceneError;

/// Why a sweep cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The study file is wrong, or asks for what its scene cannot be.
    #[error(transparent)]
    File(#[from] SceneError),
    /// The scene of a point is wrong, and the study file is not to blame.
    #[error("point {point}: {source}")]
    Scene {
        /// Name of the point.
        point: String,
        /// What is wrong.
        source: SceneError,
    },
    /// The start of a point cannot be made.
    #[error("point {point}: {source}")]
    Start {
        /// Name of the point.
        point: String,
        /// What is wrong.
        source: Box<lennard_engine::EngineError>,
    },
    /// A folder of a point holds something else.
    #[error("{}: {found}\n  allowed: an empty folder, or what this sweep wrote there; give another --out, or --force to replace the runs of this sweep", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What it holds.
        found: String,
    },
    /// The folder of a point cannot be claimed.
    #[error(transparent)]
    Claim(#[from] lennard_io::FolderError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] lennard_io::WriteError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] crate::report::ReportError),
}
