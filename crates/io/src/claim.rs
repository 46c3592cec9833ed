//! One process at a time in an output folder: a locked file with the number of the process in it.
//!
//! The operating system lets go of the lock when the process ends, however it ends. A claim file that a killed
//! process has left therefore claims nothing.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Name of the claim file in a folder; hidden, and never counted as content of the folder.
pub(crate) const CLAIM_FILE: &str = ".lennard-claim";

/// The most digits that the number of a process has, with room to spare.
const LONGEST_NUMBER: u64 = 32;

/// A folder held by this process until the value is dropped.
#[derive(Debug)]
pub(crate) struct Claim {
    path: PathBuf,
    file: File,
}

/// Why a folder cannot be claimed.
#[derive(Debug)]
pub(crate) enum Unclaimed {
    /// A process holds it; its number, where the claim file tells.
    Busy(Option<u32>),
    /// The operating system refuses.
    Io(io::Error),
}

impl Claim {
    /// Claims an existing folder. File systems without locks let every process in.
    pub(crate) fn take(folder: &Path) -> Result<Self, Unclaimed> {
        let path = folder.join(CLAIM_FILE);
        loop {
            let mut file = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
                .map_err(Unclaimed::Io)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(Unclaimed::Busy(process_in(&file))),
                // A file system without locks must not keep a run from its folder.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // The process before may have removed the file between opening and locking it.
            if !is_still(&file, &path) {
                continue;
            }
            let number = format!("{}\n", std::process::id());
            file.set_len(0)
                .and_then(|()| file.write_all(number.as_bytes()))
                .map_err(Unclaimed::Io)?;
            return Ok(Self { path, file });
        }
    }
}

impl Claim {
    /// Removes the claim file; the lock lasts until the value is dropped or the process ends.
    pub(crate) fn remove(&self) {
        // The folder may have been moved away, and another process may hold what has its name now.
        if is_still(&self.file, &self.path) {
            // A leftover does no harm: it is hidden, and claims nothing once this process has ended.
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.remove();
    }
}

/// The process that a claim file names.
fn process_in(mut file: &File) -> Option<u32> {
    let mut text = String::new();
    file.rewind().ok()?;
    file.take(LONGEST_NUMBER).read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}

/// Whether an open file is the one that the path names.
#[cfg(unix)]
fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (Ok(open), Ok(named)) = (file.metadata(), fs::symlink_metadata(path)) else {
        return false;
    };
    (open.dev(), open.ino()) == (named.dev(), named.ino())
}

/// Where files have no numbers, an open file cannot be removed either.
#[cfg(not(unix))]
fn is_still(_file: &File, path: &Path) -> bool {
    path.exists()
}
