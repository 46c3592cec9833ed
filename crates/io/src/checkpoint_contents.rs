//! What a checkpoint holds, and why one is refused.

use std::collections::BTreeMap;
use std::io;

use lennard_core::StateArchive;
use serde::{Deserialize, Serialize};

use crate::FileMark;

/// Version of the container that this program writes, and the only one that it reads.
pub const CHECKPOINT_VERSION: u32 = 1;

/// A checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// What must be known before the arrays are looked at.
    pub metadata: CheckpointMetadata,
    /// The scene as resolved, as text.
    pub scene: String,
    /// Every array, kept to the bit.
    pub archive: StateArchive,
}

/// What is known of a checkpoint before its arrays are looked at.
///
/// No floating-point number stands here: the time is in the archive, to the bit.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointMetadata {
    /// Version of the program that wrote it.
    pub program_version: String,
    /// Name of the scene.
    pub scene_name: String,
    /// Instruction set of the force kernel: another one gives other bits.
    pub isa: String,
    /// Precision of the force kernel.
    pub precision: String,
    /// Number of steps done.
    pub step: u64,
    /// How far each growing output file was written, by file name.
    pub files: BTreeMap<String, FileMark>,
}

/// What is wrong with a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointProblem {
    /// The operating system refused.
    #[error("it cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("it is not a checkpoint of this program")]
    NotACheckpoint,
    /// Another version of the container.
    #[error(
        "it has version {found} of the format; this program reads version {CHECKPOINT_VERSION}"
    )]
    OtherVersion {
        /// The version found.
        found: u32,
    },
    /// It is shorter or longer than it says.
    #[error("it has {found} bytes and should have {wanted}: it is truncated or damaged")]
    WrongLength {
        /// Bytes found.
        found: u64,
        /// Bytes that it says it has.
        wanted: u64,
    },
    /// The checksum does not fit the content.
    #[error("it is damaged: its content does not fit its checksum")]
    Damaged,
    /// The checksum fits, but the content makes no sense.
    #[error("its content makes no sense: {0}")]
    Malformed(String),
    /// There is none.
    #[error("there is no checkpoint in this folder")]
    None,
}
