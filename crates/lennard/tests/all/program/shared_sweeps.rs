//! A sweep in parts: many processes share its points, one collects, and schedulers get scripts.

use std::io::Write;
use std::process::{Command, Stdio};

use crate::program::common::{Place, lennard, stderr, success};

const BASE: &str = r#"
[system]
n_atoms = 108
density = 0.5
temperature = 1.5
seed = 3

[truncation]
kind = "cut"
r_cut = 2.0

[[stage]]
name = "production"
steps = 600
"#;

const SWEEP: &str =
    "base = \"base.toml\"\n[grid]\ndensity = [0.4, 0.5]\ntemperature = [1.5, 2.0, 2.5]\n";

fn place() -> Place {
    Place::with(&[("base.toml", BASE), ("sweep.toml", SWEEP)])
}

#[test]
fn points_have_numbers_names_and_values() {
    let place = place();
    let listed = success(&mut place.command(&["sweep", "sweep.toml", "--points"]));
    assert_eq!(listed.lines().count(), 6);
    assert!(listed.contains("    5  rho0.5-T2.5\n"), "{listed}");
    let json = success(&mut place.command(&["sweep", "sweep.toml", "--points", "--json"]));
    let points: serde_json::Value = serde_json::from_str(&json).unwrap();
    let points = &points["points"];
    assert_eq!(points[4]["name"], "rho0.5-T2");
    assert_eq!(points[4]["values"]["temperature"], 2);
    assert!(!place.path("runs").exists(), "nothing is written");
    for (wrong, nearest) in [("6", ""), ("rho0.5-T2.4", "\n  nearest: rho0.5-T2.5")] {
        let refused = place.output(&["sweep", "sweep.toml", "--out", "out", "--point", wrong]);
        assert_eq!(refused.status.code(), Some(2));
        let wanted = format!(
            "the sweep: sweep.toml: there is no point `{wrong}`\n  allowed: a number from 0 to 5, or the name of a point{nearest}"
        );
        assert!(stderr(&refused).contains(&wanted), "{}", stderr(&refused));
        assert!(!place.path("out").exists());
    }
}

#[test]
fn a_point_whose_folder_cannot_be_made_is_a_fault_of_the_input() {
    let place = Place::with(&[
        ("base.toml", BASE),
        ("sweep.toml", SWEEP),
        ("out/rho0.4-T1.5", "a file, no folder"),
    ]);
    let ended = place.output(&["sweep", "sweep.toml", "--out", "out", "--quiet"]);
    assert_eq!(ended.status.code(), Some(2), "{}", stderr(&ended));
    assert!(stderr(&ended).contains("rho0.4-T1.5"), "{}", stderr(&ended));
    assert!(place.path("out/rho0.5-T2.5/run.json").exists(), "the others are run");
}

#[test]
fn four_processes_in_any_order_run_each_point_once_and_give_the_table_of_one() {
    let place = place();
    success(&mut place.command(&["sweep", "sweep.toml", "--out", "one", "--quiet"]));
    let orders = [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0], [3, 0, 5, 1, 4, 2], [2, 4, 0, 5, 3, 1]];
    let place = &place;
    let ran: Vec<String> = std::thread::scope(|scope| {
        let loops: Vec<_> = orders
            .iter()
            .map(|order| {
                scope.spawn(move || {
                    let mut finished = Vec::new();
                    for k in order {
                        let point = k.to_string();
                        let ended = place.output(&[
                            "sweep",
                            "sweep.toml",
                            "--out",
                            "many",
                            "--point",
                            &point,
                        ]);
                        let said = String::from_utf8_lossy(&ended.stdout).into_owned();
                        match ended.status.code() {
                            Some(0) => finished.extend(
                                said.lines()
                                    .filter(|l| l.ends_with(": finished"))
                                    .map(str::to_owned),
                            ),
                            Some(2) => assert!(
                                stderr(&ended).contains("is at work there"),
                                "{}",
                                stderr(&ended)
                            ),
                            other => panic!("{other:?}: {}", stderr(&ended)),
                        }
                    }
                    finished
                })
            })
            .collect();
        loops.into_iter().flat_map(|l| l.join().unwrap()).collect()
    });
    let mut once = ran.clone();
    once.sort();
    once.dedup();
    assert_eq!((ran.len(), once.len()), (6, 6), "{ran:?}");
    success(&mut place.command(&["sweep", "sweep.toml", "--out", "many", "--collect"]));
    assert_eq!(place.read("many/table.csv"), place.read("one/table.csv"));
}

#[test]
fn collecting_names_what_is_missing_and_chunks_run_some_points() {
    let place = place();
    let chunk = ["sweep", "sweep.toml", "--out", "out", "--chunk", "4", "--point", "1"];
    success(&mut place.command(&chunk));
    let collected = place.output(&["sweep", "sweep.toml", "--out", "out", "--collect", "--json"]);
    assert_eq!(collected.status.code(), Some(4));
    let wanted = "4 of 6 points are not finished: rho0.4-T1.5, rho0.4-T2, rho0.4-T2.5, rho0.5-T1.5\n  \
        to run them: lennard sweep sweep.toml --out out";
    assert!(stderr(&collected).contains(wanted), "{}", stderr(&collected));
    let record: serde_json::Value = serde_json::from_slice(&collected.stdout).unwrap();
    assert_eq!(record["ending"], "incomplete");
    assert!(record["points"][0]["compared"].is_null());
    assert!(!record["points"][5]["compared"].is_null());
    // The same command as always runs what is missing.
    success(&mut place.command(&["sweep", "sweep.toml", "--out", "out", "--quiet"]));
    success(&mut place.command(&["sweep", "sweep.toml", "--out", "out", "--collect", "--quiet"]));
}

#[test]
fn a_point_that_runs_out_of_time_goes_on_to_the_same_bits() {
    let place = place();
    let long = ["--set", "stage.production.steps=60000"];
    let run = |folder: &str, more: &[&str]| {
        let mut all =
            vec!["sweep", "sweep.toml", "--out", folder, "--point", "rho0.4-T2", "--no-report"];
        all.extend(long.iter().chain(more));
        place.output(&all)
    };
    assert_eq!(run("whole", &[]).status.code(), Some(0));
    let stopped = run("parts", &["--max-walltime", "300ms"]);
    assert_eq!(stopped.status.code(), Some(4), "{}", stderr(&stopped));
    let again = "--set stage.production.steps=60000 --point rho0.4-T2";
    assert!(stderr(&stopped).contains(again), "{}", stderr(&stopped));
    assert_eq!(run("parts", &[]).status.code(), Some(0));
    let last = |folder: &str| place.read(&format!("{folder}/rho0.4-T2/final.xyz"));
    assert_eq!(last("parts"), last("whole"));
}

#[test]
fn a_claim_of_another_machine_is_named_and_nothing_is_run() {
    let place = place();
    std::fs::create_dir_all(place.path("out/rho0.4-T1.5")).unwrap();
    std::fs::write(place.path("out/rho0.4-T1.5/.lennard-claim"), "17\nnode-7\nanother-start\n")
        .unwrap();
    let busy = place.output(&["sweep", "sweep.toml", "--out", "out", "--point", "0"]);
    assert_eq!(busy.status.code(), Some(2));
    let wanted = "rho0.4-T1.5: the output folder out/rho0.4-T1.5 is in use: process 17 on node-7 is at work there";
    assert!(stderr(&busy).contains(wanted), "{}", stderr(&busy));
    assert!(!place.path("out/rho0.4-T1.5/run.json").exists());
}

#[test]
fn scripts_are_read_by_their_shell_and_say_whatever_the_command_said() {
    let place = place();
    let emit = |scheduler: &str| {
        success(&mut place.command(&[
            "sweep",
            "sweep.toml",
            "--out",
            "my runs",
            "--set",
            "system.seed=4",
            "--chunk",
            "2",
            "--emit",
            scheduler,
        ]))
    };
    for scheduler in ["slurm", "parallel"] {
        let script = emit(scheduler);
        let task = "lennard sweep sweep.toml --out 'my runs' --set system.seed=4 --quiet --threads";
        assert!(script.contains(task), "{script}");
        let mut shell = Command::new("bash").arg("-n").stdin(Stdio::piped()).spawn().unwrap();
        shell.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
        assert!(shell.wait().unwrap().success(), "{script}");
    }
    assert!(emit("slurm").contains("#SBATCH --array=0-2\n"));
    assert!(emit("snakemake").contains("task=range(3))"));
    // What the script says of a task works.
    let task = [
        "sweep",
        "sweep.toml",
        "--out",
        "my runs",
        "--set",
        "system.seed=4",
        "--quiet",
        "--threads",
        "1",
        "--point",
        "2",
        "--chunk",
        "2",
    ];
    success(&mut place.command(&task));
    assert!(place.path("my runs/rho0.5-T2.5/final.xyz").exists());
    let without_folder = lennard(&["sweep", "sweep.toml", "--emit", "slurm"]).output().unwrap();
    assert_eq!(without_folder.status.code(), Some(2));
}
