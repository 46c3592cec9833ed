//! Checkpoints: everything that an exact restart needs, in one file that is whole or refused.

use std::fs::File;
use std::io::{self, BufReader, Cursor};
use std::path::{Path, PathBuf};

use lennard_core::{Own, Team};

use crate::atomic::write_atomically;
use crate::checkpoint_codec::{Checkpoint, CheckpointProblem, decode, encode, give};
use crate::lines::open_regular;
use crate::{FormatError, WriteError};

/// Why a run cannot go on from a checkpoint.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}{}", file.display(), offer(.older.as_deref()))]
pub struct CheckpointError {
    /// The checkpoint, or the folder that has none.
    pub file: PathBuf,
    /// What is wrong.
    #[source]
    pub problem: CheckpointProblem,
    /// An older checkpoint of the same run that was looked at and is whole.
    pub older: Option<PathBuf>,
}

fn offer(older: Option<&Path>) -> String {
    older.map_or_else(String::new, |path| {
        format!("; the one before it is whole: {}", path.display())
    })
}

impl CheckpointError {
    pub(crate) fn new(file: &Path, problem: CheckpointProblem) -> Self {
        Self { file: file.to_path_buf(), problem, older: None }
    }
}

/// Writes a checkpoint: to a hidden neighbor first, synced, then renamed.
///
/// # Errors
/// Where the operating system refuses; what stood at `path` before is then still there.
pub fn write_checkpoint(path: &Path, checkpoint: &Checkpoint) -> Result<(), WriteError> {
    write_checkpoint_on(path, checkpoint, &Own::all_of(0))
}

/// As [`write_checkpoint`], on rank 0 where ranks share the particles. The others call [`give_checkpoint`] meanwhile.
///
/// # Errors
/// As [`write_checkpoint`].
pub fn write_checkpoint_on(
    path: &Path,
    checkpoint: &Checkpoint,
    own: &Own,
) -> Result<(), WriteError> {
    let mut began = false;
    let written = write_atomically(path, |file| {
        began = true;
        encode(checkpoint, own, file)
    });
    if !began {
        give_checkpoint(checkpoint, own);
    }
    written
}

/// Gives rank 0 the part of a checkpoint that this rank has.
pub fn give_checkpoint(checkpoint: &Checkpoint, own: &Own) {
    give(checkpoint, own);
}

/// The bytes that [`write_checkpoint`] writes.
#[must_use]
pub fn checkpoint_bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode(checkpoint, &Own::all_of(0), &mut bytes).expect("memory takes every byte");
    bytes
}

/// Reads a checkpoint, to the bit as it was written.
///
/// # Errors
/// Where it is not a checkpoint, of another version, truncated or damaged; nothing is taken from it then.
pub fn read_checkpoint(path: &Path) -> Result<Checkpoint, CheckpointError> {
    read_checkpoint_on(path, None)
}

/// As [`read_checkpoint`]; a rank of a team takes the particles alone that it keeps.
///
/// # Errors
/// As [`read_checkpoint`].
pub fn read_checkpoint_on(path: &Path, team: Option<&Team>) -> Result<Checkpoint, CheckpointError> {
    let (reader, size): (BufReader<File>, u64) = open_regular(path).map_err(|e| {
        let cause = match e {
            FormatError::Io { source, .. } => source,
            other => io::Error::other(other),
        };
        CheckpointError::new(path, cause.into())
    })?;
    // The decoder reads in large pieces of its own.
    decode(reader.into_inner(), size, team).map_err(|p| CheckpointError::new(path, p))
}

/// Like [`read_checkpoint`], from memory.
///
/// # Errors
/// Where it is not a checkpoint, of another version, truncated or damaged.
pub fn read_checkpoint_bytes(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    decode(Cursor::new(bytes), bytes.len() as u64, None)
        .map_err(|p| CheckpointError::new(Path::new("checkpoint in memory"), p))
}
