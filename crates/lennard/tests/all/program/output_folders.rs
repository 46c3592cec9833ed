//! Output folders belong to one process at a time, and never take the place of an input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Output, Stdio};

use crate::program::common::*;

/// A folder with a scene and a sweep of it.
fn bench() -> Place {
    let sweep = "base = \"liquid.toml\"\n[grid]\ntemperature = [1.1, 1.3]\n";
    Place::with(&[("liquid.toml", FLUID), ("sweep.toml", sweep)])
}

/// A process that is killed when the test is done with it.
struct AtWork(Child);

impl AtWork {
    /// A command without end, once these files are there.
    fn once(bench: &Place, line: &str, files: &[&str]) -> Self {
        let are_there = || files.iter().all(|file| bench.has(file));
        Self(bench.spawn(line, &files.join(", "), are_there))
    }

    fn words(&self) -> String {
        format!("process {} is at work there", self.0.id())
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
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
    let sweep = "sweep sweep.toml --out out --quiet";
    let endless = format!("{sweep} --threads 2 {ENDLESS}");
    let first = AtWork::once(&bench, &endless, &["out/T1.1/run.json", "out/T1.3/run.json"]);
    let before = contents(&bench.path("out"));
    for more in ["", "--force", "--set system.density=0.7"] {
        let words = ["out is in use", &first.words(), "allowed: another folder"];
        bench.refused(&format!("{sweep} {more}"), &words);
    }
    // A run in the folder of the sweep, and one in the folder of a point at work.
    let run = "run liquid.toml --quiet --force --out";
    for line in [&format!("{run} out"), &format!("{run} out/T1.3"), "resume out/T1.3 --quiet"] {
        bench.refused(line, &[&first.words()]);
    }
    assert!(before == contents(&bench.path("out")), "nothing changed");
    // A killed process claims nothing.
    drop(first);
    // A run in the folder of one point keeps the whole sweep from beginning.
    fs::remove_file(bench.path("out/T1.3/run.json")).unwrap();
    let one = AtWork::once(&bench, &format!("{run} out/T1.3 {ENDLESS}"), &["out/T1.3/run.json"]);
    let words = format!("out/T1.3 is in use: process {}", one.0.id());
    bench.refused(&format!("{sweep} --force"), &[&words]);
    drop(one);
    bench.succeed(&format!("{sweep} --force"));
    assert!(bench.has("out/T1.3/final.xyz"));
}

#[test]
fn of_runs_started_at_once_in_a_new_folder_one_goes_on_and_the_others_are_told() {
    let bench = bench();
    for round in 0..5 {
        let line = format!("run liquid.toml --quiet --out {round}");
        let spawn = |_| {
            let mut command = bench.command(&line);
            command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
        };
        let started: Vec<Child> = (0..4).map(spawn).collect();
        let outputs = started.into_iter().map(|child| child.wait_with_output().unwrap());
        let (done, others): (Vec<Output>, Vec<_>) = outputs.partition(|o| o.status.success());
        assert_eq!(done.len(), 1, "{others:?}");
        for other in others {
            let said = ended(&other, 2, &[]);
            // The first one may be done already when the last one looks.
            assert!(said.contains("is at work there") || said.contains("is not empty"), "{said}");
        }
        assert_eq!(bench.record(&round.to_string())["finished"], true);
        assert!(!bench.has(&format!("{round}/.lennard-claim")));
    }
}

#[test]
fn a_second_chart_of_a_folder_is_refused() {
    let bench = bench();
    let chart = "chart liquid.toml --out out --quiet";
    let first = AtWork::once(&bench, chart, &["out/plan.toml"]);
    for more in ["", "--force"] {
        bench.refused(&format!("{chart} {more}"), &[&first.words()]);
    }
    assert!(bench.has("out/plan.toml"), "it was not cleared");
}

/// Proves that `--force` keeps what a run reads, whichever way the folder is written.
#[cfg(unix)]
#[test]
fn an_input_in_the_output_folder_is_never_replaced() {
    let bench = bench();
    bench.succeed("run liquid.toml --quiet --out start");
    bench.write("study/scene.toml", FLUID);
    bench.write("study/run.json", "{}");
    bench.write("study/start.xyz", &bench.read("start/final.xyz"));
    bench.write("from-file.toml", &fluid_from("study/start.xyz"));
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
        for command in ["run", "chart", "study bench"] {
            let line = format!("{command} {scene} --out {folder} --force --quiet");
            bench.refused(&line, &[input, "lies in the output folder", "allowed: another"]);
            assert!(before == contents(&bench.path("study")), "{command} {scene}");
        }
    }
    // Standing in the folder itself.
    let mut command = bench.command("run scene.toml --out . --force");
    let words = [
        "protecting the input: scene.toml lies in the output folder .",
        "allowed: another output folder; no file that the command reads is replaced or removed",
    ];
    ended(&command.current_dir(bench.path("study")).output().unwrap(), 2, &words);
    assert!(before == contents(&bench.path("study")));
}

#[test]
fn a_sweep_keeps_its_base_and_its_own_file() {
    let bench = bench();
    bench.write("out/T1.1/scene.toml", FLUID);
    bench.write("out/T1.1/run.json", "{}");
    let sweep = "base = \"out/T1.1/scene.toml\"\n[grid]\ntemperature = [1.1]\n";
    bench.write("of-point.toml", sweep);
    let words = ["out/T1.1/scene.toml lies in the output folder out/T1.1"];
    bench.refused("sweep of-point.toml --out out --force", &words);
    assert_eq!(bench.read("out/T1.1/scene.toml"), FLUID);
    // A sweep beside its points is no danger to it.
    bench.write("study/sweep.toml", "base = \"../liquid.toml\"\n[grid]\ntemperature = [1.1]\n");
    bench.succeed("sweep study/sweep.toml --out study --quiet");
    assert!(bench.has("study/T1.1/final.xyz"));
}

#[test]
fn energy_and_tune_write_over_no_input() {
    let bench = bench();
    bench.succeed("run liquid.toml --quiet --out start");
    let from_file = fluid_from("start/final.xyz");
    bench.write("from-file.toml", &from_file);
    let start = bench.bytes("start/final.xyz");
    for file in ["from-file.toml", "./start/../start/final.xyz"] {
        let line = format!("energy from-file.toml --forces {file}");
        bench.refused(&line, &["would be written over by", file]);
    }
    assert_eq!(bench.bytes("start/final.xyz"), start);
    assert_eq!(bench.read("from-file.toml"), from_file);
    bench.succeed("energy from-file.toml --forces forces.xyz");
    let accuracy = FLUID.replace("[truncation]\nr_cut = 2.2", "[accuracy]\ndrift = 1e-4");
    bench.write("accuracy.toml", &accuracy);
    let words = ["accuracy.toml would be written over by ./accuracy.toml"];
    bench.refused("tune accuracy.toml --lock ./accuracy.toml", &words);
    assert_eq!(bench.read("accuracy.toml"), accuracy);
}
