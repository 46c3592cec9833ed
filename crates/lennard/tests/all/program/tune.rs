//! `lennard tune` and what comes of it: a lock file that `run` and `plan` take, and that no other scene may use.

use serde_json::Value;

use crate::program::common::*;

/// A dilute supercritical fluid, whose errors a few seconds tell, with wishes that are easy to meet.
const SCENE: &str = r#"# A fluid with an accuracy in place of settings.
accuracy = { potential_energy = 0.03, pressure = 0.02, drift = 1e-3 }

[system]
n_atoms = 500
density = 0.3
temperature = 2.0

[[stage]]
name = "equilibrate"
steps = 500
thermostat = "bussi"

[[stage]]
name = "production"
steps = 300
"#;

/// As short as it may be.
const TUNE: &str = "tune asking.toml --quiet --seconds 5";

fn place(scene: &str) -> Place {
    Place::with(&[("asking.toml", scene)])
}

/// Each predicted error is within its target, and so is the measured one, within four of its own errors.
fn keep_their_targets(rows: &[Value]) {
    for row in rows {
        let of = |key: &str| number(&row[key]);
        assert!(of("predicted").abs() <= of("target"), "{row}");
        let margin = 4.0 * of("measured_error");
        assert!(of("measured").abs() <= of("target") + margin, "{row}");
    }
}

#[test]
fn a_tuned_scene_runs_with_its_lock_and_always_to_the_same_bits() {
    let place = place(SCENE);
    place.refused("run asking.toml", &["`accuracy` needs settings", "lennard tune"]);
    let tuning = place.json(TUNE);
    assert_eq!(tuning["schema"], "lennard-tune/1");
    let rows = tuning["rows"].as_array().unwrap();
    let keys: Vec<&str> = rows.iter().map(|r| r["quantity"].as_str().unwrap()).collect();
    assert_eq!(keys, ["potential_energy", "pressure", "drift"]);
    keep_their_targets(rows);
    // What is safest costs more, and what is chosen no more than what most people take.
    let cost = |key: &str| number(&tuning[key]["pair_forces_per_atom_tau"]);
    assert!(cost("cost") < cost("usual_cost") && cost("usual_cost") < cost("safest_cost"));
    let text = place.read("asking.lock.toml");
    contains(&text, &["lennard-lock/1"]);
    // On this machine now the settings are faster or not, and the lock says where they are not.
    let speed = &tuning["speed"];
    assert!(number(&speed["over_usual"]) > 0.0, "{speed}");
    let is_slower = text.contains("faster than the usual ones on this machine now");
    assert_eq!(speed["is_faster"] == false, is_slower, "{speed}");
    for remark in speed["remarks"].as_array().unwrap() {
        contains(&text, &[remark.as_str().unwrap()]);
    }
    for name in ["first", "second"] {
        let said = place.succeed(&format!("run asking.toml --out {name} --no-report"));
        contains(&said, &["settings from"]);
    }
    place.same("first", "second", &["thermo.csv"]);
    // The folder holds a scene that needs no lock.
    let plan = place.succeed("plan first/scene.toml");
    assert!(!plan.contains("settings from"), "{plan}");

    std::fs::rename(place.path("asking.lock.toml"), place.path("elsewhere.toml")).unwrap();
    let plan = "plan asking.toml --lock elsewhere.toml";
    place.succeed(&format!("{plan} --seed 9"));
    let words = ["`system.density`", "0.3 in the lock, 0.31 in"];
    place.refused(&format!("{plan} --set system.density=0.31"), &words);
    let words = ["`accuracy`", "nothing to take"];
    place.refused("plan fluid/gas --lock elsewhere.toml", &words);
    place.refused("tune fluid/gas --lock elsewhere.toml", &["there is no `accuracy`"]);
}

#[test]
fn a_scene_with_settings_of_its_own_is_told_the_cheapest_for_the_usual_accuracy() {
    let text = SCENE.replace("accuracy", "# accuracy").replace("0.3\n", "0.02\n")
        + "[truncation]\nr_cut = 2.5\n[integrator]\ndt = 0.003\n[kernel]\nprecision = \"double\"\n";
    let place = place(&text);
    let found = place.succeed("tune asking.toml --seconds 5 --set truncation.r_cut=3.5");
    contains(&found, &["no lock is written"]);
    // Nothing beside the scene, and a command that runs: what was fixed beside the file stays, the rest was chosen.
    assert_eq!(std::fs::read_dir(place.root()).unwrap().count(), 1);
    let command = found.lines().rev().find(|l| l.contains("lennard run")).unwrap();
    contains(command, &["--set truncation.r_cut=3.5"]);
    assert_eq!(command.matches("truncation.r_cut=").count(), 1, "{command}");
    // With the space: a step of 0.0033 may be chosen.
    assert!(!command.contains("integrator.dt=0.003 "), "{command}");
    let (_, run) = command.split_once("lennard ").unwrap();
    place.succeed(&format!("{run} --no-report --out out"));
    contains(&place.read("out/scene.toml"), &["r_cut = 3.5"]);
}

#[test]
fn what_cannot_be_met_is_refused_with_what_can_and_leaves_no_lock() {
    let place = place(SCENE);
    let words = ["`accuracy.pressure` cannot be met", "pressure = ", "times the cost"];
    place.refused(&format!("{TUNE} --set accuracy.pressure=1e-9"), &words);
    let contradicts = "--set integrator.dt=0.02 --set accuracy.potential_energy=2e-3";
    let words = ["`integrator.dt` contradicts `accuracy.", "dt left out"];
    place.refused(&format!("{TUNE} {contradicts}"), &words);
    assert!(!place.has("asking.lock.toml"));
    // Before anything is measured.
    let words = ["tuning the scene: ", "the lock file cannot be written there", "no such folder"];
    place.refused("tune asking.toml --lock nowhere/x.lock.toml", &words);
    let words = ["the lock file cannot be written there", "found:   a folder"];
    place.refused("tune asking.toml --lock .", &words);
    let words = ["wanted a number of seconds from 5 to 86400"];
    place.refused("tune asking.toml --seconds 1", &words);
}

/// A scene of something else than atoms, tuned in seconds: the document, and the run of the lock.
fn tuned(scene: &str) -> Value {
    let place = place(scene);
    let tuning = place.json(TUNE);
    contains(&place.succeed("run asking.toml --out out --no-report"), &["settings from"]);
    let dt = number(&tuning["settings"]["dt"]);
    contains(&place.read("out/scene.toml"), &[&format!("dt = {dt}")]);
    keep_their_targets(tuning["rows"].as_array().unwrap());
    tuning
}

#[test]
#[ignore = "half a minute: run by `cargo xtask physics`"]
fn a_mixture_is_tuned_by_its_fastest_pair_and_keeps_its_unit_of_cutoffs() {
    let scene = SCENE.replace("density = 0.3", "density = 0.4")
        + r#"
[[species]]
name = "big"
fraction = 0.8

[[species]]
name = "light"
fraction = 0.2
sigma = 0.9
mass = 0.1

[mixing]
rule = "lorentz-berthelot"

[truncation]
r_cut_in = "pair"
"#;
    let tuning = tuned(&scene);
    let said = tuning["notes"].to_string();
    contains(&said, &["the fastest pair is light–light (σ 0.9, ε 1, masses 0.1 and 0.1)"]);
    // The theory of one fluid judges no mixture.
    assert!(
        said.contains("theory with a band of its own") || said.contains("no equation of state"),
        "{said}"
    );
    assert_eq!(tuning["settings"]["truncation"]["r_cut_in"], "pair");
    assert!(tuning["label"].as_str().unwrap().contains("σ_ab"));
}

#[test]
#[ignore = "half a minute: run by `cargo xtask physics`"]
fn molecules_are_tuned_for_each_molecule_and_say_what_bounds_their_step() {
    let molecules = SCENE.replace("n_atoms = 500", "n_molecules = 256")
        + r#"
[molecule]
bond_length = 0.67

[bonds]
method = "direct"
"#;
    let scene = molecules.replace(
        "potential_energy = 0.03, pressure = 0.02,",
        "potential_energy = 0.3, pressure = 0.2,",
    );
    let tuning = tuned(&scene);
    contains(&tuning["notes"].to_string(), &["bonds (direct) do not limit the step"]);
    assert_eq!(tuning["rows"][0]["unit"], "ε per molecule");
    assert!((number(&tuning["density"]) - 0.3).abs() < 1e-9);
}
