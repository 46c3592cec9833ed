//! Running the program as a user does: command lines, the folders that they stand in, and what they answer.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// A small dense fluid at constant energy.
pub const FLUID: &str = "\
[system]
n_atoms = 108
density = 0.8
temperature = 1.2
[truncation]
r_cut = 2.2
[[stage]]
name = \"production\"
steps = 200
";

/// Steps of a run that ends by being stopped: hours of them.
pub const ENDLESS: &str = "--set stage.production.steps=1000000000";

/// The fluid as a scene that starts from a file.
pub fn fluid_from(file: &str) -> String {
    let start = format!("start = {{ kind = \"file\", file = \"{file}\" }}\n[system]");
    FLUID.replace("[system]\nn_atoms = 108\ndensity = 0.8", &start)
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The words of a command line. What stands in single quotes is one word.
pub fn words(line: &str) -> Vec<&str> {
    let pieces = line.split('\'').enumerate();
    let of = pieces.map(|(k, piece)| match k % 2 {
        0 => piece.split_whitespace().collect::<Vec<_>>(),
        _ => vec![piece],
    });
    of.flatten().collect()
}

/// `lennard` with the words of a line, standing in the root of the repository.
pub fn lennard(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lennard"));
    command.args(words(line)).current_dir(root());
    command
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

/// Runs a line in the root, wants success, and returns standard output.
pub fn succeed(line: &str) -> String {
    success(&mut lennard(line))
}

/// Runs a command, wants success, and returns standard output.
#[track_caller]
pub fn success(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}{}", stdout(&output), stderr(&output));
    stdout(&output)
}

/// Wants this exit code and these words on standard error, which is returned.
#[track_caller]
pub fn ended(output: &Output, code: i32, words: &[&str]) -> String {
    let said = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{said}{}", stdout(output));
    contains(&said, words);
    said
}

/// Runs a line in the root, and wants it refused as input with these words.
#[track_caller]
pub fn refused(line: &str, words: &[&str]) {
    ended(&lennard(line).output().unwrap(), 2, words);
}

/// Wants these words in a text.
#[track_caller]
pub fn contains(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "wanted `{word}` in\n{text}");
    }
}

/// The document that a text is.
#[track_caller]
pub fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The number that a value is.
#[track_caller]
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// The row of a quantity in a comparison.
#[track_caller]
pub fn row<'a>(compared: &'a Value, quantity: &str) -> &'a Value {
    let rows = compared["rows"].as_array().unwrap();
    rows.iter().find(|r| r["quantity"] == quantity).unwrap_or_else(|| panic!("no {quantity}"))
}

/// A text with single blanks: a terminal chooses where lines break.
pub fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Waits until it is so, a minute at most.
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "no {what} after a minute");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends a signal to a process.
pub fn kill(child: &Child, signal: &str) {
    let signal = format!("-{signal}");
    success(Command::new("kill").args([signal, child.id().to_string()]));
}

/// The checkpoints of a folder, newest first.
pub fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let all = lennard_io::CheckpointFolder::new(folder).list().unwrap_or_default();
    all.into_iter().map(|(_, path)| path).collect()
}

/// The triple point in short: 256 particles, a few hundred steps.
pub const SMALL: &str = "verlet-1967/triple-point --set system.n_atoms=256 \
    --set stage.melt.steps=100 --set stage.equilibrate.steps=100 --set stage.production.steps=400";

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

    /// Whether a file or folder is in it.
    pub fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// `lennard` with the words of a line, standing in it.
    pub fn command(&self, line: &str) -> Command {
        let mut command = lennard(line);
        command.current_dir(self.root());
        command
    }

    /// What `lennard` does with a line, standing in it.
    pub fn output(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs a line, wants success, and returns standard output.
    #[track_caller]
    pub fn succeed(&self, line: &str) -> String {
        success(&mut self.command(line))
    }

    /// The document that a line prints with `--json`.
    #[track_caller]
    pub fn json(&self, line: &str) -> Value {
        json(&self.succeed(&format!("{line} --json")))
    }

    /// Wants a line refused as input, with these words on standard error, which is returned.
    #[track_caller]
    pub fn refused(&self, line: &str, words: &[&str]) -> String {
        ended(&self.output(line), 2, words)
    }

    /// A command that goes on by itself, once it is so.
    pub fn spawn(&self, line: &str, what: &str, is_so: impl FnMut() -> bool) -> Child {
        let mut command = self.command(line);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        wait_until(what, is_so);
        child
    }

    /// What a line of a shell does in it, where `lennard` is the program.
    pub fn shell(&self, line: &str) -> Output {
        let line = line.replace("lennard ", concat!("'", env!("CARGO_BIN_EXE_lennard"), "' "));
        Command::new("sh").args(["-c", &line]).current_dir(self.root()).output().unwrap()
    }

    /// Writes a file in it, and the folders on the way.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Reads a file in it.
    #[track_caller]
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Reads a file of any bytes in it.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The record of a run in it.
    #[track_caller]
    pub fn record(&self, folder: &str) -> Value {
        json(&self.read(&format!("{folder}/run.json")))
    }

    /// Wants the same bytes in these files of two runs.
    #[track_caller]
    pub fn same(&self, one: &str, other: &str, files: &[&str]) {
        for file in files {
            let of = |folder: &str| self.bytes(&format!("{folder}/{file}"));
            assert!(of(one) == of(other), "{file} differs");
        }
    }
}
