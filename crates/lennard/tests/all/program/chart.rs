//! `lennard chart` as a user types it.

use std::path::Path;
use std::process::{Command, Output};

use crate::program::bad_scenes::BadInputs;
use crate::program::common::{lennard, lennard_in};

use serde_json::Value;

/// A small liquid whose measured stage is so short that a quick chart takes seconds.
const SCENE: &str = r#"
[system]
n_atoms = 256
density = 0.8442
temperature = 0.8

[truncation]
r_cut = 2.5

[integrator]
dt = 0.01

[[stage]]
name = "equilibrate"
steps = 200
thermostat = { kind = "bussi", tau = 0.1 }

[[stage]]
name = "production"
steps = 10
"#;

fn chart(folder: &Path, arguments: &[&str]) -> Output {
    lennard_in(folder, &[&["chart", "scene.toml", "--quick"], arguments].concat())
}

fn folder(scene: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    folder
}

fn document(output: &Output) -> Value {
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn panel<'a>(chart: &'a Value, name: &str) -> &'a Value {
    let panels = chart["panels"].as_array().unwrap();
    panels.iter().find(|p| p["name"] == name).unwrap()
}

/// The first picture of a page has these errors, marks the scene's own settings, and says how cost is counted.
fn first_picture(out: &Path, errors: &[&str]) {
    let svg = std::fs::read_to_string(out.join("figures/overview.svg")).unwrap();
    for words in errors.iter().chain(&["scene"]) {
        assert!(svg.contains(words), "{words}");
    }
    let html = std::fs::read_to_string(out.join("report.html")).unwrap();
    let first = html.split("<figcaption>").nth(1).unwrap();
    assert!(first.contains("Left is cheap and low is right"), "{first:.200}");
    let at = |part: &str| html.find(part).unwrap_or_else(|| panic!("{part}"));
    assert!(
        at("<svg") < at("<table") && at("<table") < at("<details>"),
        "errors against cost come first"
    );
    // Of all rows none answers, or one sentence stands in their place.
    let unresolved = html.matches("not resolved by this chart").count();
    let resolved = html.matches("itself</td>").count() + html.matches(" ×</td>").count();
    assert!(unresolved == 0 || resolved > 0 || html.contains("cannot tell the settings apart"));
    // Where clocks are disturbed, axis and page say how cost is counted.
    let is_of_forces = svg.contains("pair forces per atom");
    assert_eq!(is_of_forces, svg.contains("clocks were disturbed"));
    assert_eq!(is_of_forces, first.contains("cost is counted in pair forces"));
}

#[test]
fn a_chart_has_everything_goes_on_where_it_stopped_and_refuses_other_folders() {
    let place = folder(SCENE);
    let out = place.path().join("out");
    let first = document(&chart(place.path(), &["--out", "out", "--json", "--quiet"]));
    assert_eq!(first["finished"], true);

    // Three times the scene's step blows up, and that is a mark with its reason, not a gap.
    let marks = panel(&first, "energy-drift")["marks"].as_array().unwrap();
    let failed: Vec<&Value> = marks.iter().filter(|m| m["error"].is_null()).collect();
    assert!(!failed.is_empty() && failed.len() < marks.len());
    for mark in failed {
        assert!(mark["failure"].as_str().unwrap().contains("failed at step"));
        assert!(mark["wall"].as_f64().unwrap() > 0.0);
    }
    // Mixed precision errs more in the forces than double, and every panel has a front.
    let forces = panel(&first, "forces-same-model")["marks"].as_array().unwrap();
    let precision = |n: &Value| {
        let points = first["points"].as_array().unwrap();
        let point = points.iter().find(|p| p["number"] == *n).unwrap();
        point["settings"]["precision"].as_str().unwrap().to_owned()
    };
    for mark in forces {
        let error = mark["error"].as_f64().unwrap();
        let is_mixed = precision(&mark["number"]) == "mixed";
        assert_eq!(error > 1e-10, is_mixed, "{mark}");
    }
    for panel in first["panels"].as_array().unwrap() {
        let name = panel["name"].as_str().unwrap();
        let marks = panel["marks"].as_array().unwrap();
        assert!(marks.iter().any(|m| m["on_wall_front"] == true), "{name}");
        assert!(out.join(format!("{name}.csv")).exists(), "{name}");
        for kind in ["wall", "forces"] {
            let svg = out.join(format!("figures/{name}-{kind}.svg"));
            let text = std::fs::read_to_string(&svg).unwrap();
            assert!(text.contains("Pareto front") && text.contains("<title>"), "{name}");
        }
    }
    let html = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(html.contains("Point at a mark") && html.matches("<script>").count() == 1);
    assert!(!html.contains("http-equiv") && !html.contains("src=\"http"));

    first_picture(&out, &["P / (ε/σ³)", "U / ε", "forces (relative)"]);

    // The usual settings stand beside the settings of the scene, and both are named.
    let usual = &first["points"][1]["settings"];
    assert_eq!(usual["truncation"]["r_cut"], 2.5);
    assert_eq!(usual["dt"].as_f64().unwrap(), 48.0 * 0.01 / 120.0);
    let svg = std::fs::read_to_string(out.join("figures/energy-fluctuation-wall.svg")).unwrap();
    let named = |label: &str| svg.contains(&format!("{label}</text>"));
    assert!(named("scene") && named("usual"), "both are named");
    assert!(html.contains("Number 2, &quot;usual&quot;"), "the page says what is usual");

    // As if it had been interrupted: what is there is kept, what is missing comes out the same.
    let stored = |n: usize| out.join(format!("points/{n:04}.toml"));
    let kept = std::fs::read(stored(2)).unwrap();
    for n in [1, 3] {
        std::fs::remove_file(stored(n)).unwrap();
    }
    let second = document(&chart(place.path(), &["--out", "out", "--json", "--quiet"]));
    assert_eq!(std::fs::read(stored(2)).unwrap(), kept);
    for i in 0..3 {
        assert_eq!(first["points"][i]["errors"], second["points"][i]["errors"]);
    }

    // The folder belongs to this scene and this size alone.
    let refused = |arguments: &[&str], words: &str| {
        let output = chart(place.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    };
    refused(&["--out", "out", "--set", "system.seed=2"], "it belongs to another scene");
    refused(&["--out", "out", "--threads", "2"], "its timings are of 1 threads");
    refused(&["--out", "."], "scene.toml lies in the output folder .");
    std::fs::create_dir(place.path().join("strange")).unwrap();
    std::fs::write(place.path().join("strange/letter.txt"), "x").unwrap();
    refused(&["--out", "strange"], "no chart");
}

#[test]
fn a_chart_takes_the_settings_of_a_lock_file_and_refuses_that_of_another_scene() {
    let inputs = BadInputs::read();
    let temporary = tempfile::tempdir().unwrap();
    inputs.write_files(temporary.path());
    let scene = temporary.path().join("lock-of-another-scene.toml");
    std::fs::write(&scene, inputs.scene(inputs.case("lock-of-another-scene"))).unwrap();
    let scene = scene.to_str().unwrap();
    let refused = lennard(&["chart", scene, "--quick"]).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("the lock belongs to another"), "{said}");
    let missing =
        lennard(&["chart", scene, "--quick", "--lock", "none.lock.toml"]).output().unwrap();
    let said = String::from_utf8_lossy(&missing.stderr).into_owned();
    assert_eq!(missing.status.code(), Some(2), "{said}");
    assert!(said.contains("none.lock.toml"), "{said}");
    // With the density of the lock it fits, and the chart begins: a folder that holds something else ends it there.
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("notes.txt"), "mine").unwrap();
    let out = place.path().display().to_string();
    let fits = ["chart", scene, "--set", "system.density=0.8442", "--out", &out];
    let begun = lennard(&fits).output().unwrap();
    let words = String::from_utf8_lossy(&begun.stderr).into_owned();
    assert!(words.contains("it holds something that is no chart"), "{words}");
}

#[test]
fn a_scene_without_an_equation_of_state_is_judged_by_the_tightest_run() {
    let place = folder(&SCENE.replace("[truncation]\nr_cut = 2.5", "[potential]\nkind = \"wca\""));
    let found = document(&chart(place.path(), &["--out", "out", "--json", "--quiet"]));
    let equation = panel(&found, "pressure-equation");
    assert_eq!(equation["marks"].as_array().unwrap().len(), 0);
    let about = equation["about"].as_str().unwrap();
    assert!(about.contains("no equation of state for WCA"), "{about}");
    assert!(about.contains("tightest run alone"), "{about}");
    let tightest = panel(&found, "pressure-tightest")["marks"].as_array().unwrap();
    assert!(tightest.iter().any(|m| m["error"].is_f64()));
    let html = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert!(html.contains("no equation of state for WCA"));
}

#[test]
fn a_scene_that_cannot_be_equilibrated_ends_with_the_physics_that_failed() {
    let place = folder(&SCENE.replace("dt = 0.01", "dt = 0.2"));
    let output = chart(place.path(), &["--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(3));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("the run failed at step"), "{said}");
}

#[test]
fn folders_that_hold_something_else_are_refused_before_anything_is_computed() {
    let place = folder(SCENE);
    let out = place.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    let refused = chart(place.path(), &["--out", "out"]);
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{words}");
    assert!(words.contains("it holds something that is no chart"), "{words}");
    assert!(words.contains("allowed: an empty folder, or one that holds this chart; give another --out, or --force to begin anew"));
    // What looks like a chart whose points are no folder cannot be made room for.
    std::fs::write(out.join("plan.toml"), "").unwrap();
    std::fs::write(out.join("points"), "a file").unwrap();
    let refused = chart(place.path(), &["--out", "out", "--force"]);
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && words.contains("it cannot be cleared:"), "{words}");
    assert!(out.join("notes.txt").exists());
}

#[cfg(unix)]
#[test]
fn a_chart_that_is_interrupted_says_how_to_go_on() {
    // Long enough not to end before the signal comes, however late this test looks.
    let place = folder(&SCENE.replace("steps = 10\n", "steps = 4000\n"));
    let mut running = lennard(&["chart", "scene.toml", "--quick", "--out", "out"])
        .current_dir(place.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let first = place.path().join("out/points");
    // Some points are done, so that the chart has told of progress: it is under way.
    while !std::fs::read_dir(&first).is_ok_and(|points| points.count() > 4) {
        assert!(running.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let id = running.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let ended = running.wait_with_output().unwrap();
    let words = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(4), "{words}");
    // How far it came, and no table that has no rows: nothing is timed before all errors are known.
    let told = String::from_utf8_lossy(&ended.stdout);
    assert!(
        told.contains("stopped before the end: errors of ")
            && told.contains("settings are measured, 0 are timed"),
        "{told}"
    );
    assert!(!told.contains("cheapest that is no worse"), "{told}");
    // A point is stored when its errors are known, and not only when it is timed.
    for point in std::fs::read_dir(&first).unwrap() {
        let point = std::fs::read_to_string(point.unwrap().path()).unwrap();
        assert!(point.contains("[errors") && !point.contains("[[timings]]"), "{point}");
    }
    assert!(
        words.contains("stopped on request; finished points are kept\n  to go on: lennard chart scene.toml --quick --out out"),
        "{words}"
    );
}

/// A fluid at constant pressure whose quick sweep takes seconds.
const HELD: &str = r#"
[system]
n_atoms = 108
density = 0.4
temperature = 1.5

[truncation]
kind = "shift"
r_cut = 2.5

[[stage]]
name = "equilibrate"
steps = 500
thermostat = { kind = "bussi", tau = 0.1 }
barostat = { kind = "stochastic-cell-rescaling", pressure = 0.7, tau = 1.0 }

[[stage]]
name = "production"
steps = 200_000
thermostat = { kind = "bussi", tau = 0.5 }
barostat = { kind = "stochastic-cell-rescaling", pressure = 0.7, tau = 1.0 }

[integrator]
dt = 0.005
"#;

/// Proves that settings of barostat and thermostat are a sweep with a reading. What does not fit the scene is left out with the reason,
/// and a stopped sweep goes on.
#[test]
fn settings_of_an_ensemble_are_a_sweep_over_the_scene_with_a_reading() {
    let place = folder(HELD);
    let out = place.path().join("out");
    let arguments = ["--ensemble", "--out", "out", "--json", "--quiet"];
    let first = document(&chart(place.path(), &arguments));
    assert_eq!(first["schema"], "lennard-sweep/1");
    assert_eq!(first["name"], "scene-ensemble");
    let names = |record: &Value| -> Vec<String> {
        let points = record["points"].as_array().unwrap();
        points.iter().map(|p| p["name"].as_str().unwrap().to_owned()).collect()
    };
    // The scene's own stand first, and an interval that τ_p does not bear is left out with the reason.
    let found = names(&first);
    assert_eq!(found[0], "scene");
    assert!(found.contains(&"mtk-tau1-nose-hoover-tau0.5".to_owned()), "{found:?}");
    let left_out = &first["left_out"][0];
    assert!(left_out["what"].as_str().unwrap().contains("interval50"), "{left_out}");
    assert!(left_out["why"].as_str().unwrap().contains("too short"), "{left_out}");
    // The pressure of the scene stays where another barostat holds it.
    let resolved = std::fs::read_to_string(out.join("mtk-tau1-nose-hoover-tau0.5/scene.toml"));
    let resolved = resolved.unwrap();
    assert_eq!(resolved.matches("pressure = 0.7").count(), 2, "{resolved}");
    let table = std::fs::read_to_string(out.join("ensemble.csv")).unwrap();
    for words in ["accepted", "v_per_tau", "drift_standard_error", "too coarse to tell: P"] {
        assert!(table.contains(words), "{words}: {table}");
    }
    assert!(out.join("pace.svg").exists() && out.join("report.html").exists());

    let second = document(&chart(place.path(), &arguments));
    assert!(second["points"].as_array().unwrap().iter().all(|p| p["kept"] == true), "{second}");
}

#[test]
fn an_ensemble_without_a_barostat_is_refused_before_anything_is_written() {
    for (scene, more, words) in [
        (SCENE, "--quiet", "`stage.1.barostat.pressure` is missing"),
        (HELD, "--with-peers", "cannot be used with"),
    ] {
        let place = folder(scene);
        let output = chart(place.path(), &["--ensemble", "--out", "out", more]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
        assert!(!place.path().join("out").exists());
    }
}
