//! The files that a command reads: no output may take the place of one of them.

use std::path::{Path, PathBuf};

use lennard_scene::{Arrangement, Scene};

use crate::program::failure::{Failure, INPUT};

/// Files that a command reads.
pub struct Inputs(Vec<PathBuf>);

impl Inputs {
    /// These files.
    pub fn of(files: Vec<PathBuf>) -> Self {
        Self(files)
    }

    /// The files of a scene: its own, the lock file that it uses, the configuration that it starts from, the table of its potential.
    pub fn of_scene(file: &Path, lock: Option<&Path>, scene: &Scene) -> Self {
        let mut files = vec![file.to_path_buf()];
        files.extend(lock.map(Path::to_path_buf));
        if let Arrangement::File { path, .. } = &scene.system.start {
            files.push(path.clone());
        }
        files.extend(scene.potential.file().map(|file| file.path().to_path_buf()));
        Self(files)
    }

    /// The same files, and one more.
    pub fn with(mut self, file: &Path) -> Self {
        self.0.push(file.to_owned());
        self
    }

    /// Refuses a folder that files are written to or removed from, where an input lies in it.
    pub fn not_in(&self, folder: &Path) -> Result<(), Failure> {
        self.refuse(folder, |place, folder| place.parent() == Some(folder))
    }

    /// The same for a folder that is removed with everything below it.
    pub fn not_below(&self, folder: &Path) -> Result<(), Failure> {
        self.refuse(folder, |place, folder| place.starts_with(folder))
    }

    /// Refuses a file to write that is an input.
    pub fn are_not(&self, file: &Path) -> Result<(), Failure> {
        self.refuse(file, |place, file| place == file)
    }

    fn refuse(&self, output: &Path, hits: impl Fn(&Path, &Path) -> bool) -> Result<(), Failure> {
        // What is not there yet holds no input.
        let Ok(target) = output.canonicalize() else {
            return Ok(());
        };
        let Some(input) =
            self.0.iter().find(|input| places(input).any(|place| hits(&place, &target)))
        else {
            return Ok(());
        };
        let (there, allowed) = if target.is_dir() {
            ("lies in the output folder", "another output folder")
        } else {
            ("would be written over by", "another output file")
        };
        Err(Failure::new(
            "protecting the input",
            format!(
                "{} {there} {}\n  allowed: {allowed}; no file that the command reads is replaced or removed",
                input.display(),
                output.display()
            ),
            INPUT,
        ))
    }
}

/// Where an input lies: the file itself, and the link to it where it is named by one.
fn places(input: &Path) -> impl Iterator<Item = PathBuf> {
    let folder = match input.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let link =
        folder.canonicalize().ok().zip(input.file_name()).map(|(folder, name)| folder.join(name));
    input.canonicalize().ok().into_iter().chain(link)
}
