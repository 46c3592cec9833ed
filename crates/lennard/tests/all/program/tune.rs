//! `lennard tune` and what comes of it: a lock file that `run` and `plan` take, and that no other scene may use.

use std::path::Path;

use crate::program::common::{lennard, stderr, succeed};

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
const SHORT: [&str; 2] = ["--seconds", "5"];

fn write_scene(folder: &Path) -> String {
    let path = folder.join("asking.toml");
    std::fs::write(&path, SCENE).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Arguments of a tuning that must be refused, and words that the message must hold.
fn refused(args: &[&str], words: &[&str]) {
    let output = lennard(args).output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    for word in words {
        assert!(message.contains(word), "{args:?}: wanted `{word}` in\n{message}");
    }
}

/// The usual cutoff of 2.5 σ fits half the box of 5³ particles, 2.54 σ, but not half the box of 4·3³.
#[test]
fn a_scene_whose_cutoff_fits_is_not_refused_for_the_usual_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.toml");
    let scene = SCENE
        .replace("n_atoms = 500", "n_atoms = 125")
        .replace("density = 0.3", "density = 0.95")
        .replace("{ potential_energy = 0.03, pressure = 0.02,", "{ potential_energy = 0.5,")
        .replace(
            "[[stage]]\nname = \"equilibrate\"",
            "[start]\nlattice = \"sc\"\n[truncation]\nr_cut = 2\n\n[[stage]]\nname = \"equilibrate\"",
        );
    std::fs::write(&path, scene).unwrap();
    let mut tune = vec!["tune", path.to_str().unwrap(), "--json", "--quiet"];
    tune.extend(SHORT);
    let tuning: serde_json::Value = serde_json::from_str(&succeed(&tune)).unwrap();
    assert_eq!(tuning["settings"]["truncation"]["r_cut"], 2.0);
    assert!(tuning["usual_cost"].is_object());
}

/// Each predicted error is within its target, and so is the measured one, within four of its own errors.
fn keep_their_targets(rows: &[serde_json::Value]) {
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("predicted").abs() <= number("target"), "{row}");
        let margin = 4.0 * number("measured_error");
        assert!(number("measured").abs() <= number("target") + margin, "{row}");
    }
}

#[test]
fn a_tuned_scene_runs_with_its_lock_and_always_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path());
    refused(&["run", &scene], &["`accuracy` needs settings", "lennard tune"]);

    let mut tune = vec!["tune", &scene, "--json", "--quiet"];
    tune.extend(SHORT);
    let tuning: serde_json::Value = serde_json::from_str(&succeed(&tune)).unwrap();
    assert_eq!(tuning["schema"], "lennard-tune/1");
    let rows = tuning["rows"].as_array().unwrap();
    let keys: Vec<&str> = rows.iter().map(|r| r["quantity"].as_str().unwrap()).collect();
    assert_eq!(keys, ["potential_energy", "pressure", "drift"]);
    keep_their_targets(rows);
    // What is safest costs more, and what is chosen no more than what most people take.
    let cost = |key: &str| tuning[key]["pair_forces_per_atom_tau"].as_f64().unwrap();
    assert!(cost("cost") < cost("usual_cost") && cost("usual_cost") < cost("safest_cost"));
    let lock = folder.path().join("asking.lock.toml");
    let text = std::fs::read_to_string(&lock).unwrap();
    assert!(text.contains("lennard-lock/1"));
    // On this machine now the settings are faster or not, and the lock says where they are not.
    let speed = &tuning["speed"];
    assert!(speed["over_usual"].as_f64() > Some(0.0), "{speed}");
    let remarks = speed["remarks"].as_array().unwrap();
    assert_eq!(
        speed["is_faster"] == false,
        text.contains("faster than the usual ones on this machine now"),
        "{speed}"
    );
    for remark in remarks {
        assert!(text.contains(remark.as_str().unwrap()), "{remark}");
    }

    let thermo = |name: &str| {
        let out = folder.path().join(name);
        let text = succeed(&["run", &scene, "--out", out.to_str().unwrap(), "--no-report"]);
        assert!(text.contains("settings from"), "{text}");
        std::fs::read_to_string(out.join("thermo.csv")).unwrap()
    };
    assert_eq!(thermo("first"), thermo("second"));
    // The folder holds a scene that needs no lock.
    let resolved = folder.path().join("first/scene.toml");
    let plan = succeed(&["plan", resolved.to_str().unwrap()]);
    assert!(!plan.contains("settings from"), "{plan}");

    let elsewhere = folder.path().join("elsewhere.toml");
    std::fs::rename(&lock, &elsewhere).unwrap();
    let named = elsewhere.to_str().unwrap();
    succeed(&["plan", &scene, "--lock", named, "--seed", "9"]);
    let denser = ["plan", &scene, "--lock", named, "--set", "system.density=0.31"];
    refused(&denser, &["`system.density`", "0.3 in the lock, 0.31 in"]);
    let plain = "inputs/fluid/gas.toml";
    refused(&["plan", plain, "--lock", named], &["`accuracy`", "nothing to take"]);
    refused(&["tune", plain, "--lock", named], &["there is no `accuracy`"]);
}

#[test]
fn a_scene_with_settings_of_its_own_is_told_the_cheapest_for_the_usual_accuracy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.toml");
    let text = SCENE.replace("accuracy", "# accuracy").replace("0.3\n", "0.02\n")
        + "[truncation]\nr_cut = 2.5\n[integrator]\ndt = 0.003\n[kernel]\nprecision = \"double\"\n";
    std::fs::write(&path, text).unwrap();
    let scene = path.to_str().unwrap();
    let mut tune = vec!["tune", scene, "--set", "truncation.r_cut=3.5"];
    tune.extend(SHORT);
    let found = succeed(&tune);
    assert!(found.contains("no lock is written"), "{found}");
    // Nothing beside the scene, and a command that runs: what was fixed beside the file stays, the rest was chosen.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let command = found.lines().rev().find(|l| l.contains("lennard run")).unwrap();
    let words: Vec<&str> = command.split_whitespace().skip(2).collect();
    assert!(command.contains("--set truncation.r_cut=3.5"), "{command}");
    assert_eq!(command.matches("truncation.r_cut=").count(), 1, "{command}");
    assert!(!command.contains("integrator.dt=0.003"), "{command}");
    let out = folder.path().join("out");
    let mut run = vec!["run", "--no-report", "--out", out.to_str().unwrap()];
    run.extend(words);
    succeed(&run);
    let resolved = std::fs::read_to_string(out.join("scene.toml")).unwrap();
    assert!(resolved.contains("r_cut = 3.5"), "{resolved}");
}

#[test]
fn what_cannot_be_met_is_refused_with_what_can_and_leaves_no_lock() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path());
    let with = |set: &[&'static str]| {
        let mut args = vec!["tune", scene.as_str(), "--quiet"];
        args.extend(SHORT);
        for set in set {
            args.extend(["--set", set]);
        }
        args
    };
    refused(
        &with(&["accuracy.pressure=1e-9"]),
        &["`accuracy.pressure` cannot be met", "pressure = ", "times the cost"],
    );
    refused(
        &with(&["integrator.dt=0.02", "accuracy.potential_energy=2e-3"]),
        &["`integrator.dt` contradicts `accuracy.", "dt left out"],
    );
    assert!(!folder.path().join("asking.lock.toml").exists());
}

#[test]
fn a_lock_that_cannot_be_written_is_refused_before_anything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path());
    let nowhere = folder.path().join("nowhere/x.lock.toml");
    refused(
        &["tune", &scene, "--lock", nowhere.to_str().unwrap()],
        &["tuning the scene: ", "the lock file cannot be written there", "no such folder"],
    );
    refused(
        &["tune", &scene, "--lock", folder.path().to_str().unwrap()],
        &["the lock file cannot be written there", "found:   a folder"],
    );
}

#[test]
fn a_time_too_short_to_tell_anything_is_refused() {
    refused(
        &["tune", "inputs/fluid/accuracy.toml", "--seconds", "1"],
        &["wanted a number of seconds from 5 to 86400"],
    );
}

/// A scene of something else than atoms, tuned in seconds: the document, and the run of the lock.
fn tuned(scene: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tuned.toml");
    std::fs::write(&path, scene).unwrap();
    let path = path.to_str().unwrap();
    let mut tune = vec!["tune", path, "--json", "--quiet"];
    tune.extend(SHORT);
    let tuning: serde_json::Value = serde_json::from_str(&succeed(&tune)).unwrap();
    let out = folder.path().join("out");
    let text = succeed(&["run", path, "--out", out.to_str().unwrap(), "--no-report"]);
    assert!(text.contains("settings from"), "{text}");
    let resolved = std::fs::read_to_string(out.join("scene.toml")).unwrap();
    let dt = tuning["settings"]["dt"].as_f64().unwrap();
    assert!(resolved.contains(&format!("dt = {dt}")), "{dt}: {resolved}");
    keep_their_targets(tuning["rows"].as_array().unwrap());
    tuning
}

fn notes(tuning: &serde_json::Value) -> String {
    tuning["notes"].to_string()
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
    let said = notes(&tuning);
    assert!(
        said.contains("the fastest pair is light–light (σ 0.9, ε 1, masses 0.1 and 0.1)"),
        "{said}"
    );
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
    assert!(notes(&tuning).contains("bonds (direct) do not limit the step"), "{tuning}");
    assert_eq!(tuning["rows"][0]["unit"], "ε per molecule");
    assert!((tuning["density"].as_f64().unwrap() - 0.3).abs() < 1e-9);
}
