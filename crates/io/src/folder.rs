//! The output folder of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::advice_for;

/// What to do with an output folder that is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse it, unless it is empty.
    Refuse,
    /// Use it. Where it holds a run (a `run.json` or a checkpoint), the output files of that run are removed first, so that none
    /// of them can be taken for a result of the new one; anything else in it is left alone.
    Replace,
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

/// Endings of the files that a run writes.
const OUTPUT_ENDINGS: [&str; 6] = ["xyz", "csv", "json", "toml", "gro", "lennard"];

fn fail(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_path_buf();
    move |source| FolderError::Io {
        path,
        action,
        source,
    }
}

/// Makes `parent/stem-n` with the first n from 1 that is free, and `parent` where it is not there yet.
///
/// Two programs that do this at the same time get different folders.
///
/// # Errors
/// Where the operating system refuses.
pub fn create_numbered_folder(parent: &Path, stem: &str) -> Result<PathBuf, FolderError> {
    fs::create_dir_all(parent).map_err(fail(parent, "made"))?;
    for n in 1_u64.. {
        let path = parent.join(format!("{stem}-{n}"));
        match fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(fail(&path, "made")(e)),
        }
    }
    unreachable!("a folder cannot hold 2^64 entries")
}

/// Makes the folder that a user named, with its parents, and checks that it can be written to.
///
/// # Errors
/// Where it exists and `existing` does not allow that, or the operating system refuses.
pub fn create_named_folder(path: &Path, existing: Existing) -> Result<(), FolderError> {
    match fs::metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return fs::create_dir_all(path).map_err(fail(path, "made"));
        }
        Err(e) => return Err(fail(path, "made")(e)),
        Ok(found) if !found.is_dir() => {
            return Err(FolderError::NotAFolder {
                path: path.to_path_buf(),
            });
        }
        Ok(_) => {}
    }
    let files: Vec<PathBuf> = fs::read_dir(path)
        .and_then(|entries| entries.map(|e| e.map(|e| e.path())).collect())
        .map_err(fail(path, "read"))?;
    if existing == Existing::Refuse && !files.is_empty() {
        return Err(FolderError::Exists {
            path: path.to_path_buf(),
        });
    }
    // Written to before anything is removed: a folder without permission keeps its run.
    let probe = path.join(".lennard-probe.partial");
    fs::write(&probe, b"")
        .and_then(|()| fs::remove_file(&probe))
        .map_err(fail(path, "written to"))?;
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
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_free_number_is_taken() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().join("runs");
        for n in [1, 2, 3] {
            let made = create_numbered_folder(&runs, "gas").unwrap();
            assert_eq!(made, runs.join(format!("gas-{n}")));
        }
        fs::remove_dir(runs.join("gas-2")).unwrap();
        assert_eq!(
            create_numbered_folder(&runs, "gas").unwrap(),
            runs.join("gas-2")
        );
    }

    #[test]
    fn an_existing_folder_is_refused_and_left_alone_without_force() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("out");
        create_named_folder(&path, Existing::Refuse).unwrap();
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
}
