//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{PoisonError, RwLock, RwLockReadGuard};

use serde::Serialize;

use crate::WriteError;

/// Folders in which this process makes no file any more.
static CLOSED: RwLock<Vec<PathBuf>> = RwLock::new(Vec::new());

/// Waits for the files that are being made, and lets none be made in a folder from then on.
pub(crate) fn close(folder: &Path) {
    let mut closed = CLOSED.write().unwrap_or_else(PoisonError::into_inner);
    closed.push(folder.to_path_buf());
}

/// Held while a file is made, so that its folder is not closed meanwhile.
pub(crate) fn making(path: &Path) -> Result<RwLockReadGuard<'static, Vec<PathBuf>>, WriteError> {
    let closed = CLOSED.read().unwrap_or_else(PoisonError::into_inner);
    if closed.iter().any(|folder| path.parent() == Some(folder)) {
        let cause = io::Error::new(io::ErrorKind::Interrupted, "the run was given up");
        return Err(WriteError::io(path, "create the file", cause));
    }
    Ok(closed)
}

/// The name that a half-written file was to take; `None` for any other file.
pub(crate) fn whole_name(name: &str) -> Option<&str> {
    name.strip_prefix('.')?.strip_suffix(".partial")
}

/// Where a file is written before it takes its name: `.NAME.partial` beside it. The name is always
/// the same one, so that a killed run leaves at most one such file and the next write replaces it.
fn partial_path(path: &Path) -> Result<PathBuf, WriteError> {
    let Some(name) = path.file_name() else {
        let cause = io::Error::new(io::ErrorKind::InvalidInput, "the path names no file");
        return Err(WriteError::io(path, "create the file", cause));
    };
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(".partial");
    Ok(path.with_file_name(hidden))
}

/// Waits until the folder's list of names is on the disk: a rename alone may be lost with the power.
fn sync_folder_of(path: &Path) -> io::Result<()> {
    #[cfg(unix)]
    {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        File::open(folder)?.sync_all()
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        Ok(())
    }
}

/// Lets `fill` write a hidden neighbor of `path`, syncs it and renames it to `path`.
pub(crate) fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), WriteError> {
    let partial = partial_path(path)?;
    let _making = making(path)?;
    let attempt = || -> Result<(), (&'static str, io::Error)> {
        let mut file = File::create(&partial).map_err(|e| ("create the file", e))?;
        fill(&mut file).map_err(|e| ("write", e))?;
        file.sync_all().map_err(|e| ("sync", e))?;
        fs::rename(&partial, path).map_err(|e| ("rename the finished file", e))?;
        sync_folder_of(path).map_err(|e| ("sync the folder", e))
    };
    attempt().map_err(|(action, source)| {
        // The first error is the one to report; a leftover is hidden, named as partial, and replaced by the next write.
        let _ = fs::remove_file(&partial);
        WriteError::io(path, action, source)
    })
}

/// Writes a file that comes in parts, and is there whole or not at all. All parts are taken, whether they can be written or not.
pub(crate) fn write_parts_atomically(
    path: &Path,
    parts: impl FnOnce(&mut dyn FnMut(&[u8])) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let mut parts = Some(parts);
    let mut passed = Ok(());
    let written = write_atomically(path, |file| {
        let mut written = Ok(());
        if let Some(parts) = parts.take() {
            passed = parts(&mut |part| {
                let done = std::mem::replace(&mut written, Ok(()));
                written = done.and_then(|()| file.write_all(part));
            });
        }
        match &passed {
            Ok(()) => written,
            Err(_) => Err(io::Error::other("a part is missing")),
        }
    });
    if let Some(parts) = parts.take() {
        // The file could not be made.
        parts(&mut |_| {})?;
    }
    passed.and(written)
}

pub(crate) fn write_bytes_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |file| file.write_all(bytes))
}

/// Writes a text file that is there whole or not at all: to a hidden neighbor first, synced, then renamed.
///
/// # Errors
/// Where the operating system refuses; what stood at `path` before is then still there.
pub fn write_text_atomically(path: &Path, text: &str) -> Result<(), WriteError> {
    write_bytes_atomically(path, text.as_bytes())
}

/// The name of the schema of a document, `lennard-NAME/VERSION`. The number grows where an entry changes its meaning.
#[macro_export]
macro_rules! schema {
    ($name:literal, $version:literal) => {
        concat!("lennard-", $name, "/", $version)
    };
}

/// Writes `value` as indented JSON with a line end, like [`write_text_atomically`].
///
/// # Errors Where the operating system refuses, or where `value` cannot be JSON (a map with keys
/// that are no strings). An older file at `path` is then still there.
pub fn write_json_atomically(path: &Path, value: &impl Serialize) -> Result<(), WriteError> {
    let mut text =
        serde_json::to_vec_pretty(value).map_err(|e| WriteError::io(path, "write", e.into()))?;
    text.push(b'\n');
    write_bytes_atomically(path, &text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_what_was_there_and_nothing_beside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_text_atomically(&path, "old").unwrap();
        let error = write_atomically(&path, |file| {
            file.write_all(b"half of the n")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(matches!(error, WriteError::Io { action: "write", .. }));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_is_gone_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gone/a.txt");
        let error = write_text_atomically(&path, "x").unwrap_err();
        assert!(error.to_string().contains("a.txt"), "{error}");
        assert!(error.advice().contains("folder is gone"));
    }

    #[test]
    fn json_ends_with_a_line_end_reads_back_and_leaves_nothing_beside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_json_atomically(&path, &[1.5, f64::MIN_POSITIVE]).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.ends_with("]\n"));
        let back: [f64; 2] = serde_json::from_str(&text).unwrap();
        assert_eq!(back, [1.5, f64::MIN_POSITIVE]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
