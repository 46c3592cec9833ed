//! The system takes something away while a run is at work: permission, or the folder.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use crate::program::common::{
    ENDLESS, FLUID, Place, checkpoints, ended, stdout, wait_until, words,
};

/// The user who may do least on every Unix.
const NOBODY: &str = "65534";

/// A folder with a scene, and the words that start the program: its path, behind what gives up the privileges of root.
struct Bench {
    place: Place,
    program: Vec<String>,
}

fn bench() -> Bench {
    let files =
        "[output]\nthermo_every = 50\ntrajectory_every = 500\n[checkpoint]\nevery_steps = 200\n";
    let place = Place::with(&[("liquid.toml", &format!("{FLUID}{files}"))]);
    Bench { place, program: vec![env!("CARGO_BIN_EXE_lennard").to_owned()] }
}

/// The same for a user whom permissions bind. `None`, with a printed line, where there is no such user.
#[allow(clippy::print_stdout)] // a test that is left out says so
fn of_a_user_without_privileges() -> Option<Bench> {
    let mut bench = bench();
    let said = |command: &str, arguments: &[&str]| {
        let output = Command::new(command).args(arguments).output().ok()?;
        output.status.success().then(|| stdout(&output).trim().to_owned())
    };
    if said("id", &["-u"])? != "0" {
        return Some(bench);
    }
    let give_up = ["--reuid", NOBODY, "--regid", NOBODY, "--clear-groups"];
    if said("setpriv", &[&give_up[..], &["true"]].concat()).is_none() {
        println!("skipped: root ignores permissions, and there is no setpriv to become another");
        return None;
    }
    // Folders of root may be closed to others: the program is copied to where they may go.
    let program = bench.place.path("program");
    fs::copy(env!("CARGO_BIN_EXE_lennard"), &program).unwrap();
    allow(bench.place.root(), 0o777);
    let program = program.to_str().unwrap();
    let all = ["setpriv"].into_iter().chain(give_up).chain([program]);
    bench.program = all.map(str::to_owned).collect();
    Some(bench)
}

impl Bench {
    fn command(&self, line: &str) -> Command {
        let (first, rest) = self.program.split_first().unwrap();
        let mut command = Command::new(first);
        command.args(rest).args(words(line)).current_dir(self.place.root());
        command
    }

    fn output(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// A run without end, once it has written its second checkpoint.
    fn at_work(&self) -> Child {
        let mut command = self.command(&format!("run liquid.toml --quiet --out out {ENDLESS}"));
        let child = command.stderr(Stdio::piped()).spawn().unwrap();
        wait_until("checkpoint", || checkpoints(&self.place.path("out")).len() == 2);
        child
    }
}

fn allow(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
}

fn checkpoints_are_whole(folder: &Path) {
    for checkpoint in checkpoints(folder) {
        lennard_io::read_checkpoint(&checkpoint).unwrap();
    }
}

/// Proves that a run without permission for its folder stops at its next checkpoint, with the cause and the way to go
/// on. Whole files stay whole, and the run goes on once the folder is open again. This proves nothing for root, whom
/// permissions do not bind.
#[test]
fn permission_lost_stops_the_run_and_loses_nothing_before() {
    let Some(bench) = of_a_user_without_privileges() else {
        return;
    };
    let (root, out) = (bench.place.root(), bench.place.path("out"));
    let child = bench.at_work();
    allow(&out, 0o555);
    let words = [
        "writing results: out/checkpoint-",
        "cannot create the file: Permission denied",
        "whole up to step",
        "to go on from there: lennard resume out",
    ];
    ended(&child.wait_with_output().unwrap(), 1, &words);
    assert_eq!(bench.place.record("out")["finished"], false);
    checkpoints_are_whole(&out);
    // Nor can one begin in an empty folder that it may not write to.
    fs::create_dir(root.join("closed")).unwrap();
    allow(&root.join("closed"), 0o555);
    let denied = |folder: &str, what: &str| {
        let output = bench.output(&format!("run liquid.toml --quiet --out {folder}"));
        let place = format!("making the output folder: the output folder {folder} cannot be");
        ended(&output, 2, &[&format!("{place} {what}: Permission denied")]);
    };
    denied("closed", "written to");
    // A new run cannot begin there, and says so.
    allow(&out, 0o755);
    allow(root, 0o555);
    denied("other", "made");
    let resumed = bench.output("resume out --quiet --max-walltime 100ms");
    ended(&resumed, 4, &["stopped by --max-walltime after step"]);
    allow(root, 0o755);
}

/// Proves that a run ends with exit code 1 where its folder is taken away or has become a file. The message names the file
/// that could not be written. This holds for root too.
#[test]
fn a_folder_that_is_taken_away_stops_the_run() {
    for by_a_file in [false, true] {
        let bench = bench();
        let child = bench.at_work();
        let moved = bench.place.path("moved");
        fs::rename(bench.place.path("out"), &moved).unwrap();
        if by_a_file {
            bench.place.write("out", "in the way");
        }
        ended(&child.wait_with_output().unwrap(), 1, &["writing results: out/"]);
        checkpoints_are_whole(&moved);
    }
}

/// Proves that a place which refuses even root is refused before anything is computed.
#[cfg(target_os = "linux")]
#[test]
fn a_place_where_no_one_may_write_is_refused_before_the_run() {
    let words = "making the output folder: the output folder /proc/lennard cannot be made: ";
    ended(&bench().output("run liquid.toml --quiet --out /proc/lennard"), 2, &[words]);
}
