//! Output folders belong to one process at a time, and never take the place of an input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::common::{Place, stderr, stdout};

const SCENE: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.2\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 200\n";

/// Steps of a run that ends by being killed.
const ENDLESS: &str = "stage.production.steps=1000000000";

/// A folder with a scene and a sweep of it.
fn bench() -> Place {
    let sweep = "base = \"liquid.toml\"\n[grid]\ntemperature = [1.1, 1.3]\n";
    Place::with(&[("liquid.toml", SCENE), ("sweep.toml", sweep)])
}

/// A command without end, once `files` are there.
fn at_work(bench: &Place, arguments: &[&str], files: &[&str]) -> AtWork {
    let mut command = bench.command(arguments);
    let command = command.stdout(Stdio::null()).stderr(Stdio::null());
    let child = AtWork(command.spawn().unwrap());
    let start = Instant::now();
    while !files.iter().all(|file| bench.path(file).exists()) {
        assert!(start.elapsed() < Duration::from_secs(60), "no {files:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// A process that is killed when the test is done with it.
struct AtWork(Child);

impl Drop for AtWork {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn refused(output: &Output, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
    assert_eq!(stdout(output), "", "{message}");
}

fn ok(output: &Output) {
    assert!(output.status.success(), "{}", stderr(output));
}

/// Every file below a folder with its bytes except for the claim and the growing tables.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            all.extend(contents(&path));
        } else if name != ".lennard-claim" && name != "thermo.csv" {
            all.push((path.clone(), fs::read(&path).unwrap()));
        }
    }
    all.sort();
    all
}

#[test]
fn a_second_sweep_of_a_folder_is_refused_with_the_process_at_work_and_touches_nothing() {
    let bench = bench();
    let sweep = ["sweep", "sweep.toml", "--out", "out", "--quiet"];
    let endless = [&sweep[..], &["--threads", "2", "--set", ENDLESS]].concat();
    let mut first = at_work(&bench, &endless, &["out/T1.1/run.json", "out/T1.3/run.json"]);
    let before = contents(&bench.path("out"));
    let process = format!("process {} is at work there", first.0.id());
    for more in [&[][..], &["--force"], &["--set", "system.density=0.7"]] {
        let second = bench.output(&[&sweep[..], more].concat());
        refused(&second, &["out is in use", &process, "allowed: another folder"]);
    }
    // A run in the folder of the sweep, and one in the folder of a point at work.
    for folder in ["out", "out/T1.3"] {
        let run = ["run", "liquid.toml", "--quiet", "--force", "--out", folder];
        refused(&bench.output(&run), &[&process]);
    }
    assert!(before == contents(&bench.path("out")), "nothing changed");
    // A killed process claims nothing.
    first.0.kill().unwrap();
    first.0.wait().unwrap();
    // A run in the folder of one point keeps the whole sweep from beginning.
    let run = ["run", "liquid.toml", "--quiet", "--force", "--out", "out/T1.3", "--set", ENDLESS];
    fs::remove_file(bench.path("out/T1.3/run.json")).unwrap();
    let one = at_work(&bench, &run, &["out/T1.3/run.json"]);
    let second = bench.output(&[&sweep[..], &["--force"]].concat());
    refused(&second, &[&format!("out/T1.3 is in use: process {}", one.0.id())]);
    drop(one);
    ok(&bench.output(&[&sweep[..], &["--force"]].concat()));
    assert!(bench.path("out/T1.3/final.xyz").exists());
}

#[test]
fn of_runs_started_at_once_in_a_new_folder_one_goes_on_and_the_others_are_told() {
    let bench = bench();
    for round in 0..5 {
        let folder = format!("out-{round}");
        let run = ["run", "liquid.toml", "--quiet", "--out", &folder];
        let started: Vec<Child> = (0..4)
            .map(|_| {
                let mut command = bench.command(&run);
                command.stderr(Stdio::piped()).stdout(Stdio::piped());
                command.spawn().unwrap()
            })
            .collect();
        let outputs: Vec<Output> =
            started.into_iter().map(|child| child.wait_with_output().unwrap()).collect();
        let (done, others): (Vec<_>, Vec<_>) =
            outputs.iter().partition(|output| output.status.success());
        assert_eq!(done.len(), 1, "{outputs:?}");
        for other in others {
            let message = stderr(other);
            assert_eq!(other.status.code(), Some(2), "{message}");
            // The first one may be done already when the last one looks.
            assert!(
                message.contains("is at work there") || message.contains("is not empty"),
                "{message}"
            );
        }
        let record = fs::read_to_string(bench.path(&folder).join("run.json")).unwrap();
        assert!(record.contains("\"finished\": true"), "{record}");
        assert!(!bench.path(&folder).join(".lennard-claim").exists());
    }
}

#[test]
fn a_second_chart_of_a_folder_is_refused() {
    let bench = bench();
    let chart = ["chart", "liquid.toml", "--out", "out", "--quiet"];
    let first = at_work(&bench, &chart, &["out/plan.toml"]);
    let process = format!("process {} is at work there", first.0.id());
    for more in [&[][..], &["--force"]] {
        refused(&bench.output(&[&chart[..], more].concat()), &[&process]);
    }
    assert!(bench.path("out/plan.toml").exists(), "it was not cleared");
}

/// Proves that `--force` keeps what a run reads, whichever way the folder is written.
#[cfg(unix)]
#[test]
fn an_input_in_the_output_folder_is_never_replaced() {
    let bench = bench();
    ok(&bench.output(&["run", "liquid.toml", "--quiet", "--out", "start"]));
    let start = fs::read(bench.path("start/final.xyz")).unwrap();
    bench.write("study/scene.toml", SCENE);
    bench.write("study/run.json", "{}");
    fs::write(bench.path("study/start.xyz"), &start).unwrap();
    let from_file = SCENE.replace(
        "[system]\nn_atoms = 108\ndensity = 0.8",
        "start = { kind = \"file\", file = \"study/start.xyz\" }\n[system]",
    );
    bench.write("from-file.toml", &from_file);
    std::os::unix::fs::symlink("study", bench.path("link")).unwrap();
    std::os::unix::fs::symlink("study/scene.toml", bench.path("scene-link.toml")).unwrap();
    let before = contents(&bench.path("study"));
    for (scene, folder, input) in [
        ("study/scene.toml", "study", "study/scene.toml"),
        ("study/scene.toml", "./start/../study/", "study/scene.toml"),
        ("study/scene.toml", "link", "study/scene.toml"),
        ("link/scene.toml", "study", "link/scene.toml"),
        ("scene-link.toml", "study", "scene-link.toml"),
        ("from-file.toml", "study", "study/start.xyz"),
    ] {
        for command in [&["run"][..], &["chart"], &["study", "bench"]] {
            let arguments = [command, &[scene, "--out", folder, "--force", "--quiet"]].concat();
            refused(
                &bench.output(&arguments),
                &[input, "lies in the output folder", "allowed: another"],
            );
            assert!(before == contents(&bench.path("study")), "{command:?} {scene}");
        }
    }
    // Standing in the folder itself.
    let output = bench
        .command(&["run", "scene.toml", "--out", ".", "--force"])
        .current_dir(bench.path("study"))
        .output()
        .unwrap();
    let words = [
        "protecting the input: scene.toml lies in the output folder .",
        "allowed: another output folder; no file that the command reads is replaced or removed",
    ];
    refused(&output, &words);
    assert!(before == contents(&bench.path("study")));
}

#[test]
fn a_sweep_keeps_its_base_and_its_own_file() {
    let bench = bench();
    bench.write("out/T1.1/scene.toml", SCENE);
    bench.write("out/T1.1/run.json", "{}");
    let sweep = "base = \"out/T1.1/scene.toml\"\n[grid]\ntemperature = [1.1]\n";
    bench.write("of-point.toml", sweep);
    let output = bench.output(&["sweep", "of-point.toml", "--out", "out", "--force"]);
    refused(&output, &["out/T1.1/scene.toml lies in the output folder out/T1.1"]);
    assert_eq!(fs::read_to_string(bench.path("out/T1.1/scene.toml")).unwrap(), SCENE);
    // A sweep beside its points is no danger to it.
    bench.write("study/sweep.toml", "base = \"../liquid.toml\"\n[grid]\ntemperature = [1.1]\n");
    ok(&bench.output(&["sweep", "study/sweep.toml", "--out", "study", "--quiet"]));
    assert!(bench.path("study/T1.1/final.xyz").exists());
}

#[test]
fn energy_and_tune_write_over_no_input() {
    let bench = bench();
    ok(&bench.output(&["run", "liquid.toml", "--quiet", "--out", "start"]));
    let from_file = SCENE.replace(
        "[system]\nn_atoms = 108\ndensity = 0.8",
        "start = { kind = \"file\", file = \"start/final.xyz\" }\n[system]",
    );
    bench.write("from-file.toml", &from_file);
    let start = fs::read(bench.path("start/final.xyz")).unwrap();
    for file in ["from-file.toml", "./start/../start/final.xyz"] {
        let output = bench.output(&["energy", "from-file.toml", "--forces", file]);
        refused(&output, &["would be written over by", file]);
    }
    assert_eq!(fs::read(bench.path("start/final.xyz")).unwrap(), start);
    assert_eq!(fs::read_to_string(bench.path("from-file.toml")).unwrap(), from_file);
    ok(&bench.output(&["energy", "from-file.toml", "--forces", "forces.xyz"]));
    let accuracy = SCENE.replace("[truncation]\nr_cut = 2.2", "[accuracy]\ndrift = 1e-4");
    bench.write("accuracy.toml", &accuracy);
    let output = bench.output(&["tune", "accuracy.toml", "--lock", "./accuracy.toml"]);
    refused(&output, &["accuracy.toml would be written over by ./accuracy.toml"]);
    assert_eq!(fs::read_to_string(bench.path("accuracy.toml")).unwrap(), accuracy);
}
