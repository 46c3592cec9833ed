//! Running the program as a user does, from the root of the repository.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// `lennard` with arguments, standing in the root of the repository.
pub fn lennard(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lennard"));
    command.args(args).current_dir(root());
    command
}

/// What `lennard` does with arguments, standing in `folder`.
pub fn lennard_in(folder: &Path, arguments: &[&str]) -> Output {
    lennard(arguments).current_dir(folder).output().unwrap()
}

/// Runs a command whose standard output has no reader: it must still end well.
pub fn without_a_reader(mut command: Command) {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let said = stderr(&output);
    assert!(output.status.success(), "{command:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
}

/// What it wrote on standard output.
pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it wrote on standard error.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs it, wants success, and returns standard output.
pub fn succeed(args: &[&str]) -> String {
    success(&mut lennard(args))
}

/// Runs a command, wants success, and returns standard output.
pub fn success(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}{}", stdout(&output), stderr(&output));
    stdout(&output)
}

/// A short run of a small liquid into a folder.
pub fn run_small(out: &Path) -> Command {
    let mut command = lennard(&["run", "inputs/verlet-1967/triple-point.toml", "--out"]);
    command.arg(out).args(SMALL);
    command
}

/// A short run of a small liquid: arguments for `run`, 256 particles, a few hundred steps.
pub const SMALL: &[&str] = &[
    "--set",
    "system.n_atoms=256",
    "--set",
    "stage.melt.steps=100",
    "--set",
    "stage.equilibrate.steps=100",
    "--set",
    "stage.production.steps=400",
];

/// A folder of its own for a test, with the files that it begins with.
pub struct Place {
    root: tempfile::TempDir,
}

impl Place {
    /// A folder that holds these files: name and text.
    pub fn with(files: &[(&str, &str)]) -> Self {
        let place = Self { root: tempfile::tempdir().unwrap() };
        for (name, text) in files {
            place.write(name, text);
        }
        place
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        self.root.path()
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    /// `lennard` with arguments, standing in it.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = lennard(arguments);
        command.current_dir(self.root());
        command
    }

    /// What `lennard` does with arguments, standing in it.
    pub fn output(&self, arguments: &[&str]) -> Output {
        lennard_in(self.root(), arguments)
    }

    /// Writes a file in it, and the folders on the way.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Reads a file in it.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }
}
