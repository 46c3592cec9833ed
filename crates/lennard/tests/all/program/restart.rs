//! Runs that are stopped, killed, starved or lied to, as a user meets them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::common::{lennard, stderr, stdout, without_a_reader};
use lennard_io::{Checkpoint, read_checkpoint, write_checkpoint};

const SCENE: &str = r#"
[system]
n_atoms = 108
density = 0.8442
temperature = 1.2
[truncation]
kind = "switch"
r_cut = 2.2
[integrator]
dt = 0.002
[[stage]]
name = "production"
steps = 300
[output]
thermo_every = 10
trajectory_every = 20
[checkpoint]
every_steps = 100
"#;

/// Steps of a run that ends by being stopped: hours of them.
const ENDLESS: &str = "stage.production.steps=1000000000";

/// A folder with the scene in it.
struct Bench {
    root: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("liquid.toml"), SCENE).unwrap();
        Self { root }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = lennard(arguments);
        command.current_dir(self.root.path());
        command
    }

    fn run(&self, folder: &str, more: &[&str]) -> Output {
        let arguments = [&["run", "liquid.toml", "--quiet", "--out", folder], more].concat();
        self.command(&arguments).output().unwrap()
    }

    fn resume(&self, folder: &str, more: &[&str]) -> Output {
        self.command(&[&["resume", folder, "--quiet"], more].concat()).output().unwrap()
    }

    /// A run without end, once it has written a checkpoint.
    fn endless(&self, folder: &str) -> Child {
        let child = self
            .command(&["run", "liquid.toml", "--quiet", "--out", folder, "--set", ENDLESS])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while checkpoints(&self.path(folder)).len() < 2 {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint after a minute");
            std::thread::sleep(Duration::from_millis(2));
        }
        child
    }
}

/// Newest first.
fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let all = lennard_io::CheckpointFolder::new(folder).list().unwrap_or_default();
    all.into_iter().map(|(_, path)| path).collect()
}

fn ok(output: &Output) {
    assert!(output.status.success(), "{}{}", stdout(output), stderr(output));
}

/// Wants this exit code, and these words on standard error.
fn refused(output: &Output, code: i32, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
    assert_eq!(stdout(output), "", "{message}");
}

fn change(path: &Path, edit: impl FnOnce(&mut Checkpoint)) {
    let mut checkpoint = read_checkpoint(path).unwrap();
    edit(&mut checkpoint);
    write_checkpoint(path, &checkpoint).unwrap();
}

fn record(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(folder.join("run.json")).unwrap()).unwrap()
}

fn same_results(a: &Path, b: &Path) {
    for file in ["thermo.csv", "trajectory.xyz", "final.xyz"] {
        assert!(
            fs::read(a.join(file)).unwrap() == fs::read(b.join(file)).unwrap(),
            "{file} differs"
        );
    }
}

#[cfg(unix)]
#[test]
fn a_watched_run_has_a_page_while_it_goes_on_and_otherwise_the_same_files() {
    let bench = Bench::new();
    let page = |folder: &str| fs::read_to_string(bench.path(folder).join("report.html"));
    ok(&bench.run("plain", &["--no-report"]));
    ok(&bench.run("watched", &["--watch"]));
    assert!(!page("watched").unwrap().contains("has not finished"));
    for entry in fs::read_dir(bench.path("plain")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let of = |folder: &str| fs::read(bench.path(folder).join(&file)).unwrap();
        // Checkpoints and the record hold the time that the run took.
        let is_timed = file == "run.json" || file.starts_with("checkpoint");
        assert!(is_timed || of("plain") == of("watched"), "{file} differs");
    }
    let arguments = ["run", "liquid.toml", "--watch", "--out", "out", "--set", ENDLESS];
    let child = bench.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while page("out").is_err() || checkpoints(&bench.path("out")).is_empty() {
        assert!(start.elapsed() < Duration::from_secs(60), "no page after a minute");
        std::thread::sleep(Duration::from_millis(2));
    }
    let reaches = |step: u64| format!("has not finished: its rows reach step {step} of 1000000000");
    let early = page("out").unwrap();
    assert!(early.contains("has not finished: its rows reach step"), "{early:.2000}");
    ok(&Command::new("kill").args(["-TERM", &child.id().to_string()]).output().unwrap());
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(4));
    let steps = record(&bench.path("out"))["steps"].as_u64().unwrap();
    let late = page("out").unwrap();
    assert!(late.contains(&reaches(steps / 10 * 10)), "{steps}: {late:.2000}");
    for word in ["<title>T, whole steps</title>", "<title>Pressure</title>"] {
        assert!(late.contains(word), "{word}");
    }
    // The page of a run that goes on is of no more use.
    let output = bench.resume("out", &["--no-report", "--max-walltime", "100ms"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(page("out").is_err());
}

#[cfg(unix)]
#[test]
fn each_signal_stops_with_a_checkpoint_and_exit_code_4_and_the_run_goes_on() {
    for signal in ["TERM", "INT", "USR1"] {
        let bench = Bench::new();
        let child = bench.endless("out");
        ok(&Command::new("kill")
            .args([&format!("-{signal}"), &child.id().to_string()])
            .output()
            .unwrap());
        let output = child.wait_with_output().unwrap();
        refused(&output, 4, &["stopped on request after step", "to go on: lennard resume out"]);
        let out = bench.path("out");
        let stopped = record(&out);
        assert_eq!(stopped["finished"], false);
        assert!(!out.join("final.xyz").exists());
        let steps = stopped["steps"].as_u64().unwrap();
        assert_eq!(read_checkpoint(&checkpoints(&out)[0]).unwrap().metadata.step, steps);
        // It goes on: until its time is up.
        let output = bench.resume("out", &["--max-walltime", "100ms"]);
        refused(&output, 4, &["stopped by --max-walltime after step", "lennard resume out"]);
        assert!(record(&out)["steps"].as_u64().unwrap() > steps);
    }
}

#[test]
fn a_killed_run_goes_on_to_the_same_bytes_on_another_number_of_threads() {
    let bench = Bench::new();
    let steps = ["--set", "stage.production.steps=20000"];
    ok(&bench.run("whole", &steps));
    let arguments = [&["run", "liquid.toml", "--quiet", "--out", "parts"], &steps[..]].concat();
    let mut child = bench.command(&arguments).spawn().unwrap();
    while checkpoints(&bench.path("parts")).len() < 2 {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let output = bench.command(&["resume", "parts", "--threads", "3"]).output().unwrap();
    ok(&output);
    assert!(stdout(&output).contains("goes on after step"), "{}", stdout(&output));
    same_results(&bench.path("whole"), &bench.path("parts"));
    assert_eq!(checkpoints(&bench.path("parts")).len(), 2, "the last two are kept");
}

#[test]
fn a_finished_run_can_be_made_longer() {
    let bench = Bench::new();
    ok(&bench.run("whole", &["--set", "stage.production.steps=500"]));
    ok(&bench.run("parts", &[]));
    ok(&bench.resume("parts", &["--steps", "200"]));
    same_results(&bench.path("whole"), &bench.path("parts"));
    let scene = |folder: &str| fs::read_to_string(bench.path(folder).join("scene.toml")).unwrap();
    assert_eq!(scene("whole"), scene("parts"));
    let output = bench.command(&["resume", "parts"]).output().unwrap();
    assert!(stdout(&output).contains("--steps N goes on for N more"), "{}", stdout(&output));
    same_results(&bench.path("whole"), &bench.path("parts"));
    let output = bench.resume("parts", &["--steps", "1000000000000000"]);
    refused(&output, 2, &["stage.0.steps", "1000000000000500", "allowed"]);
}

#[test]
fn a_resumed_run_may_drop_its_trajectory_and_change_nothing_else_of_its_scene() {
    let bench = Bench::new();
    ok(&bench.run("parts", &["--set", "output.trajectory_every=50"]));
    let frames = || fs::read(bench.path("parts").join("trajectory.xyz")).unwrap();
    let before = frames();
    let change = |change: &str, code: i32, words: &[&str]| {
        refused(&bench.resume("parts", &["--set", change]), code, words);
    };
    let allowed = "allowed: keys of [output] other than thermo_every";
    change("system.density=0.3", 2, &["`system.density`", "0.3", allowed]);
    change("output.fromat=xtc", 2, &["output.fromat", "nearest: format"]);
    change("output.trajectory_every", 2, &["KEY=VALUE"]);
    let more = ["--steps", "100", "--set", "output.trajectory_every=0"];
    ok(&bench.resume("parts", &more));
    assert_eq!(frames(), before);
    ok(&bench.run("whole", &["--set", "stage.production.steps=400"]));
    let last = |folder: &str| fs::read(bench.path(folder).join("final.xyz")).unwrap();
    assert_eq!(last("whole"), last("parts"));
}

#[test]
fn times_and_numbers_that_make_no_sense_are_refused_with_an_example() {
    let bench = Bench::new();
    for text in ["10", "ten minutes", "0s", "-5m", "10x", ""] {
        let output = bench.run("out", &["--max-walltime", text]);
        refused(&output, 2, &["--max-walltime", "such as 90s, 10m, 2h or 1h30m"]);
    }
    refused(&bench.resume("out", &["--steps", "0"]), 2, &["--steps"]);
    assert!(!bench.path("out").exists());
    // Any length is taken: a time longer than clocks can count is no limit.
    ok(&bench.run("out", &["--max-walltime", "500000000000y"]));
}

#[test]
fn a_folder_without_a_run_or_without_a_checkpoint_says_what_to_do() {
    let bench = Bench::new();
    refused(
        &bench.resume("nowhere", &[]),
        2,
        &[
            "nowhere holds no run: it has no scene.toml and no checkpoint",
            "allowed: the output folder of a run, such as runs/gas-1",
        ],
    );
    fs::create_dir(bench.path("empty")).unwrap();
    refused(&bench.resume("empty", &[]), 2, &["empty holds no run"]);
    ok(&bench.run("out", &[]));
    for path in checkpoints(&bench.path("out")) {
        fs::remove_file(path).unwrap();
    }
    let output = bench.resume("out", &[]);
    refused(
        &output,
        2,
        &["holds no checkpoint", "lennard run out/scene.toml --out FOLDER, with another folder"],
    );
    // That command does what it says.
    ok(&bench.command(&["run", "out/scene.toml", "--out", "again", "--quiet"]).output().unwrap());
    refused(&bench.resume("liquid.toml", &[]), 2, &["liquid.toml"]);
}

#[test]
fn a_damaged_checkpoint_is_refused_and_the_older_one_offered_and_taken() {
    let bench = Bench::new();
    ok(&bench.run("whole", &[]));
    ok(&bench.run("out", &[]));
    let [newest, older] = checkpoints(&bench.path("out")).try_into().unwrap();
    let whole = fs::read(&newest).unwrap();
    let mut bytes = whole.clone();
    bytes[whole.len() / 2] ^= 1;
    fs::write(&newest, &bytes).unwrap();
    let offered = [older.file_name().unwrap().to_str().unwrap(), "lennard resume out --older"];
    refused(&bench.resume("out", &[]), 2, &["damaged", offered[0], offered[1]]);
    fs::write(&newest, &whole[..whole.len() - 9]).unwrap();
    refused(&bench.resume("out", &[]), 2, &["truncated or damaged", offered[0], offered[1]]);
    bytes.clone_from(&whole);
    bytes[8] = 99;
    fs::write(&newest, &bytes).unwrap();
    refused(&bench.resume("out", &[]), 2, &["version 99", "reads version 1", offered[1]]);
    fs::write(&newest, "not one of ours").unwrap();
    refused(&bench.resume("out", &[]), 2, &["not a checkpoint of this program", offered[1]]);
    ok(&bench.resume("out", &["--older"]));
    same_results(&bench.path("whole"), &bench.path("out"));
    // Where no other is whole, the way to start again is named.
    for path in checkpoints(&bench.path("out")) {
        fs::write(path, "x").unwrap();
    }
    refused(&bench.resume("out", &[]), 2, &["no older one is whole", "lennard run out/scene.toml"]);
    fs::remove_file(&checkpoints(&bench.path("out"))[1]).unwrap();
    refused(&bench.resume("out", &["--older"]), 2, &["one checkpoint only"]);
}

#[test]
fn a_checkpoint_of_another_scene_or_version_of_the_program_is_refused() {
    let bench = Bench::new();
    ok(&bench.run("out", &[]));
    let newest = checkpoints(&bench.path("out"))[0].clone();
    let scene = bench.path("out").join("scene.toml");
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("density = 0.8442", "density = 0.8")).unwrap();
    let words = [
        "it belongs to another scene than out/scene.toml: ",
        "put the scene file back as the run wrote it, or start a new run from the changed scene",
        "`density = 0.8` in the scene file",
        "`density = 0.8442` in the checkpoint",
    ];
    refused(&bench.resume("out", &[]), 2, &words);
    fs::write(&scene, "no = 1").unwrap();
    refused(&bench.resume("out", &[]), 2, &["another scene", "`no`"]);
    fs::remove_file(&scene).unwrap();
    fs::create_dir(&scene).unwrap();
    refused(&bench.resume("out", &[]), 2, &["another scene", "the file cannot be read: "]);
    // A scene file that is gone comes back from the checkpoint.
    fs::remove_dir(&scene).unwrap();
    ok(&bench.resume("out", &[]));
    assert_eq!(fs::read_to_string(&scene).unwrap(), text);
    change(&newest, |c| c.metadata.program_version = "0.0.7".into());
    refused(
        &bench.resume("out", &[]),
        2,
        &[
            "it was written by version 0.0.7 of this program; this is version",
            env!("CARGO_PKG_VERSION"),
            ", whose steps may have other bits",
            "or start a new run from the state in it",
        ],
    );
}

#[test]
fn another_instruction_set_needs_consent_and_leaves_a_remark() {
    let bench = Bench::new();
    ok(&bench.run("out", &["--set", "neighbor.mode=verlet"]));
    let out = bench.path("out");
    let newest = checkpoints(&out)[0].clone();
    let natural = read_checkpoint(&newest).unwrap().metadata.isa;
    change(&newest, |c| c.metadata.isa = "sse9".into());
    let output = bench.resume("out", &[]);
    refused(
        &output,
        2,
        &[
            "it was made with the instruction set sse9; ",
            ", which gives other bits",
            &format!("go on with {natural}"),
            "bits that may differ: --isa",
        ],
    );
    refused(&bench.resume("out", &["--isa", "sse9"]), 2, &["kernel.isa", "sse9", "portable"]);
    change(&newest, |c| c.metadata.isa = natural.clone());
    ok(&bench.resume("out", &["--isa", &natural]));
    assert!(!record(&out)["remarks"].to_string().contains("bits may differ"));
    if natural != "portable" {
        ok(&bench.resume("out", &["--isa", "portable", "--steps", "100"]));
        let remark =
            format!("with the instruction set portable in place of {natural}: bits may differ");
        assert!(
            record(&out)["remarks"].to_string().contains(&remark),
            "{}",
            record(&out)["remarks"]
        );
        assert_eq!(record(&out)["host"]["isa"], "portable");
        // The remark stays with the run, and so does the instruction set.
        ok(&bench.resume("out", &["--steps", "100"]));
        assert!(record(&out)["remarks"].to_string().contains(&remark));
        assert_eq!(record(&out)["host"]["isa"], "portable");
    }
}

#[test]
fn output_files_that_were_changed_or_removed_are_not_gone_on_with() {
    let bench = Bench::new();
    ok(&bench.run("out", &[]));
    let trajectory = bench.path("out").join("trajectory.xyz");
    let whole = fs::read(&trajectory).unwrap();
    fs::write(&trajectory, &whole[..whole.len() / 2]).unwrap();
    refused(
        &bench.resume("out", &[]),
        1,
        &["trajectory.xyz", "has only", "put the output files back"],
    );
    fs::remove_file(&trajectory).unwrap();
    refused(&bench.resume("out", &[]), 1, &["trajectory.xyz", "No such file"]);
    fs::write(&trajectory, &whole).unwrap();
    let thermo = bench.path("out").join("thermo.csv");
    fs::write(&thermo, format!("another heading\n{}", fs::read_to_string(&thermo).unwrap()))
        .unwrap();
    refused(&bench.resume("out", &[]), 1, &["thermo.csv", "heading"]);
    assert_eq!(fs::read(&trajectory).unwrap(), whole, "a refusal changes nothing");
}

#[test]
fn a_checkpoint_that_does_not_fit_its_own_scene_is_refused() {
    let bench = Bench::new();
    ok(&bench.run("out", &[]));
    let newest = checkpoints(&bench.path("out"))[0].clone();
    let original = read_checkpoint(&newest).unwrap();
    for name in original.archive.arrays.keys() {
        change(&newest, |c| drop(c.archive.arrays.remove(name)));
        let output = bench.resume("out", &[]);
        // What a method need not have (a heat bath's numbers) may be missing; nothing else may, and nothing panics.
        assert!(matches!(output.status.code(), Some(0 | 2)), "{name}: {}", stderr(&output));
        if output.status.code() == Some(2) {
            refused(&output, 2, &["does not fit its own scene", name]);
        }
        write_checkpoint(&newest, &original).unwrap();
    }
    change(&newest, |c| c.metadata.step += 1);
    refused(&bench.resume("out", &[]), 2, &["its state belongs to another step"]);
    change(&newest, |c| c.metadata.files.clear());
    refused(&bench.resume("out", &[]), 2, &["it does not say how long thermo.csv was"]);
}

#[test]
fn a_folder_in_use_is_refused() {
    let bench = Bench::new();
    let mut child = bench.endless("out");
    let output = bench.resume("out", &[]);
    let forced = bench.run("out", &["--force"]);
    let process = format!("process {} is at work there", child.id());
    child.kill().unwrap();
    child.wait().unwrap();
    refused(&forced, 2, &["out is in use", &process]);
    refused(&output, 2, &["out is in use", &process]);
    // Once it is gone, however it went, the folder is free.
    let output = bench.resume("out", &["--max-walltime", "50ms"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn a_file_that_vanishes_stops_the_run_cleanly() {
    let bench = Bench::new();
    let child = bench.endless("out");
    fs::remove_file(bench.path("out").join("trajectory.xyz")).unwrap();
    let output = child.wait_with_output().unwrap();
    refused(
        &output,
        1,
        &["trajectory.xyz: the file was removed or replaced", "leave the output folder alone"],
    );
    assert_eq!(record(&bench.path("out"))["finished"], false);
}

#[cfg(unix)]
#[test]
fn a_full_disk_loses_no_step_where_a_checkpoint_has_room() {
    let bench = Bench::new();
    let steps = "stage.production.steps=3000";
    ok(&bench.run("whole", &["--set", steps, "--set", "checkpoint.every_steps=0"]));
    // 200 blocks of 512 bytes: a checkpoint of 108 particles fits, the trajectory does not.
    let script = format!(
        "ulimit -f 200; exec '{}' run liquid.toml --quiet --out parts --set {steps} --set checkpoint.every_steps=0",
        env!("CARGO_BIN_EXE_lennard")
    );
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(bench.root.path()).output().unwrap();
    refused(
        &output,
        1,
        &[
            "trajectory.xyz: cannot write",
            "whole up to step",
            "to go on from there: lennard resume parts",
        ],
    );
    let trajectory = fs::read_to_string(bench.path("parts").join("trajectory.xyz")).unwrap();
    assert_eq!(trajectory.lines().count() % 110, 0, "whole frames");
    // No checkpoint was asked for: the one that the failure left is enough.
    ok(&bench.resume("parts", &[]));
    same_results(&bench.path("whole"), &bench.path("parts"));
}

#[test]
fn physics_that_fails_leaves_its_state_the_one_before_and_the_last_checkpoint() {
    let bench = Bench::new();
    let more = [
        "--set",
        "integrator.dt=0.03",
        "--set",
        "system.temperature=4",
        "--set",
        "checkpoint.every_steps=1",
    ];
    let output = bench.run("out", &more);
    let words = [
        "the run failed at step",
        "stage `production`, velocity-verlet with dt = 0.03 τ",
        "fastest: particle",
        "likely cause: dt = 0.03 τ is too large",
        "stable below about",
        "saved: out/before-failure.xyz (step",
        "the last good checkpoint is untouched: out/checkpoint-",
    ];
    refused(&output, 3, &words);
    let out = bench.path("out");
    assert_eq!(record(&out)["finished"], false);
    assert!(record(&out)["remarks"].to_string().contains("likely cause"));
    // The state before is a start for another run, with a smaller step.
    let next = SCENE.replace(
        "[system]\nn_atoms = 108\ndensity = 0.8442",
        "start = { kind = \"file\", file = \"out/before-failure.xyz\" }\n[system]",
    );
    fs::write(bench.path("next.toml"), next).unwrap();
    ok(&bench.command(&["run", "next.toml", "--quiet", "--out", "next"]).output().unwrap());
    // The last good checkpoint is whole; going on from it fails in the same way.
    refused(&bench.resume("out", &[]), 3, &["the run failed at step"]);
}

#[test]
fn a_mistyped_temperature_or_density_is_named() {
    let bench = Bench::new();
    let output = bench.run("hot", &["--set", "system.temperature=72200"]);
    refused(&output, 3, &["the temperature is T = 72200 ε/k_B", "check `system.temperature`"]);
    let output =
        bench.run("dense", &["--set", "system.density=8.442", "--set", "truncation.r_cut=1.1"]);
    refused(&output, 3, &["the density is ρ = 8.4420 σ⁻³", "check `system.density`"]);
}

#[cfg(unix)]
#[test]
fn a_reader_who_has_gone_is_no_failure_and_a_full_disk_is() {
    let bench = Bench::new();
    for arguments in [
        &["list", "integrators"][..],
        &["generate", "completions", "bash"],
        &["plan", "liquid.toml"],
        &["run", "liquid.toml", "--out", "out"],
    ] {
        without_a_reader(bench.command(arguments));
    }
    assert_eq!(record(&bench.path("out"))["finished"], true, "the run came to its end");
    // Standard error has no reader either.
    let mut child = bench
        .command(&["run", "liquid.toml", "--out", "out"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2), "the folder exists");
    #[cfg(target_os = "linux")]
    {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = bench.command(&["list", "integrators"]).stdout(full).output().unwrap();
        refused(&output, 1, &["printing on standard output", "No space left"]);
    }
}
