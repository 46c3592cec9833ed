//! Runs that are stopped, killed, starved or lied to, as a user meets them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Output, Stdio};

use lennard_io::{Checkpoint, read_checkpoint, write_checkpoint};

use crate::program::common::*;

/// What a run of these tests writes.
const FILES: &str =
    "[output]\nthermo_every = 10\ntrajectory_every = 20\n[checkpoint]\nevery_steps = 100\n";

/// Files without what clocks say.
const RESULTS: &[&str] = &["thermo.csv", "trajectory.xyz", "final.xyz"];

/// A folder with the scene in it.
fn bench() -> Place {
    Place::with(&[("liquid.toml", &format!("{FLUID}{FILES}"))])
}

/// A run of the scene into a folder, which more words may follow.
fn run(place: &Place, folder: &str) -> Output {
    place.output(&format!("run liquid.toml --quiet --out {folder}"))
}

#[track_caller]
fn ran(place: &Place, folder: &str) {
    ended(&run(place, folder), 0, &[]);
}

fn resume(place: &Place, folder: &str) -> Output {
    place.output(&format!("resume {folder} --quiet"))
}

#[track_caller]
fn resumed(place: &Place, folder: &str) {
    ended(&resume(place, folder), 0, &[]);
}

/// Wants a run not to go on, with these words.
#[track_caller]
fn stays(place: &Place, folder: &str, words: &[&str]) {
    let output = resume(place, folder);
    ended(&output, 2, words);
    assert_eq!(stdout(&output), "");
}

fn checkpoints_in(place: &Place, folder: &str) -> Vec<PathBuf> {
    checkpoints(&place.path(folder))
}

/// A run without end, once it has written two checkpoints.
fn endless(place: &Place, folder: &str) -> Child {
    let line = format!("run liquid.toml --quiet --out {folder} {ENDLESS}");
    place.spawn(&line, "checkpoint", || checkpoints_in(place, folder).len() == 2)
}

fn change(path: &Path, edit: impl FnOnce(&mut Checkpoint)) {
    let mut checkpoint = read_checkpoint(path).unwrap();
    edit(&mut checkpoint);
    write_checkpoint(path, &checkpoint).unwrap();
}

#[cfg(unix)]
#[test]
fn a_watched_run_has_a_page_while_it_goes_on_and_otherwise_the_same_files() {
    let place = bench();
    ran(&place, "plain --no-report");
    ran(&place, "watched --watch");
    let page = || place.read("out/report.html");
    assert!(!place.read("watched/report.html").contains("has not finished"));
    for entry in fs::read_dir(place.path("plain")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        // Checkpoints and the record hold the time that the run took.
        if file != "run.json" && !file.starts_with("checkpoint") {
            place.same("plain", "watched", &[&file]);
        }
    }
    let line = format!("run liquid.toml --watch --out out {ENDLESS}");
    let child = place.spawn(&line, "page", || {
        place.has("out/report.html") && !checkpoints_in(&place, "out").is_empty()
    });
    contains(&page(), &["has not finished: its rows reach step"]);
    kill(&child, "TERM");
    ended(&child.wait_with_output().unwrap(), 4, &[]);
    let steps = place.record("out")["steps"].as_u64().unwrap() / 10 * 10;
    let reaches = format!("has not finished: its rows reach step {steps} of 1000000000");
    contains(&page(), &[&reaches, "<title>T, whole steps</title>", "<title>Pressure</title>"]);
    // The page of a run that goes on is of no more use.
    ended(&resume(&place, "out --no-report --max-walltime 100ms"), 4, &[]);
    assert!(!place.has("out/report.html"));
}

#[cfg(unix)]
#[test]
fn each_signal_stops_with_a_checkpoint_and_exit_code_4_and_the_run_goes_on() {
    for signal in ["TERM", "INT", "USR1"] {
        let place = bench();
        let child = endless(&place, "out");
        kill(&child, signal);
        let output = child.wait_with_output().unwrap();
        ended(&output, 4, &["stopped on request after step", "to go on: lennard resume out"]);
        let stopped = place.record("out");
        assert_eq!(stopped["finished"], false);
        assert!(!place.has("out/final.xyz"));
        let steps = stopped["steps"].as_u64().unwrap();
        let newest = &checkpoints_in(&place, "out")[0];
        assert_eq!(read_checkpoint(newest).unwrap().metadata.step, steps);
        // It goes on: until its time is up.
        let output = resume(&place, "out --max-walltime 100ms");
        ended(&output, 4, &["stopped by --max-walltime after step", "lennard resume out"]);
        assert!(place.record("out")["steps"].as_u64().unwrap() > steps);
    }
}

#[test]
fn a_killed_run_goes_on_to_the_same_bytes_on_another_number_of_threads() {
    let place = bench();
    let steps = "--set stage.production.steps=20000";
    ran(&place, &format!("whole {steps}"));
    let line = format!("run liquid.toml --quiet --out parts {steps}");
    let mut child = place.spawn(&line, "checkpoint", || checkpoints_in(&place, "parts").len() == 2);
    child.kill().unwrap();
    child.wait().unwrap();
    contains(&place.succeed("resume parts --threads 3"), &["goes on after step"]);
    place.same("whole", "parts", RESULTS);
    assert_eq!(checkpoints_in(&place, "parts").len(), 2, "the last two are kept");
}

#[test]
fn a_finished_run_can_be_made_longer() {
    let place = bench();
    ran(&place, "whole --set stage.production.steps=400");
    ran(&place, "parts");
    resumed(&place, "parts --steps 200");
    let files = [RESULTS, &["scene.toml"]].concat();
    place.same("whole", "parts", &files);
    contains(&place.succeed("resume parts"), &["--steps N goes on for N more"]);
    place.same("whole", "parts", &files);
    let words = ["stage.0.steps", "1000000000000400", "allowed"];
    stays(&place, "parts --steps 1000000000000000", &words);
}

/// What may change beside the trajectory is asked in the tests of the engine.
#[test]
fn a_resumed_run_may_drop_its_trajectory() {
    let place = bench();
    ran(&place, "parts");
    let before = place.bytes("parts/trajectory.xyz");
    stays(&place, "parts --set output.trajectory_every", &["KEY=VALUE"]);
    resumed(&place, "parts --steps 100 --set output.trajectory_every=0");
    assert_eq!(place.bytes("parts/trajectory.xyz"), before);
}

#[test]
fn times_and_numbers_that_make_no_sense_are_refused_with_an_example() {
    let place = bench();
    for text in ["10", "'ten minutes'", "0s", "-5m", "10x", "''"] {
        let output = run(&place, &format!("out --max-walltime {text}"));
        ended(&output, 2, &["--max-walltime", "such as 90s, 10m, 2h or 1h30m"]);
    }
    stays(&place, "out --steps 0", &["--steps"]);
    assert!(!place.has("out"));
    // Any length is taken: a time longer than clocks can count is no limit.
    ran(&place, "out --max-walltime 500000000000y");
}

#[test]
fn a_folder_without_a_run_or_without_a_checkpoint_says_what_to_do() {
    let place = bench();
    let words = [
        "nowhere holds no run: it has no scene.toml and no checkpoint",
        "allowed: the output folder of a run, such as runs/gas-1",
    ];
    stays(&place, "nowhere", &words);
    fs::create_dir(place.path("empty")).unwrap();
    stays(&place, "empty", &["empty holds no run"]);
    ran(&place, "out");
    for path in checkpoints_in(&place, "out") {
        fs::remove_file(path).unwrap();
    }
    let command = "lennard run out/scene.toml --out FOLDER, with another folder";
    stays(&place, "out", &["holds no checkpoint", command]);
    // That command does what it says.
    place.succeed("run out/scene.toml --out again --quiet");
    stays(&place, "liquid.toml", &["liquid.toml"]);
}

#[test]
fn a_damaged_checkpoint_is_refused_and_the_older_one_offered_and_taken() {
    let place = bench();
    ran(&place, "whole");
    ran(&place, "out");
    let [newest, older] = checkpoints_in(&place, "out").try_into().unwrap();
    let whole = fs::read(&newest).unwrap();
    let [mut turned, mut later] = [(); 2].map(|()| whole.clone());
    turned[whole.len() / 2] ^= 1;
    later[8] = 99;
    let name = older.file_name().unwrap().to_str().unwrap();
    for (bytes, words) in [
        (&turned[..], ["damaged", name]),
        (&whole[..whole.len() - 9], ["truncated or damaged", name]),
        (&later, ["version 99", "reads version 1"]),
        (b"not one of ours", ["not a checkpoint of this program", name]),
    ] {
        fs::write(&newest, bytes).unwrap();
        stays(&place, "out", &[words[0], words[1], "lennard resume out --older"]);
    }
    resumed(&place, "out --older");
    place.same("whole", "out", RESULTS);
    // Where no other is whole, the way to start again is named.
    for path in checkpoints_in(&place, "out") {
        fs::write(path, "x").unwrap();
    }
    stays(&place, "out", &["no older one is whole", "lennard run out/scene.toml"]);
    fs::remove_file(&checkpoints_in(&place, "out")[1]).unwrap();
    stays(&place, "out --older", &["one checkpoint only"]);
}

#[test]
fn a_checkpoint_of_another_scene_or_version_of_the_program_is_refused() {
    let place = bench();
    ran(&place, "out");
    let newest = checkpoints_in(&place, "out")[0].clone();
    let text = place.read("out/scene.toml");
    place.write("out/scene.toml", &text.replace("density = 0.8", "density = 0.7"));
    let words = [
        "it belongs to another scene than out/scene.toml: ",
        "put the scene file back as the run wrote it, or start a new run from the changed scene",
        "`density = 0.7` in the scene file",
        "`density = 0.8` in the checkpoint",
    ];
    stays(&place, "out", &words);
    place.write("out/scene.toml", "no = 1");
    stays(&place, "out", &["another scene", "`no`"]);
    let scene = place.path("out/scene.toml");
    fs::remove_file(&scene).unwrap();
    fs::create_dir(&scene).unwrap();
    stays(&place, "out", &["another scene", "the file cannot be read: "]);
    // A scene file that is gone comes back from the checkpoint.
    fs::remove_dir(&scene).unwrap();
    resumed(&place, "out");
    assert_eq!(place.read("out/scene.toml"), text);
    change(&newest, |c| c.metadata.program_version = "0.0.7".into());
    let words = [
        "it was written by version 0.0.7 of this program; this is version",
        env!("CARGO_PKG_VERSION"),
        ", whose steps may have other bits",
        "or start a new run from the state in it",
    ];
    stays(&place, "out", &words);
}

#[test]
fn another_instruction_set_needs_consent_and_leaves_a_remark() {
    let place = bench();
    ran(&place, "out --set neighbor.mode=verlet");
    let newest = checkpoints_in(&place, "out")[0].clone();
    let natural = read_checkpoint(&newest).unwrap().metadata.isa;
    let remarks = || place.record("out")["remarks"].to_string();
    change(&newest, |c| c.metadata.isa = "sse9".into());
    let words = [
        "it was made with the instruction set sse9; ",
        ", which gives other bits",
        &format!("go on with {natural}"),
        "bits that may differ: --isa",
    ];
    stays(&place, "out", &words);
    stays(&place, "out --isa sse9", &["kernel.isa", "sse9", "portable"]);
    change(&newest, |c| c.metadata.isa = natural.clone());
    resumed(&place, &format!("out --isa {natural}"));
    assert!(!remarks().contains("bits may differ"));
    if natural != "portable" {
        // The remark stays with the run, and so does the instruction set.
        for more in ["--isa portable", ""] {
            resumed(&place, &format!("out --steps 100 {more}"));
            let way =
                format!("the instruction set portable in place of {natural}: bits may differ");
            contains(&remarks(), &[&way]);
            assert_eq!(place.record("out")["host"]["isa"], "portable");
        }
    }
}

#[test]
fn output_files_that_were_changed_or_removed_are_not_gone_on_with() {
    let place = bench();
    ran(&place, "out");
    let fails = |words: &[&str]| ended(&resume(&place, "out --steps 10"), 1, words);
    let trajectory = place.path("out/trajectory.xyz");
    let whole = fs::read(&trajectory).unwrap();
    fs::write(&trajectory, &whole[..whole.len() / 2]).unwrap();
    fails(&["trajectory.xyz", "has only", "put the output files back"]);
    fs::remove_file(&trajectory).unwrap();
    let again = "to start again: lennard run out/scene.toml --out FOLDER";
    let missing = ["trajectory.xyz: cannot go on after byte", "the file is not there", again];
    let said = fails(&missing);
    assert!(!said.contains("folder is gone") && !said.contains("lennard resume"), "{said}");
    fs::write(&trajectory, &whole).unwrap();
    place.write("out/thermo.csv", &format!("another heading\n{}", place.read("out/thermo.csv")));
    fails(&["thermo.csv", "heading"]);
    assert_eq!(fs::read(&trajectory).unwrap(), whole, "a refusal changes nothing");
    // The first file cannot be written: nothing can be resumed.
    fs::create_dir_all(place.path("full/thermo.csv/x")).unwrap();
    let said = ended(&run(&place, "full --force"), 1, &["no step is kept: give the same command"]);
    assert!(!said.contains("resume"), "{said}");
}

/// A disk that is full, played by a limit on the size of files: writes past it fail as they do there.
#[cfg(unix)]
#[test]
fn a_full_disk_loses_no_step_where_a_checkpoint_has_room() {
    let place = bench();
    let long = "--set stage.production.steps=3000 --set checkpoint.every_steps=0";
    ran(&place, &format!("whole {long}"));
    // 200 blocks of 512 bytes: a checkpoint of 108 particles fits, the trajectory does not.
    let line = format!("ulimit -f 200; exec lennard run liquid.toml --quiet --out parts {long}");
    let words = [
        "trajectory.xyz: cannot write",
        "whole up to step",
        "to go on from there: lennard resume parts",
    ];
    ended(&place.shell(&line), 1, &words);
    assert_eq!(place.record("parts")["finished"], false);
    assert!(!place.has("parts/final.xyz"));
    let trajectory = place.read("parts/trajectory.xyz");
    assert!(
        trajectory.ends_with('\n') && trajectory.lines().count().is_multiple_of(110),
        "whole frames"
    );
    // No checkpoint was asked for: the one that the failure left is enough.
    resumed(&place, "parts");
    place.same("whole", "parts", RESULTS);
}

#[test]
fn physics_that_fails_leaves_its_state_the_one_before_and_the_last_checkpoint() {
    let place = bench();
    let hot = "--set integrator.dt=0.03 --set system.temperature=4 --set checkpoint.every_steps=1";
    let words = [
        "the run failed at step",
        "stage `production`, velocity-verlet with dt = 0.03 τ",
        "fastest: particle",
        "likely cause: dt = 0.03 τ is too large",
        "stable below about",
        "saved: out/before-failure.xyz (step",
        "the last good checkpoint is untouched: out/checkpoint-",
    ];
    ended(&run(&place, &format!("out {hot}")), 3, &words);
    let record = place.record("out");
    assert_eq!(record["finished"], false);
    contains(&record["remarks"].to_string(), &["likely cause"]);
    assert!(!place.read("out/thermo.csv").contains("nan"));
    // The state before is a start for another run, with a smaller step.
    place.write("next.toml", &fluid_from("out/before-failure.xyz"));
    place.succeed("run next.toml --quiet --out next --set integrator.dt=0.002");
    // The last good checkpoint is whole; going on from it fails in the same way.
    ended(&resume(&place, "out"), 3, &["the run failed at step"]);
}

#[cfg(unix)]
#[test]
fn a_reader_who_has_gone_is_no_failure_and_a_full_disk_is() {
    let place = bench();
    for line in [
        "list integrators",
        "list observables --json",
        "generate completions bash",
        "plan liquid.toml",
        "plan liquid.toml --json",
        "run liquid.toml --out out",
        "run liquid.toml --out document --json",
    ] {
        without_a_reader(place.command(line));
    }
    for folder in ["out", "document"] {
        assert_eq!(place.record(folder)["finished"], true, "the run came to its end");
    }
    // Standard error has no reader either.
    let mut command = place.command("run liquid.toml --out out");
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2), "the folder exists");
    #[cfg(target_os = "linux")]
    {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = place.command("list integrators").stdout(full).output().unwrap();
        ended(&output, 1, &["printing on standard output", "No space left"]);
    }
}
