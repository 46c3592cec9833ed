//! Names, keys and paths of a user: none leaves its folder, reaches a shell as a command, or steers the terminal.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Output};

use crate::program::common::{Place, lennard_in, stderr, stdout};

const SCENE: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.2\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 20\n";
const SWEEP: &str = "base = \"liquid.toml\"\n[grid]\ntemperature = [1.0, 1.5]\n";

fn place() -> Place {
    Place::with(&[("liquid.toml", SCENE), ("sweep.toml", SWEEP)])
}

/// Refused as input, and nothing that steers a terminal was printed.
fn refused(output: &Output, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{message:?}");
    is_shown(output);
    for word in words {
        assert!(message.contains(word), "wanted {word:?} in\n{message}");
    }
}

/// Nothing that was printed steers a terminal.
fn is_shown(output: &Output) {
    for text in [stdout(output), stderr(output)] {
        let steers = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
        assert!(!text.contains(steers), "{text:?}");
    }
}

#[test]
fn a_sweep_is_named_by_a_name_and_by_nothing_else() {
    let place = place();
    for name in [
        "../../evil",
        "/evil/place",
        "a/b",
        "..",
        ".hidden",
        "x\\ntouch evil",
        "$(touch evil)",
        "a b",
        "\\u001b[31m",
        "",
    ] {
        place.write("named.toml", &format!("name = \"{name}\"\n{SWEEP}"));
        for more in [&[][..], &["--out", "out", "--emit", "parallel"]] {
            let output = place.output(&[&["sweep", "named.toml"], more].concat());
            refused(&output, &["`name` is not allowed", "at most 200 letters, digits"]);
        }
        place.write("scene.toml", &format!("name = \"{name}\"\n{SCENE}"));
        refused(&place.output(&["run", "scene.toml"]), &["`name` is not allowed"]);
    }
    assert!(!place.path("runs").exists() && !place.path("out").exists());
    // A file of any name gives a name.
    fs::rename(place.path("sweep.toml"), place.path("my $(x).toml")).unwrap();
    let output = place.output(&["sweep", "my $(x).toml", "--quiet"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(place.path("runs/my---x--1/table.csv").exists());
}

/// Proves with stand-ins for the programs that each task gets the arguments that the sweep was given.
#[test]
fn scripts_give_every_argument_as_it_was_and_do_nothing_else() {
    let place = place();
    let hostile = "out'\"$(touch evil)`touch evil`\n;touch evil {} {#} {= print =} \\ ü";
    fs::create_dir(place.path("bin")).unwrap();
    let stand_in = |name: &str, text: &str| {
        let file = format!("bin/{name}");
        place.write(&file, &format!("#!/bin/bash\n{text}"));
        let mode = fs::Permissions::from_mode(0o755);
        fs::set_permissions(place.path(&file), mode).unwrap();
    };
    stand_in("lennard", "printf '%s\\0' \"$@\" >> said\n");
    stand_in("parallel", "while read -r n; do \"${@: -1}\" \"$n\"; done\n");
    let path = format!("bin:{}", std::env::var("PATH").unwrap());
    for scheduler in ["parallel", "slurm"] {
        let arguments = ["sweep", "sweep.toml", "--out", hostile, "--emit", scheduler];
        let output = place.output(&arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        is_shown(&output);
        place.write("script", &stdout(&output));
        place.write("said", "");
        let done = Command::new("bash")
            .arg("script")
            .current_dir(place.root())
            .env("PATH", &path)
            .env("SLURM_ARRAY_TASK_ID", "0")
            .env("SLURM_CPUS_PER_TASK", "1")
            .output()
            .unwrap();
        assert!(done.status.success(), "{}", stderr(&done));
        let said = place.read("said");
        let said: Vec<&str> = said.split_terminator('\0').collect();
        let task =
            ["sweep", "sweep.toml", "--out", hostile, "--quiet", "--threads", "1", "--point", "0"];
        assert_eq!(said[..task.len()], task);
        assert!(!place.path("evil").exists(), "{scheduler}");
    }
    let braces = ["sweep", "sweep.toml", "--out", "a{b}", "--emit", "snakemake"];
    refused(&place.output(&braces), &["Snakemake cannot name the output folder"]);
    let quotes =
        ["sweep", "sweep.toml", "--out", "a'\"b", "--set", "name=\"{x}\"", "--emit", "snakemake"];
    let script = stdout(&place.output(&quotes));
    assert!(script.contains(r#"output: touch("a'\"b/.tasks/{task}")"#), "{script}");
    assert!(script.contains("{{x}}"), "{script}");
}

#[test]
fn what_a_user_wrote_is_shown_and_steers_no_terminal() {
    let place = place();
    let scenes = [
        format!("\"\\u001b[31mx\\u009b\\nerror: y\" = 1\n{SCENE}"),
        SCENE.replace("n_atoms", "\"\\u001b]0;x\\u0007n_atoms\""),
        SCENE.replace("[truncation]", "[\"\\u202etruncation\"]"),
        format!("{SCENE}[[species]]\nname = \"\\u001b[2J\"\n"),
        format!("{SCENE}[[species]]\nname = \"A\"\n[mixing]\nrule = \"\\u001b\"\n"),
        format!("{SCENE}\u{1b}[31m = 1\n"),
        SCENE.replace("\"production\"", "\"\\u001b[31m\""),
    ];
    for scene in scenes {
        place.write("hostile.toml", &scene);
        let output = place.output(&["plan", "hostile.toml"]);
        refused(&output, &[]);
        let lines = stderr(&output);
        assert!(lines.lines().skip(1).all(|line| line.starts_with("  ")), "{lines}");
    }
    place.write("hostile.toml", &format!("\"\\u001b[31m\" = 1\n{SWEEP}"));
    refused(&place.output(&["sweep", "hostile.toml"]), &[]);
    let path = "\u{1b}[31m\nerror: \u{202e}.toml";
    place.write(path, SCENE);
    for arguments in [
        &["plan", path][..],
        &["run", path, "--out", "\u{1b}[31mout"],
        &["run", path, "--set", "\u{1b}[31m=1"],
        &["run", "\u{1b}[31m-gone"],
        &["resume", "\u{1b}[31m-gone"],
        &["plan", path, "--\u{1b}[31m"],
        &["\u{1b}[31m"],
        &["compare", "\u{1b}[31mout", "--json"],
    ] {
        is_shown(&lennard_in(place.root(), arguments));
    }
}

#[test]
fn force_removes_what_the_run_wrote_and_nothing_else() {
    let place = place();
    let own = [
        "data.csv",
        "notes.json",
        "other.toml",
        "start.xyz",
        "msd.csv",
        "checkpoint.lennard",
        "movie.xtc",
        ".notes.csv.partial",
    ];
    fs::create_dir(place.path("out")).unwrap();
    for name in own {
        place.write(&format!("out/{name}"), "mine");
    }
    let run = |more: &[&str]| {
        let run = ["run", "liquid.toml", "--quiet", "--force", "--out", "out"];
        let output = place.output(&[&run, more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    };
    let rdf = ["--set", "observable=[{ kind = \"rdf\", every = 5 }]"];
    run(&[&rdf[..], &["--set", "output.trajectory_every=10"]].concat());
    assert!(place.path("out/rdf.csv").exists() && place.path("out/trajectory.xyz").exists());
    assert!(place.read("out/run.json").contains("\"rdf.csv\""));
    place.write("out/.rdf.csv.partial", "half");
    run(&[]);
    for name in own {
        assert_eq!(place.read(&format!("out/{name}")), "mine", "{name}");
    }
    for gone in ["rdf.csv", "trajectory.xyz", "topology.gro", ".rdf.csv.partial"] {
        assert!(!place.path(&format!("out/{gone}")).exists(), "{gone}");
    }
}

#[test]
fn a_file_that_is_missing_is_named_and_the_way_on_works() {
    let place = place();
    let run =
        ["run", "liquid.toml", "--quiet", "--out", "out", "--set", "output.trajectory_every=10"];
    assert!(place.output(&run).status.success());
    fs::remove_file(place.path("out/trajectory.xyz")).unwrap();
    let output = place.output(&["resume", "out", "--steps", "10"]);
    let message = stderr(&output);
    assert!(message.contains("trajectory.xyz: cannot go on after byte"), "{message}");
    assert!(message.contains("the file is not there"), "{message}");
    assert!(
        message.contains("to start again: lennard run out/scene.toml --out FOLDER"),
        "{message}"
    );
    assert!(
        !message.contains("folder is gone") && !message.contains("lennard resume"),
        "{message}"
    );
    let again = ["run", "out/scene.toml", "--quiet", "--out", "again"];
    assert!(place.output(&again).status.success());
    // The first file cannot be written: nothing can be resumed.
    fs::create_dir_all(place.path("full/thermo.csv/x")).unwrap();
    let output = place.output(&["run", "liquid.toml", "--quiet", "--force", "--out", "full"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("no step is kept: give the same command again"), "{message}");
    assert!(!message.contains("resume"), "{message}");
}

#[test]
fn a_plan_says_what_speaks_against_the_run() {
    let place = place();
    let said = |set: &[&str]| {
        let sets = set.iter().flat_map(|set| ["--set", *set]);
        let arguments: Vec<&str> = ["plan", "liquid.toml"].into_iter().chain(sets).collect();
        let output = place.output(&arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    let bath = "stage.production.thermostat=bussi";
    let long = ["stage.production.steps=100000", bath];
    let with = |more: &[&'static str]| said(&[&long[..], more].concat());
    let calm = with(&[]);
    for words in ["stability limit", "the state", "will have no error"] {
        assert!(!calm.contains(words), "{calm}");
    }
    let fast = with(&["integrator.dt=0.02"]);
    assert!(
        fast.contains(
            "dt = 0.02 τ of the stage production is above a quarter of the stability limit"
        ),
        "{fast}"
    );
    for (set, words) in [
        ("system.density=0.3", "inside the vapor–liquid dome"),
        ("system.density=0.98", "denser than the freezing liquid"),
        ("system.density=1.1", "above melting: the crystal is stable"),
    ] {
        let told = with(&["system.temperature=0.9", set, "truncation.r_cut=2.0"]);
        assert!(told.contains(words), "{set}: {told}");
    }
    assert!(said(&[bath]).contains("no mean will have an error: "), "{}", said(&[bath]));
    let viscosity = "observable=[{ kind = \"shear-viscosity\", window = 50 }]";
    assert!(
        with(&[viscosity])
            .contains("shear-viscosity will have no error: 400.0 τ are measured where 1000.0 τ")
    );
    let run = place.output(&["run", "liquid.toml", "--set", "integrator.dt=0.015"]);
    assert!(stdout(&run).contains("above a quarter of the stability limit"), "{}", stdout(&run));
}

#[test]
fn snakemake_names_no_folder_with_braces() {
    let place = place();
    let arguments = ["sweep", "sweep.toml", "--emit", "snakemake", "--out", "a{b}"];
    let output = lennard_in(place.root(), &arguments);
    refused(
        &output,
        &["writing the script", "Snakemake cannot name the output folder", "no braces"],
    );
}
