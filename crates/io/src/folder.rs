//! The output folder of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::TrajectoryFormat;
use crate::atomic::{close, whole_name};
use crate::checkpoint_folder::step_of;
use crate::claim::Holder;
use crate::claim::{Claim, Unclaimed, is_of_claim};
use crate::error::advice_for;
use crate::record::tables_in;

/// What to do with an output folder that is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse it, unless it is empty.
    Refuse,
    /// Use it. Where it holds a run (a `run.json` or a checkpoint), the files of that run are removed first. No old file
    /// can then be taken for a result of the new run. Files that no run wrote are left alone.
    Replace,
    /// Use it and leave alone what is in it, for work that goes on where it was stopped.
    Keep,
}

/// Why there is no output folder.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// It is there already and holds something.
    #[error("the output folder {} exists and is not empty; allowed: a folder that is not there yet or is empty, or --force to replace the run in it", path.display())]
    Exists {
        /// The folder.
        path: PathBuf,
    },
    /// A file stands there.
    #[error("the output folder {} is a file; allowed: a folder that is not there yet", path.display())]
    NotAFolder {
        /// The path.
        path: PathBuf,
    },
    /// A process is at work there.
    #[error("the output folder {} is in use: {} is at work there\n  allowed: another folder, or this one when that process has ended", path.display(), name_of(holder.as_ref()))]
    Busy {
        /// The folder.
        path: PathBuf,
        /// The process, where it is known.
        holder: Option<Holder>,
    },
    /// Another process has begun there.
    #[error("the output folder {} is lost: this process slept for minutes, and another one has begun there\n  allowed: one process in a folder; the other one goes on", path.display())]
    Lost {
        /// The folder.
        path: PathBuf,
    },
    /// The operating system refuses.
    #[error("the output folder {} cannot be {action}: {source}; {}", path.display(), advice_for(source.kind()))]
    Io {
        /// The folder.
        path: PathBuf,
        /// What was tried (`made`, `written to`).
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
}

fn name_of(holder: Option<&Holder>) -> String {
    holder.map_or_else(|| "another process".to_owned(), ToString::to_string)
}

/// The record of a run.
const RECORD: &str = "run.json";

/// Files that any run may write, beside trajectories, checkpoints and the tables that its record lists.
const OF_ANY_RUN: [&str; 9] = [
    RECORD,
    "scene.toml",
    "thermo.csv",
    "topology.gro",
    "final.xyz",
    "failed.xyz",
    "before-failure.xyz",
    "report.html",
    "particles.svg",
];

/// Whether a file of this name is of a run whose record lists these tables, whole or half written.
fn is_of_run(file: &Path, tables: &[String]) -> bool {
    let Some(name) = file.file_name().and_then(|name| name.to_str()) else {
        return false;
    };
    let whole = whole_name(name).unwrap_or(name);
    let mut trajectories = TrajectoryFormat::ALL.iter().map(|format| format.spec().file);
    OF_ANY_RUN.contains(&whole)
        || step_of(whole).is_some()
        || trajectories.any(|trajectory| trajectory == whole)
        || tables.iter().any(|table| table == whole)
}

fn fail(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_path_buf();
    move |source| FolderError::Io { path, action, source }
}

/// An output folder that this process holds: no other one can begin there until the value is dropped.
///
/// A folder that was made for it and is still empty then is removed again.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// Folders that were made on the way, the innermost first.
    made: Vec<PathBuf>,
    claim: Claim,
    /// What it held when this process began there.
    before: Vec<PathBuf>,
}

impl OutputFolder {
    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The tables that the record of the run in the folder lists; none where there is no record.
    #[must_use]
    pub fn tables(&self) -> Vec<String> {
        tables_in(&self.path.join(RECORD))
    }

    /// Removes the files of the run that the folder holds, where it holds one; anything else is left alone.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn remove_run(&mut self) -> Result<(), FolderError> {
        let path = &self.path;
        let files = content(path).map_err(fail(path, "read"))?;
        let name = |file: &PathBuf| file.file_name()?.to_str().map(str::to_owned);
        let mut names = files.iter().filter_map(name);
        if names.any(|name| name == RECORD || step_of(&name).is_some()) {
            let tables = self.tables();
            for file in files.iter().filter(|file| is_of_run(file, &tables)) {
                if file.is_file() {
                    fs::remove_file(file).map_err(fail(path, "emptied"))?;
                }
            }
            self.before = content(path).map_err(fail(path, "read"))?;
        }
        Ok(())
    }

    /// Removes what a killed process of a run left half written.
    pub fn remove_half_written(&self) {
        let tables = self.tables();
        for file in content(&self.path).unwrap_or_default() {
            let name = file.file_name().and_then(|name| name.to_str());
            if name.and_then(whole_name).is_some() && is_of_run(&file, &tables) {
                // One that cannot be removed does no harm: it is hidden, and no reader takes it.
                let _ = fs::remove_file(file);
            }
        }
    }

    /// Leaves the folder of a run without a kept step. It removes the files of the run, and lets nothing be
    /// written there any more.
    pub fn abandon(&self) {
        close(&self.path);
        let tables = self.tables();
        let written = content(&self.path).unwrap_or_default();
        let new = |file: &&PathBuf| !self.before.contains(file) && is_of_run(file, &tables);
        for file in written.iter().filter(new) {
            // One that cannot be removed is seen to be of a run without a step.
            let _ = fs::remove_file(file);
        }
        self.leave();
    }

    /// Refuses to go on where another process has taken the folder over.
    ///
    /// # Errors
    /// [`FolderError::Lost`], within half a minute after it happened.
    pub fn still_held(&self) -> Result<(), FolderError> {
        if self.claim.is_lost() {
            return Err(FolderError::Lost { path: self.path.clone() });
        }
        Ok(())
    }

    /// Removes the claim, and the folders that were made for it as far as they are empty: for a process that is about
    /// to end. Dropping the value does the same.
    pub fn leave(&self) {
        self.claim.remove();
        remove_empty(&self.made);
    }

    /// Makes the folder where it is not there, and claims it before anything else is done there.
    fn claimed(path: &Path) -> Result<Self, FolderError> {
        /// Attempts while another process removes the folder again and again.
        const ATTEMPTS: usize = 100;
        let mut attempt = 0;
        loop {
            attempt += 1;
            let made = missing_folders(path)?;
            fs::create_dir_all(path).map_err(fail(path, "made"))?;
            match Claim::take(path) {
                Ok(claim) => {
                    return Ok(Self {
                        path: path.to_path_buf(),
                        made,
                        claim,
                        before: content(path).map_err(fail(path, "read"))?,
                    });
                }
                Err(Unclaimed::Busy(holder)) => {
                    return Err(FolderError::Busy { path: path.to_path_buf(), holder });
                }
                // Another process made it, wrote nothing, and has just removed it.
                Err(Unclaimed::Io(e))
                    if e.kind() == io::ErrorKind::NotFound && attempt < ATTEMPTS => {}
                Err(Unclaimed::Io(e)) => {
                    remove_empty(&made);
                    return Err(fail(path, "written to")(e));
                }
            }
        }
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        self.leave();
    }
}

/// The folder and those above it that are not there yet, the innermost first.
fn missing_folders(path: &Path) -> Result<Vec<PathBuf>, FolderError> {
    let mut missing = Vec::new();
    for folder in path.ancestors() {
        match fs::metadata(folder) {
            Err(e) if e.kind() == io::ErrorKind::NotFound && !folder.as_os_str().is_empty() => {
                missing.push(folder.to_path_buf());
            }
            Ok(found) if missing.is_empty() && !found.is_dir() => {
                return Err(FolderError::NotAFolder { path: path.to_path_buf() });
            }
            Err(e) if missing.is_empty() => return Err(fail(path, "made")(e)),
            // What is wrong with a folder above shows when this one is made.
            _ => break,
        }
    }
    Ok(missing)
}

/// Removes folders as far as they are empty.
fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        // One that holds something, or is gone, stays as it is.
        if fs::remove_dir(folder).is_err() {
            break;
        }
    }
}

/// What a folder holds besides the claim of the process at work.
fn content(path: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(path)? {
        let entry = entry?;
        if !is_of_claim(&entry.file_name()) {
            files.push(entry.path());
        }
    }
    Ok(files)
}

/// Whether a folder is there and holds nothing but the claim of the process at work.
#[must_use]
pub fn is_empty_folder(path: &Path) -> bool {
    content(path).is_ok_and(|files| files.is_empty())
}

/// Makes `parent/stem-n` with the first n from 1 that is free, and `parent` where it is not there yet.
///
/// Two programs that do this at the same time get different folders.
///
/// # Errors
/// Where the operating system refuses.
pub fn create_numbered_folder(parent: &Path, stem: &str) -> Result<OutputFolder, FolderError> {
    let above = missing_folders(parent)?;
    fs::create_dir_all(parent).map_err(fail(parent, "made"))?;
    for n in 1_u64.. {
        let path = parent.join(format!("{stem}-{n}"));
        match fs::create_dir(&path) {
            Ok(()) => {
                let mut folder = OutputFolder::claimed(&path)?;
                folder.made = std::iter::once(path).chain(above).collect();
                return Ok(folder);
            }
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            // Another process made the parent, wrote nothing, and has just removed it.
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(parent).map_err(fail(parent, "made"))?;
            }
            Err(e) => return Err(fail(&path, "made")(e)),
        }
    }
    unreachable!("a folder cannot hold 2^64 entries")
}

/// Makes the folder that a user named, with its parents, and claims it for this process.
///
/// The claim comes first: nothing in the folder is read, removed or written before this process holds it.
///
/// # Errors
/// Where it exists and `existing` does not allow that, a process is at work there, or the operating system refuses.
pub fn create_named_folder(path: &Path, existing: Existing) -> Result<OutputFolder, FolderError> {
    let refuse = existing == Existing::Refuse;
    let exists = || FolderError::Exists { path: path.to_path_buf() };
    let mut folder = OutputFolder::claimed(path).map_err(|error| match error {
        // A folder that may not be written to is refused for what it holds.
        FolderError::Io { .. } if refuse && content(path).is_ok_and(|files| !files.is_empty()) => {
            exists()
        }
        other => other,
    })?;
    let files = content(path).map_err(fail(path, "read"))?;
    if refuse && !files.is_empty() {
        return Err(exists());
    }
    if existing == Existing::Replace {
        folder.remove_run()?;
    }
    Ok(folder)
}

#[cfg(test)]
mod tests;
