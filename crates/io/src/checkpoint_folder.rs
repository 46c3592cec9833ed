//! The checkpoints of a run: the last two are kept.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use lennard_core::{Own, Team};

use crate::{
    Checkpoint, CheckpointError, CheckpointProblem, WriteError, read_checkpoint_on,
    write_checkpoint_on,
};

/// Checkpoints kept: the newest, and one in case that is damaged.
const KEPT: usize = 2;

const BEFORE_STEP: &str = "checkpoint-";
const AFTER_STEP: &str = ".lennard";

/// The step of a checkpoint by the name of its file; `None` for any other file.
pub(crate) fn step_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix(BEFORE_STEP)?.strip_suffix(AFTER_STEP)?;
    let is_number = digits.bytes().all(|b| b.is_ascii_digit());
    is_number.then(|| digits.parse().ok())?
}

/// The folder that holds the checkpoints of a run, `checkpoint-<step>.lennard`.
#[derive(Debug, Clone)]
pub struct CheckpointFolder {
    folder: PathBuf,
}

impl CheckpointFolder {
    /// The checkpoints in `folder`, which must be there before [`Self::write`].
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf() }
    }

    /// Where the checkpoint of a step stands.
    #[must_use]
    pub fn path(&self, step: u64) -> PathBuf {
        self.folder.join(format!("{BEFORE_STEP}{step:012}{AFTER_STEP}"))
    }

    /// Steps and paths of the checkpoints that are there, newest first; they are not looked into.
    ///
    /// # Errors
    /// Where the folder cannot be read.
    pub fn list(&self) -> io::Result<Vec<(u64, PathBuf)>> {
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let path = entry?.path();
            let name = path.file_name().and_then(|name| name.to_str());
            if let Some(step) = name.and_then(step_of) {
                found.push((step, path));
            }
        }
        found.sort_by(|a, b| b.cmp(a));
        Ok(found)
    }

    /// Writes a checkpoint and, once it is on the disk, removes all but the last two. Where ranks share the particles, rank 0 does it.
    ///
    /// Checkpoints of later steps are removed too: they belong to a future that was given up when the
    /// run went on from an older one.
    ///
    /// # Errors
    /// Where the operating system refuses; the older checkpoints are then all still there.
    pub fn write(&self, checkpoint: &Checkpoint, own: &Own) -> Result<PathBuf, WriteError> {
        let step = checkpoint.metadata.step;
        let path = self.path(step);
        write_checkpoint_on(&path, checkpoint, own)?;
        if let Ok(all) = self.list() {
            let mut kept = 0;
            for (found, old) in all {
                if found <= step && kept < KEPT {
                    kept += 1;
                } else {
                    // One that cannot be removed costs room, but no run: the new one is whole.
                    let _ = fs::remove_file(old);
                }
            }
        }
        Ok(path)
    }

    /// The newest checkpoint, of which a rank of a team takes the particles alone that it keeps.
    ///
    /// # Errors
    /// Where there is none, or the newest one is refused: the error then says why and names the older
    /// one, if that is whole. It is not taken silently, since steps would be lost.
    pub fn load_newest(
        &self,
        team: Option<&Team>,
    ) -> Result<(PathBuf, Checkpoint), CheckpointError> {
        let none = |problem| CheckpointError::new(&self.folder, problem);
        let all = self.list().map_err(|e| none(e.into()))?;
        let Some((_, newest)) = all.first() else {
            return Err(none(CheckpointProblem::None));
        };
        match read_checkpoint_on(newest, team) {
            Ok(checkpoint) => Ok((newest.clone(), checkpoint)),
            Err(error) => Err(CheckpointError {
                older: all[1..]
                    .iter()
                    .map(|(_, path)| path)
                    .find(|path| read_checkpoint_on(path, team).is_ok())
                    .cloned(),
                ..error
            }),
        }
    }
}
