//! The system takes something away while a run is at work: permission, the folder, the reader of a pipe.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::common::{stderr, stdout, without_a_reader};

const SCENE: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.2\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 1000000000\n\
                     [output]\nthermo_every = 50\ntrajectory_every = 500\n[checkpoint]\nevery_steps = 200\n";

/// The user who may do least on every Unix.
const NOBODY: &str = "65534";

struct Place {
    root: tempfile::TempDir,
    /// What comes before the program: nothing, or what gives up the privileges of root.
    before: Vec<String>,
}

impl Place {
    /// A folder with a scene.
    fn new() -> Self {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("liquid.toml"), SCENE).unwrap();
        Self { root, before: Vec::new() }
    }

    /// The same for a user whom permissions bind. `None`, with a printed line, where there is no such user.
    #[allow(clippy::print_stdout)] // a test that is left out says so
    fn of_a_user_without_privileges() -> Option<Self> {
        let mut place = Self::new();
        let said = |command: &str, arguments: &[&str]| {
            let output = Command::new(command).args(arguments).output().ok()?;
            output.status.success().then(|| stdout(&output).trim().to_owned())
        };
        if said("id", &["-u"])? != "0" {
            return Some(place);
        }
        let give_up = ["--reuid", NOBODY, "--regid", NOBODY, "--clear-groups"];
        if said("setpriv", &[&give_up[..], &["true"]].concat()).is_none() {
            println!(
                "skipped: root ignores permissions, and there is no setpriv to become another user"
            );
            return None;
        }
        place.before = ["setpriv"].iter().chain(&give_up).map(|s| (*s).to_owned()).collect();
        // Folders of root may be closed to others: the program is copied to where they may go.
        fs::copy(env!("CARGO_BIN_EXE_lennard"), place.program()).unwrap();
        allow(place.root.path(), 0o777);
        Some(place)
    }

    fn program(&self) -> PathBuf {
        self.root.path().join("program")
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let program = if self.before.is_empty() {
            PathBuf::from(env!("CARGO_BIN_EXE_lennard"))
        } else {
            self.program()
        };
        let mut command = match self.before.split_first() {
            None => Command::new(program),
            Some((first, rest)) => {
                let mut command = Command::new(first);
                command.args(rest).arg(program);
                command
            }
        };
        command.args(arguments).current_dir(self.root.path());
        command
    }

    /// A run without end, once it has written its second checkpoint.
    fn at_work(&self) -> Child {
        let child = self
            .command(&["run", "liquid.toml", "--quiet", "--out", "out"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while checkpoints(&self.out()).len() < 2 {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint after a minute");
            std::thread::sleep(Duration::from_millis(2));
        }
        child
    }

    fn out(&self) -> PathBuf {
        self.root.path().join("out")
    }
}

fn allow(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
}

fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let all = lennard_io::CheckpointFolder::new(folder).list().unwrap_or_default();
    all.into_iter().map(|(_, path)| path).collect()
}

fn refused(output: &Output, code: i32, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
}

/// Proves that a run without permission for its folder stops at its next checkpoint, with the cause and the way to go
/// on. Whole files stay whole, and the run goes on once the folder is open again. This proves nothing for root, whom
/// permissions do not bind.
#[test]
fn permission_lost_stops_the_run_and_loses_nothing_before() {
    let Some(place) = Place::of_a_user_without_privileges() else {
        return;
    };
    let child = place.at_work();
    allow(&place.out(), 0o555);
    let output = child.wait_with_output().unwrap();
    refused(
        &output,
        1,
        &[
            "writing results: out/checkpoint-",
            "cannot create the file: Permission denied",
            "whole up to step",
            "to go on from there: lennard resume out",
        ],
    );
    let record = fs::read_to_string(place.out().join("run.json")).unwrap();
    assert!(record.contains("\"finished\": false"), "{record}");
    for checkpoint in checkpoints(&place.out()) {
        lennard_io::read_checkpoint(&checkpoint).unwrap();
    }
    // Nor can one begin in an empty folder that it may not write to.
    fs::create_dir(place.root.path().join("closed")).unwrap();
    allow(&place.root.path().join("closed"), 0o555);
    let closed =
        place.command(&["run", "liquid.toml", "--quiet", "--out", "closed"]).output().unwrap();
    refused(
        &closed,
        2,
        &[
            "making the output folder: the output folder closed cannot be written to: Permission denied",
        ],
    );
    // A new run cannot begin there, and says so.
    allow(&place.out(), 0o755);
    allow(place.root.path(), 0o555);
    let elsewhere =
        place.command(&["run", "liquid.toml", "--quiet", "--out", "other"]).output().unwrap();
    refused(
        &elsewhere,
        2,
        &["making the output folder: the output folder other cannot be made: Permission denied"],
    );
    let resumed =
        place.command(&["resume", "out", "--quiet", "--max-walltime", "100ms"]).output().unwrap();
    refused(&resumed, 4, &["stopped by --max-walltime after step"]);
    allow(place.root.path(), 0o755);
}

/// Proves that a run ends with exit code 1 where its folder is taken away or has become a file. The message names the file
/// that could not be written. This holds for root too.
#[test]
fn a_folder_that_is_taken_away_stops_the_run() {
    for by_a_file in [false, true] {
        let place = Place::new();
        let child = place.at_work();
        fs::rename(place.out(), place.root.path().join("moved")).unwrap();
        if by_a_file {
            fs::write(place.out(), "in the way").unwrap();
        }
        refused(&child.wait_with_output().unwrap(), 1, &["writing results: out/"]);
        for checkpoint in checkpoints(&place.root.path().join("moved")) {
            lennard_io::read_checkpoint(&checkpoint).unwrap();
        }
    }
}

/// Proves that a place which refuses even root is refused before anything is computed.
#[cfg(target_os = "linux")]
#[test]
fn a_place_where_no_one_may_write_is_refused_before_the_run() {
    let place = Place::new();
    let output = place
        .command(&["run", "liquid.toml", "--quiet", "--out", "/proc/lennard"])
        .output()
        .unwrap();
    refused(
        &output,
        2,
        &["making the output folder: the output folder /proc/lennard cannot be made: "],
    );
}

/// Proves that a reader who has gone away (`lennard run … --json | true`) neither ends a run nor makes it a failure.
#[test]
fn json_that_nobody_reads_is_no_failure() {
    let place = Place::new();
    for arguments in [
        &["run", "liquid.toml", "--json", "--out", "out", "--set", "stage.0.steps=200"][..],
        &["plan", "liquid.toml", "--json"],
        &["list", "observables", "--json"],
    ] {
        without_a_reader(place.command(arguments));
    }
    assert!(
        fs::read_to_string(place.out().join("run.json")).unwrap().contains("\"finished\": true")
    );
}
