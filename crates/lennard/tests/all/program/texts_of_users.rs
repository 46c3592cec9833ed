//! Names, keys and paths of a user: none leaves its folder, reaches a shell as a command, or steers the terminal.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Output};

use crate::program::common::*;

const SWEEP: &str = "base = \"liquid.toml\"\n[grid]\ntemperature = [1.0, 1.5]\n";

fn place() -> Place {
    Place::with(&[("liquid.toml", FLUID), ("sweep.toml", SWEEP)])
}

/// Refused as input, and nothing that steers a terminal was printed.
fn refused(output: &Output, words: &[&str]) {
    ended(output, 2, words);
    is_shown(output);
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
    let names = "../../evil /evil/place a/b .. .hidden x\\ntouch\\u0020evil $(touch) \\u001b[31m";
    for name in names.split(' ').chain(["$(touch evil)", "a b", ""]) {
        place.write("named.toml", &format!("name = \"{name}\"\n{SWEEP}"));
        for more in ["", "--out out --emit parallel"] {
            let output = place.output(&format!("sweep named.toml {more}"));
            refused(&output, &["`name` is not allowed", "at most 200 letters, digits"]);
        }
        place.write("scene.toml", &format!("name = \"{name}\"\n{FLUID}"));
        refused(&place.output("run scene.toml"), &["`name` is not allowed"]);
    }
    assert!(!place.has("runs") && !place.has("out"));
    // A file of any name gives a name.
    fs::rename(place.path("sweep.toml"), place.path("my $(x).toml")).unwrap();
    place.succeed("sweep 'my $(x).toml' --quiet");
    assert!(place.has("runs/my---x--1/table.csv"));
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
        let mut command = place.command(&format!("sweep sweep.toml --emit {scheduler}"));
        let output = command.args(["--out", hostile]).output().unwrap();
        ended(&output, 0, &[]);
        is_shown(&output);
        place.write("script", &stdout(&output));
        place.write("said", "");
        let mut bash = Command::new("bash");
        let bash = bash.arg("script").current_dir(place.root()).env("PATH", &path);
        success(bash.env("SLURM_ARRAY_TASK_ID", "0").env("SLURM_CPUS_PER_TASK", "1"));
        let said = place.read("said");
        let said: Vec<&str> = said.split_terminator('\0').collect();
        let (before, rest) = (["sweep", "sweep.toml", "--out", hostile], &said[4..]);
        assert_eq!(said[..4], before);
        assert_eq!(rest[..5], ["--quiet", "--threads", "1", "--point", "0"]);
        assert!(!place.has("evil"), "{scheduler}");
    }
    let braces = place.output("sweep sweep.toml --out a{b} --emit snakemake");
    let words = ["writing the script", "Snakemake cannot name the output folder", "no braces"];
    refused(&braces, &words);
    place.refused("sweep sweep.toml --emit slurm", &["--out"]);
    let mut command = place.command("sweep sweep.toml --emit snakemake --set name=\"{x}\"");
    let script = success(command.args(["--out", "a'\"b"]));
    assert!(script.contains(r#"output: touch("a'\"b/.tasks/{task}")"#), "{script}");
    assert!(script.contains("{{x}}"), "{script}");
}

#[test]
fn what_a_user_wrote_is_shown_and_steers_no_terminal() {
    let place = place();
    let scenes = [
        format!("\"\\u001b[31mx\\u009b\\nerror: y\" = 1\n{FLUID}"),
        FLUID.replace("n_atoms", "\"\\u001b]0;x\\u0007n_atoms\""),
        FLUID.replace("[truncation]", "[\"\\u202etruncation\"]"),
        format!("{FLUID}[[species]]\nname = \"\\u001b[2J\"\n"),
        format!("{FLUID}[[species]]\nname = \"A\"\n[mixing]\nrule = \"\\u001b\"\n"),
        format!("{FLUID}\u{1b}[31m = 1\n"),
        FLUID.replace("\"production\"", "\"\\u001b[31m\""),
    ];
    for scene in scenes {
        place.write("hostile.toml", &scene);
        let output = place.output("plan hostile.toml");
        refused(&output, &[]);
        let lines = stderr(&output);
        assert!(lines.lines().skip(1).all(|line| line.starts_with("  ")), "{lines}");
    }
    place.write("hostile.toml", &format!("\"\\u001b[31m\" = 1\n{SWEEP}"));
    refused(&place.output("sweep hostile.toml"), &[]);
    let path = "\u{1b}[31m\nerror: \u{202e}.toml";
    place.write(path, FLUID);
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
        is_shown(&place.command("").args(arguments).output().unwrap());
    }
}

#[test]
fn force_removes_what_the_run_wrote_and_nothing_else() {
    let place = place();
    let own = "data.csv notes.json other.toml start.xyz msd.csv checkpoint.lennard movie.xtc .notes.csv.partial";
    for name in own.split(' ') {
        place.write(&format!("out/{name}"), "mine");
    }
    let run = "run liquid.toml --quiet --force --out out";
    let rdf = "--set 'observable=[{ kind = \"rdf\", every = 5 }]'";
    place.succeed(&format!("{run} {rdf} --set output.trajectory_every=10"));
    assert!(place.has("out/rdf.csv") && place.has("out/trajectory.xyz"));
    contains(&place.read("out/run.json"), &["\"rdf.csv\""]);
    place.write("out/.rdf.csv.partial", "half");
    place.succeed(run);
    for name in own.split(' ') {
        assert_eq!(place.read(&format!("out/{name}")), "mine", "{name}");
    }
    for gone in ["rdf.csv", "trajectory.xyz", "topology.gro", ".rdf.csv.partial"] {
        assert!(!place.has(&format!("out/{gone}")), "{gone}");
    }
}

#[test]
fn a_plan_says_what_speaks_against_the_run() {
    let place = place();
    let said = |set: &str| {
        let set = "--set stage.production.thermostat=bussi ".to_owned() + set;
        place.succeed(&format!("plan liquid.toml {set}"))
    };
    let long = |set: &str| said(&format!("--set stage.production.steps=100000 {set}"));
    let calm = long("");
    for words in ["stability limit", "the state", "will have no error"] {
        assert!(!calm.contains(words), "{calm}");
    }
    let fast = "dt = 0.02 τ of the stage production is above a quarter of the stability limit";
    contains(&long("--set integrator.dt=0.02"), &[fast]);
    for (density, words) in [
        ("0.3", "inside the vapor–liquid dome"),
        ("0.98", "denser than the freezing liquid"),
        ("1.1", "above melting: the crystal is stable"),
    ] {
        let cold = "--set system.temperature=0.9 --set truncation.r_cut=2.0";
        contains(&long(&format!("{cold} --set system.density={density}")), &[words]);
    }
    contains(&said("--set stage.production.steps=20"), &["no mean will have an error: "]);
    let viscosity = "--set 'observable=[{ kind = \"shear-viscosity\", window = 50 }]'";
    let words = "shear-viscosity will have no error: 400.0 τ are measured where 1000.0 τ";
    contains(&long(viscosity), &[words]);
    let run =
        place.output("run liquid.toml --set stage.production.steps=20 --set integrator.dt=0.015");
    contains(&stdout(&run), &["above a quarter of the stability limit"]);
}
