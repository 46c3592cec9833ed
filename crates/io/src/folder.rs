//! The output folder of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::claim::{Claim, Unclaimed, is_of_claim};
use crate::error::advice_for;
use crate::holder::Holder;

/// What to do with an output folder that is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse it, unless it is empty.
    Refuse,
    /// Use it. Where it holds a run (a `run.json` or a checkpoint), the output files of that run are removed first. No old file
    /// can then be taken for a result of the new run. Other files in the folder are left alone.
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

/// Endings of the files that a run writes.
const OUTPUT_ENDINGS: [&str; 9] = [
    "xyz",
    "gz",
    "lammpstrj",
    "xtc",
    "csv",
    "json",
    "toml",
    "gro",
    "lennard",
];

fn fail(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_path_buf();
    move |source| FolderError::Io {
        path,
        action,
        source,
    }
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
    /// Whether it held nothing when this process began there.
    was_empty: bool,
}

impl OutputFolder {
    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it held nothing when this process began there: all that is in it is of this process then.
    #[must_use]
    pub fn was_empty(&self) -> bool {
        self.was_empty
    }

    /// Removes the output files of the run that the folder holds, where it holds one; anything else is left alone.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn remove_run(&mut self) -> Result<(), FolderError> {
        let path = &self.path;
        let files = content(path).map_err(fail(path, "read"))?;
        let ends_with = |file: &Path, endings: &[&str]| {
            file.extension()
                .is_some_and(|found| endings.iter().any(|e| found == *e))
        };
        let holds_run = files.iter().any(|file| {
            file.file_name().is_some_and(|name| name == "run.json") || ends_with(file, &["lennard"])
        });
        if holds_run {
            for file in files {
                if ends_with(&file, &OUTPUT_ENDINGS) && file.is_file() {
                    fs::remove_file(&file).map_err(fail(path, "emptied"))?;
                }
            }
            self.was_empty = is_empty_folder(path);
        }
        Ok(())
    }

    /// Refuses to go on where another process has taken the folder over.
    ///
    /// # Errors
    /// [`FolderError::Lost`], within half a minute after it happened.
    pub fn still_held(&self) -> Result<(), FolderError> {
        if self.claim.is_lost() {
            return Err(FolderError::Lost {
                path: self.path.clone(),
            });
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
                        was_empty: is_empty_folder(path),
                    });
                }
                Err(Unclaimed::Busy(holder)) => {
                    return Err(FolderError::Busy {
                        path: path.to_path_buf(),
                        holder,
                    });
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
                return Err(FolderError::NotAFolder {
                    path: path.to_path_buf(),
                });
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
    let exists = || FolderError::Exists {
        path: path.to_path_buf(),
    };
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
mod tests {
    use super::*;
    use crate::claim::CLAIM_FILE;

    #[test]
    fn the_first_free_number_is_taken() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().join("runs");
        for n in [1, 2, 3] {
            let made = create_numbered_folder(&runs, "gas").unwrap();
            assert_eq!(made.path(), runs.join(format!("gas-{n}")));
            fs::write(made.path().join("run.json"), "{}").unwrap();
        }
        fs::remove_dir_all(runs.join("gas-2")).unwrap();
        let made = create_numbered_folder(&runs, "gas").unwrap();
        assert_eq!(made.path(), runs.join("gas-2"));
    }

    #[test]
    fn an_existing_folder_is_refused_and_left_alone_without_force() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("out");
        fs::create_dir(&path).unwrap();
        create_named_folder(&path, Existing::Refuse).expect("an empty one is as good as none");
        fs::write(path.join("run.json"), "{}").unwrap();
        let error = create_named_folder(&path, Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Exists { .. }));
        assert!(error.to_string().contains("--force"));
        assert!(path.join("run.json").exists());
    }

    #[test]
    fn force_removes_the_files_of_the_old_run_and_nothing_else() {
        let root = tempfile::tempdir().unwrap();
        for name in ["run.json", "rdf.csv", "notes.txt"] {
            fs::write(root.path().join(name), "x").unwrap();
        }
        create_named_folder(root.path(), Existing::Replace).unwrap();
        let left: Vec<_> = fs::read_dir(root.path())
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect();
        assert_eq!(left, ["notes.txt"]);
    }

    #[test]
    fn force_on_a_folder_that_holds_no_run_removes_nothing() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("data.csv"), "x").unwrap();
        create_named_folder(root.path(), Existing::Replace).unwrap();
        assert!(root.path().join("data.csv").exists());
    }

    #[test]
    fn a_path_that_cannot_be_made_is_named_with_its_cause() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        fs::write(&file, "x").unwrap();
        let error = create_named_folder(&file, Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NotAFolder { .. }));
        let below = file.join("out");
        let error = create_named_folder(&below, Existing::Refuse).unwrap_err();
        assert!(error.to_string().contains("file/out"), "{error}");
        assert!(create_numbered_folder(&file, "gas").is_err());
    }

    #[test]
    fn a_folder_is_held_until_it_is_dropped_and_the_process_is_named() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("out");
        let held = create_named_folder(&path, Existing::Refuse).unwrap();
        fs::write(path.join("run.json"), "{}").unwrap();
        fs::write(path.join("rdf.csv"), "x").unwrap();
        for existing in [Existing::Refuse, Existing::Replace, Existing::Keep] {
            let error = create_named_folder(&path, existing).unwrap_err();
            let wanted = format!("process {} is at work there", std::process::id());
            assert!(error.to_string().contains(&wanted), "{error}");
            assert!(path.join("rdf.csv").exists(), "nothing is removed");
        }
        drop(held);
        assert!(!path.join(CLAIM_FILE).exists(), "no trace is left");
        create_named_folder(&path, Existing::Keep).unwrap();
        assert!(path.join("rdf.csv").exists(), "it was to be kept");
    }

    #[test]
    fn the_claim_of_a_process_that_is_gone_blocks_nothing() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(CLAIM_FILE), "1\n").unwrap();
        let held = create_named_folder(root.path(), Existing::Refuse).unwrap();
        assert!(is_empty_folder(held.path()));
    }

    #[test]
    fn the_claim_of_another_machine_holds_until_it_is_no_longer_renewed() {
        let root = tempfile::tempdir().unwrap();
        let claim = root.path().join(CLAIM_FILE);
        fs::write(&claim, "17\nnode-7\nanother-start\n").unwrap();
        let error = create_named_folder(root.path(), Existing::Keep).unwrap_err();
        let wanted = "is in use: process 17 on node-7 is at work there";
        assert!(error.to_string().contains(wanted), "{error}");
        assert_eq!(
            fs::read_dir(root.path()).unwrap().count(),
            1,
            "no trace is left"
        );
        let long_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(301);
        fs::File::options()
            .write(true)
            .open(&claim)
            .unwrap()
            .set_modified(long_ago)
            .unwrap();
        let held = create_named_folder(root.path(), Existing::Keep).unwrap();
        held.still_held().unwrap();
        assert!(
            fs::read_to_string(&claim)
                .unwrap()
                .starts_with(&std::process::id().to_string())
        );
        drop(held);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_folder_that_another_process_has_taken_over_is_named() {
        let lost = FolderError::Lost {
            path: PathBuf::from("runs/gas-1"),
        };
        assert_eq!(
            lost.to_string(),
            "the output folder runs/gas-1 is lost: this process slept for minutes, and another one has begun there\n  \
             allowed: one process in a folder; the other one goes on"
        );
    }

    #[test]
    fn of_many_threads_that_find_a_dead_claim_one_takes_the_folder() {
        for _ in 0..50 {
            let root = tempfile::tempdir().unwrap();
            fs::write(root.path().join(CLAIM_FILE), "1\n").unwrap();
            let taken: Vec<_> = std::thread::scope(|scope| {
                let tries: Vec<_> = (0..8)
                    .map(|_| scope.spawn(|| create_named_folder(root.path(), Existing::Keep).ok()))
                    .collect();
                tries
                    .into_iter()
                    .filter_map(|t| t.join().unwrap())
                    .collect()
            });
            assert_eq!(taken.len(), 1);
            taken[0].still_held().unwrap();
        }
    }

    #[test]
    fn folders_that_were_made_and_never_written_to_are_removed_and_no_others() {
        let root = tempfile::tempdir().unwrap();
        let deep = root.path().join("a/b/c");
        drop(create_named_folder(&deep, Existing::Refuse).unwrap());
        assert!(!root.path().join("a").exists());
        fs::create_dir_all(&deep).unwrap();
        drop(create_named_folder(&deep, Existing::Refuse).unwrap());
        assert!(deep.exists(), "it was there before");
        let runs = root.path().join("runs");
        drop(create_numbered_folder(&runs, "gas").unwrap());
        assert!(!runs.exists());
        let kept = create_named_folder(&root.path().join("d/e"), Existing::Refuse).unwrap();
        fs::write(kept.path().join("notes.txt"), "x").unwrap();
        drop(kept);
        assert!(root.path().join("d/e/notes.txt").exists());
    }
}
