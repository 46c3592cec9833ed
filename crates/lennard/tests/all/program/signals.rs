//! Signals before there is anything to keep: the program ends at once, says so, and leaves nothing behind.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::program::common::*;

/// A start that takes seconds: particles at random, relaxed.
const SLOW: &str = "[start]\nkind = \"random\"\n[system]\nn_atoms = 100_000\ndensity = 0.7\ntemperature = 1.2\n\
                    [truncation]\nr_cut = 2.5\n[[stage]]\nname = \"production\"\nsteps = 1_000_000_000\n";

/// The signals that may come while a run starts, as `kill` and as numbers.
const SIGNALS: [(&str, u32); 3] = [("INT", 2), ("TERM", 15), ("HUP", 1)];

fn bench() -> Place {
    let small = FLUID.replace("steps = 200", "steps = 1_000_000_000");
    let small = format!("{small}[checkpoint]\nevery_steps = 100\n");
    Place::with(&[("slow.toml", SLOW), ("small.toml", &small)])
}

/// Starts it with SIGHUP as a terminal leaves it. Tests that run under `nohup` pass SIGHUP on as ignored, and a run
/// would rightly ignore it too.
fn start(bench: &Place, line: &str) -> Child {
    let mut command = Command::new("env");
    command.args(["--default-signal=HUP", env!("CARGO_BIN_EXE_lennard")]).args(words(line));
    spawn(bench, &mut command)
}

fn spawn(bench: &Place, command: &mut Command) -> Child {
    command.current_dir(bench.root()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The step of the last checkpoint in a folder, 0 where there is none.
fn last_step(bench: &Place, folder: &str) -> u64 {
    let all = lennard_io::CheckpointFolder::new(&bench.path(folder)).list().unwrap_or_default();
    all.first().map_or(0, |(step, _)| *step)
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

/// Sends a signal, and wants the end to have this exit code and these words.
#[track_caller]
fn stopped(child: Child, signal: &str, code: i32, words: &[&str]) {
    kill(&child, signal);
    ended(&child.wait_with_output().unwrap(), code, words);
}

#[test]
fn a_run_that_starts_ends_at_once_and_nothing_was_written() {
    let bench = bench();
    for (signal, number) in SIGNALS {
        let mut child = start(&bench, "run slow.toml --quiet --out new/out");
        wait_until_it_listens(&mut child, number);
        stopped(child, signal, 1, &["stopped before the first step: nothing was written"]);
        assert!(!bench.has("new"), "{signal}");
    }
}

/// Proves that a run removes its first files where no step of it can be kept. Nothing else in the folder is removed.
#[test]
fn a_run_whose_first_step_is_under_way_takes_its_files_with_it() {
    let bench = bench();
    // A lattice starts fast; its first step takes longest.
    let scene = SLOW.replace("random", "lattice").replace("100_000", "2_048_000");
    bench.write("large.toml", &scene);
    let mut child = start(&bench, "run large.toml --quiet --out out");
    wait_for(&mut child, "the record", |_| bench.has("out/run.json"));
    stopped(child, "TERM", 1, &["stopped before the first step: nothing was written"]);
    assert!(!bench.has("out"));
}

#[test]
fn a_run_under_way_keeps_its_steps_when_the_terminal_goes_unless_it_was_told_not_to_mind() {
    let bench = bench();
    let mut child = start(&bench, "run small.toml --quiet --out out");
    wait_for(&mut child, "a checkpoint", |_| last_step(&bench, "out") > 0);
    let words = ["stopped on request after step", "to go on: lennard resume out"];
    stopped(child, "HUP", 4, &words);
    // What `nohup` does.
    let script = format!(
        "trap '' HUP; exec '{}' run small.toml --quiet --out other",
        env!("CARGO_BIN_EXE_lennard")
    );
    let mut child = spawn(&bench, Command::new("sh").args(["-c", &script]));
    wait_for(&mut child, "a checkpoint", |_| last_step(&bench, "other") > 0);
    kill(&child, "HUP");
    let step = last_step(&bench, "other");
    wait_for(&mut child, "two checkpoints more", |_| last_step(&bench, "other") >= step + 200);
    stopped(child, "TERM", 4, &["to go on: lennard resume other"]);
}

#[test]
fn a_resume_that_loads_leaves_the_checkpoint_and_says_how_to_go_on() {
    let bench = bench();
    bench.succeed(
        "run small.toml --quiet --out out --set system.n_atoms=256000 --set stage.0.steps=2",
    );
    let before = checkpoints(&bench.path("out"));
    let bytes = fs::read(&before[0]).unwrap();
    for (signal, number) in SIGNALS {
        let mut child = start(&bench, "resume out --quiet --steps 1000000");
        wait_until_it_listens(&mut child, number);
        let words = [
            "stopped before the first step: the checkpoint is untouched",
            "to go on: lennard resume out --steps 1000000",
        ];
        stopped(child, signal, 4, &words);
        assert_eq!(checkpoints(&bench.path("out")), before, "{signal}");
        assert!(fs::read(&before[0]).unwrap() == bytes, "{signal}");
        assert!(!bench.has("out/.lennard-claim"), "{signal}");
    }
}

#[test]
fn a_sweep_gives_up_points_that_start_and_keeps_the_others() {
    let bench = bench();
    bench.write("slow-sweep.toml", "base = \"slow.toml\"\n[grid]\ntemperature = [1.1, 1.2]\n");
    let mut child = start(&bench, "sweep slow-sweep.toml --quiet --out out");
    wait_for(&mut child, "the folder", |_| bench.has("out"));
    let words = ["stopped before the first step of any point: nothing was written"];
    stopped(child, "TERM", 1, &words);
    assert!(!bench.has("out"));

    let mixed = "base = \"slow.toml\"\n[set]\n\"checkpoint.every_steps\" = 100\n[grid]\nn_atoms = [108, 100_000]\nr_cut = 2.2\n";
    bench.write("mixed.toml", mixed);
    let mut child = start(&bench, "sweep mixed.toml --quiet --threads 2 --out out");
    wait_for(&mut child, "a checkpoint", |_| last_step(&bench, "out/N108-rc2.2") > 0);
    let words = [
        "stopped on request; what is finished is kept",
        "to go on: lennard sweep mixed.toml --out out",
    ];
    stopped(child, "TERM", 4, &words);
    assert!(!bench.has("out/N100000-rc2.2"));
}

#[test]
fn studies_that_keep_nothing_say_so_and_leave_no_folder() {
    let bench = bench();
    let accuracy = SLOW.replace("[truncation]\nr_cut = 2.5", "[accuracy]\ndrift = 1e-5");
    bench.write("accuracy.toml", &accuracy);
    for (line, makes_a_folder, sentence) in [
        ("tune accuracy.toml", false, "no lock file was written"),
        ("study bench slow.toml --out out", false, "no result was written"),
        ("study stability --out out", true, "no result was written"),
        ("chart slow.toml --out out", true, "no point was measured"),
    ] {
        let mut child = start(&bench, &format!("{line} --quiet"));
        if makes_a_folder {
            wait_for(&mut child, "the folder", |_| bench.has("out"));
        } else {
            wait_until_it_listens(&mut child, 15);
        }
        stopped(child, "TERM", 1, &[sentence]);
        assert!(!bench.has("out"), "{line}");
        assert!(!bench.has("accuracy.lock.toml"));
    }
}
