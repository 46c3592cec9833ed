//! Signals before there is anything to keep: the program ends at once, says so, and leaves nothing behind.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use crate::program::common::{Place, lennard, stderr};

/// A start that takes seconds: particles at random, relaxed.
const SLOW: &str = "[start]\nkind = \"random\"\n[system]\nn_atoms = 100_000\ndensity = 0.7\ntemperature = 1.2\n\
                    [truncation]\nr_cut = 2.5\n[[stage]]\nname = \"production\"\nsteps = 1_000_000_000\n";

const SMALL: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.2\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 1_000_000_000\n[checkpoint]\nevery_steps = 100\n";

/// The signals that may come while a run starts, as `kill` and as numbers.
const SIGNALS: [(&str, u32); 3] = [("INT", 2), ("TERM", 15), ("HUP", 1)];

fn bench() -> Place {
    Place::with(&[("slow.toml", SLOW), ("small.toml", SMALL)])
}

/// Starts it with SIGHUP as a terminal leaves it. Tests that run under `nohup` pass SIGHUP on as ignored, and a run
/// would rightly ignore it too.
fn start(bench: &Place, arguments: &[&str]) -> Child {
    let mut command = Command::new("env");
    command.args(["--default-signal=HUP", env!("CARGO_BIN_EXE_lennard")]).args(arguments);
    spawn(bench, &mut command)
}

fn spawn(bench: &Place, command: &mut Command) -> Child {
    command.current_dir(bench.root()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

fn checkpoints(bench: &Place, folder: &str) -> Vec<(u64, PathBuf)> {
    lennard_io::CheckpointFolder::new(&bench.path(folder)).list().unwrap_or_default()
}

/// Waits for what must come; one that ended first is shown.
fn wait_for(child: &mut Child, what: &str, mut there: impl FnMut(u32) -> bool) {
    while !there(child.id()) {
        if let Some(status) = child.try_wait().unwrap() {
            panic!("ended with {status} before {what}");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Waits until the program listens for a signal.
fn wait_until_it_listens(child: &mut Child, signal: u32) {
    wait_for(child, "it listened", |id| {
        let status = fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
        let caught = status.lines().find_map(|l| l.strip_prefix("SigCgt:"));
        let mask = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
    });
}

fn kill(child: &Child, signal: &str) {
    let done = Command::new("kill")
        .args([&format!("-{signal}"), &child.id().to_string()])
        .status()
        .unwrap();
    assert!(done.success());
}

fn ended(child: Child, code: i32, words: &[&str]) -> Output {
    let output = child.wait_with_output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
    output
}

#[test]
fn a_run_that_starts_ends_at_once_and_nothing_was_written() {
    let bench = bench();
    for (signal, number) in SIGNALS {
        let mut child = start(&bench, &["run", "slow.toml", "--quiet", "--out", "new/out"]);
        wait_until_it_listens(&mut child, number);
        kill(&child, signal);
        ended(child, 1, &["stopped before the first step: nothing was written"]);
        assert!(!bench.path("new").exists(), "{signal}");
    }
}

/// Proves that a run removes its first files where no step of it can be kept. Nothing else in the folder is removed.
#[test]
fn a_run_whose_first_step_is_under_way_takes_its_files_with_it() {
    let bench = bench();
    // A lattice starts fast; its first step takes longest.
    let scene = SLOW.replace("random", "lattice").replace("100_000", "2_048_000");
    bench.write("large.toml", &scene);
    let mut child = start(&bench, &["run", "large.toml", "--quiet", "--out", "out"]);
    wait_for(&mut child, "the record", |_| bench.path("out/run.json").exists());
    kill(&child, "TERM");
    ended(child, 1, &["stopped before the first step: nothing was written"]);
    assert!(!bench.path("out").exists());
}

#[test]
fn a_run_under_way_keeps_its_steps_when_the_terminal_goes_unless_it_was_told_not_to_mind() {
    let bench = bench();
    let run = ["run", "small.toml", "--quiet", "--out", "out"];
    let mut child = start(&bench, &run);
    wait_for(&mut child, "a checkpoint", |_| !checkpoints(&bench, "out").is_empty());
    kill(&child, "HUP");
    ended(child, 4, &["stopped on request after step", "to go on: lennard resume out"]);
    // What `nohup` does.
    let script = format!(
        "trap '' HUP; exec '{}' run small.toml --quiet --out other",
        env!("CARGO_BIN_EXE_lennard")
    );
    let mut child = spawn(&bench, Command::new("sh").args(["-c", &script]));
    wait_for(&mut child, "a checkpoint", |_| !checkpoints(&bench, "other").is_empty());
    kill(&child, "HUP");
    let (step, _) = checkpoints(&bench, "other")[0];
    wait_for(&mut child, "two checkpoints more", |_| {
        let last = checkpoints(&bench, "other");
        last.first().is_some_and(|(now, _)| *now >= step + 200)
    });
    kill(&child, "TERM");
    ended(child, 4, &["to go on: lennard resume other"]);
}

#[test]
fn a_resume_that_loads_leaves_the_checkpoint_and_says_how_to_go_on() {
    let bench = bench();
    bench.write("large.toml", &SMALL.replace("n_atoms = 108\n", "n_atoms = 256_000\n"));
    let made = lennard(&["run", "large.toml", "--quiet", "--out", "out"])
        .args(["--set", "stage.0.steps=2"])
        .current_dir(bench.root())
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", stderr(&made));
    let before = checkpoints(&bench, "out");
    let bytes = fs::read(&before[0].1).unwrap();
    for (signal, number) in SIGNALS {
        let mut child = start(&bench, &["resume", "out", "--quiet", "--steps", "1000000"]);
        wait_until_it_listens(&mut child, number);
        kill(&child, signal);
        let words = [
            "stopped before the first step: the checkpoint is untouched",
            "to go on: lennard resume out --steps 1000000",
        ];
        ended(child, 4, &words);
        assert_eq!(checkpoints(&bench, "out"), before, "{signal}");
        assert!(fs::read(&before[0].1).unwrap() == bytes, "{signal}");
        assert!(!bench.path("out/.lennard-claim").exists(), "{signal}");
    }
}

#[test]
fn a_sweep_gives_up_points_that_start_and_keeps_the_others() {
    let bench = bench();
    bench.write("slow-sweep.toml", "base = \"slow.toml\"\n[grid]\ntemperature = [1.1, 1.2]\n");
    let mut child = start(&bench, &["sweep", "slow-sweep.toml", "--quiet", "--out", "out"]);
    wait_for(&mut child, "the folder", |_| bench.path("out").exists());
    kill(&child, "TERM");
    ended(child, 1, &["stopped before the first step of any point: nothing was written"]);
    assert!(!bench.path("out").exists());

    let mixed = "base = \"slow.toml\"\n[set]\n\"checkpoint.every_steps\" = 100\n[grid]\nn_atoms = [108, 100_000]\nr_cut = 2.2\n";
    bench.write("mixed.toml", mixed);
    let sweep = ["sweep", "mixed.toml", "--quiet", "--threads", "2", "--out", "out"];
    let mut child = start(&bench, &sweep);
    wait_for(&mut child, "a checkpoint", |_| !checkpoints(&bench, "out/N108-rc2.2").is_empty());
    kill(&child, "TERM");
    let words = [
        "stopped on request; what is finished is kept",
        "to go on: lennard sweep mixed.toml --out out",
    ];
    ended(child, 4, &words);
    assert!(!bench.path("out/N100000-rc2.2").exists());
}

#[test]
fn studies_that_keep_nothing_say_so_and_leave_no_folder() {
    let bench = bench();
    bench.write(
        "accuracy.toml",
        &SLOW.replace("[truncation]\nr_cut = 2.5", "[accuracy]\ndrift = 1e-5"),
    );
    for (arguments, sentence) in [
        (&["tune", "accuracy.toml"][..], "no lock file was written"),
        (&["study", "bench", "slow.toml", "--out", "out"], "no result was written"),
        (&["study", "stability", "--out", "out"], "no result was written"),
        (&["chart", "slow.toml", "--out", "out"], "no point was measured"),
    ] {
        let mut child = start(&bench, &[arguments, &["--quiet"]].concat());
        if arguments.contains(&"out") && arguments[1] != "bench" {
            wait_for(&mut child, "the folder", |_| bench.path("out").exists());
        } else {
            wait_until_it_listens(&mut child, 15);
        }
        kill(&child, "TERM");
        ended(child, 1, &[sentence]);
        assert!(!bench.path("out").exists(), "{arguments:?}");
        assert!(!bench.path("accuracy.lock.toml").exists());
    }
}
