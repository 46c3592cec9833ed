//! `lennard chart` as a user types it.

use serde_json::Value;

use crate::program::bad_scenes::BadInputs;
use crate::program::common::*;

/// A small liquid whose measured stage is so short that a quick chart takes seconds.
const SCENE: &str = r#"
system = { n_atoms = 256, density = 0.8442, temperature = 0.8 }
truncation = { r_cut = 2.5 }
integrator = { dt = 0.01 }
stage = [
    { name = "equilibrate", steps = 200, thermostat = { kind = "bussi", tau = 0.1 } },
    { name = "production", steps = 10 },
]
"#;

const CHART: &str = "chart scene.toml --quick --quiet --out out";

fn place(scene: &str) -> Place {
    Place::with(&[("scene.toml", scene)])
}

fn panel<'a>(chart: &'a Value, name: &str) -> &'a Value {
    let panels = chart["panels"].as_array().unwrap();
    panels.iter().find(|p| p["name"] == name).unwrap()
}

/// The first picture of a page has these errors, marks the scene's own settings, and says how cost is counted.
fn first_picture(place: &Place, errors: &[&str]) {
    let svg = place.read("out/figures/overview.svg");
    contains(&svg, errors);
    contains(&svg, &["scene"]);
    let html = place.read("out/report.html");
    let first = html.split("<figcaption>").nth(1).unwrap();
    contains(first, &["Left is cheap and low is right"]);
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
    let place = place(SCENE);
    let first = place.json(CHART);
    assert_eq!(first["finished"], true);

    // Three times the scene's step blows up, and that is a mark with its reason, not a gap.
    let marks = panel(&first, "energy-drift")["marks"].as_array().unwrap();
    let failed: Vec<&Value> = marks.iter().filter(|m| m["error"].is_null()).collect();
    assert!(!failed.is_empty() && failed.len() < marks.len());
    for mark in failed {
        contains(mark["failure"].as_str().unwrap(), &["failed at step"]);
        assert!(number(&mark["wall"]) > 0.0);
    }
    // Mixed precision errs more in the forces than double, and every panel has a front.
    for mark in panel(&first, "forces-same-model")["marks"].as_array().unwrap() {
        let points = first["points"].as_array().unwrap();
        let point = points.iter().find(|p| p["number"] == mark["number"]).unwrap();
        let is_mixed = point["settings"]["precision"] == "mixed";
        assert_eq!(number(&mark["error"]) > 1e-10, is_mixed, "{mark}");
    }
    for panel in first["panels"].as_array().unwrap() {
        let name = panel["name"].as_str().unwrap();
        let marks = panel["marks"].as_array().unwrap();
        assert!(marks.iter().any(|m| m["on_wall_front"] == true), "{name}");
        assert!(place.has(&format!("out/{name}.csv")), "{name}");
        for kind in ["wall", "forces"] {
            let svg = place.read(&format!("out/figures/{name}-{kind}.svg"));
            contains(&svg, &["Pareto front", "<title>"]);
        }
    }
    let html = place.read("out/report.html");
    assert!(html.contains("Point at a mark") && html.matches("<script>").count() == 1);
    assert!(!html.contains("http-equiv") && !html.contains("src=\"http"));

    first_picture(&place, &["P / (ε/σ³)", "U / ε", "forces (relative)"]);

    // The usual settings stand beside the settings of the scene, and both are named.
    let usual = &first["points"][1]["settings"];
    assert_eq!(usual["truncation"]["r_cut"], 2.5);
    assert_eq!(number(&usual["dt"]), 48.0 * 0.01 / 120.0);
    let svg = place.read("out/figures/energy-fluctuation-wall.svg");
    contains(&svg, &["scene</text>", "usual</text>"]);
    contains(&html, &["Number 2, &quot;usual&quot;"]);

    // As if it had been interrupted: what is there is kept, what is missing comes out the same.
    let stored = |n: usize| format!("out/points/{n:04}.toml");
    let kept = place.bytes(&stored(2));
    for n in [1, 3] {
        std::fs::remove_file(place.path(&stored(n))).unwrap();
    }
    let second = place.json(CHART);
    assert_eq!(place.bytes(&stored(2)), kept);
    for i in 0..3 {
        assert_eq!(first["points"][i]["errors"], second["points"][i]["errors"]);
    }

    // The folder belongs to this scene and this size alone.
    place.write("strange/letter.txt", "x");
    let free = "allowed: an empty folder, or one that holds this chart; give another --out, or --force to begin anew";
    for (arguments, words) in [
        ("--out out --set system.seed=2", "it belongs to another scene"),
        ("--out out --threads 2", "its timings are of 1 threads"),
        ("--out .", "scene.toml lies in the output folder ."),
        ("--out strange", "it holds something that is no chart"),
        ("--out strange", free),
    ] {
        place.refused(&format!("chart scene.toml --quick {arguments}"), &[words]);
    }
    // What looks like a chart whose points are no folder cannot be made room for.
    place.write("strange/plan.toml", "");
    place.write("strange/points", "a file");
    let output = place.output("chart scene.toml --quick --out strange --force");
    assert!(!output.status.success());
    contains(&stderr(&output), &["it cannot be cleared:"]);
    assert!(place.has("strange/letter.txt"));
}

#[test]
fn a_chart_takes_the_settings_of_a_lock_file_and_refuses_that_of_another_scene() {
    let inputs = BadInputs::read();
    let name = "lock-of-another-scene";
    let place = Place::with(&[(&format!("{name}.toml"), &inputs.scene(inputs.case(name)))]);
    inputs.write_files(place.root());
    let line = format!("chart {name}.toml --quick --out out");
    place.refused(&line, &["the lock belongs to another"]);
    place.refused(&format!("{line} --lock none.lock.toml"), &["none.lock.toml"]);
    // With the density of the lock it fits, and the chart begins: a folder that holds something else ends it there.
    place.write("out/notes.txt", "mine");
    let words = ["it holds something that is no chart"];
    place.refused(&format!("{line} --set system.density=0.8442"), &words);
}

#[test]
fn a_scene_without_an_equation_of_state_is_judged_by_the_tightest_run() {
    let place =
        place(&SCENE.replace("truncation = { r_cut = 2.5 }", "potential = { kind = \"wca\" }"));
    let found = place.json(CHART);
    let equation = panel(&found, "pressure-equation");
    assert_eq!(equation["marks"].as_array().unwrap().len(), 0);
    let about = equation["about"].as_str().unwrap();
    contains(about, &["no equation of state for WCA", "tightest run alone"]);
    let tightest = panel(&found, "pressure-tightest")["marks"].as_array().unwrap();
    assert!(tightest.iter().any(|m| m["error"].is_f64()));
    contains(&place.read("out/report.html"), &["no equation of state for WCA"]);
}

#[test]
fn a_scene_that_cannot_be_equilibrated_ends_with_the_physics_that_failed() {
    let place = place(&SCENE.replace("dt = 0.01", "dt = 0.2"));
    ended(&place.output(CHART), 3, &["the run failed at step"]);
}

#[cfg(unix)]
#[test]
fn a_chart_that_is_interrupted_says_how_to_go_on() {
    // Long enough not to end before the signal comes, however late this test looks.
    let place = place(&SCENE.replace("steps = 10 }", "steps = 4000 }"));
    // Some points are done, so that the chart has told of progress: it is under way.
    let points = || std::fs::read_dir(place.path("out/points"));
    let running = place.spawn("chart scene.toml --quick --out out", "point", || {
        points().is_ok_and(|points| points.count() > 4)
    });
    kill(&running, "INT");
    let output = running.wait_with_output().unwrap();
    let words = "stopped on request; finished points are kept\n  to go on: lennard chart scene.toml --quick --out out";
    ended(&output, 4, &[words]);
    // How far it came, and no table that has no rows: nothing is timed before all errors are known.
    let told = stdout(&output);
    contains(&told, &["stopped before the end: errors of ", "settings are measured, 0 are timed"]);
    assert!(!told.contains("cheapest that is no worse"), "{told}");
    // A point is stored when its errors are known, and not only when it is timed.
    for point in points().unwrap() {
        let point = std::fs::read_to_string(point.unwrap().path()).unwrap();
        assert!(point.contains("[errors") && !point.contains("[[timings]]"), "{point}");
    }
}

/// A fluid at constant pressure whose quick sweep takes seconds.
const HELD: &str = r#"
system = { n_atoms = 108, density = 0.4, temperature = 1.5 }
truncation = { kind = "shift", r_cut = 2.5 }
integrator = { dt = 0.005 }

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
"#;

/// Proves that settings of barostat and thermostat are a sweep with a reading. What does not fit the scene is left out with the reason,
/// and a stopped sweep goes on.
#[test]
fn settings_of_an_ensemble_are_a_sweep_over_the_scene_with_a_reading() {
    let line = format!("{CHART} --ensemble");
    let without = place(SCENE);
    without.refused(&line, &["`stage.1.barostat.pressure` is missing"]);
    let place = place(HELD);
    place.refused(&format!("{line} --with-peers"), &["cannot be used with"]);
    assert!(!without.has("out") && !place.has("out"));
    let first = place.json(&line);
    assert_eq!(first["schema"], "lennard-sweep/1");
    assert_eq!(first["name"], "scene-ensemble");
    let points = first["points"].as_array().unwrap();
    // The scene's own stand first, and an interval that τ_p does not bear is left out with the reason.
    assert_eq!(points[0]["name"], "scene");
    assert!(points.iter().any(|p| p["name"] == "mtk-tau1-nose-hoover-tau0.5"), "{points:?}");
    let left_out = &first["left_out"][0];
    contains(left_out["what"].as_str().unwrap(), &["interval50"]);
    contains(left_out["why"].as_str().unwrap(), &["too short"]);
    // The pressure of the scene stays where another barostat holds it.
    let resolved = place.read("out/mtk-tau1-nose-hoover-tau0.5/scene.toml");
    assert_eq!(resolved.matches("pressure = 0.7").count(), 2, "{resolved}");
    let table = place.read("out/ensemble.csv");
    let words = ["accepted", "v_per_tau", "drift_standard_error", "too coarse to tell: P"];
    contains(&table, &words);
    assert!(place.has("out/pace.svg") && place.has("out/report.html"));

    let second = place.json(&line);
    assert!(second["points"].as_array().unwrap().iter().all(|p| p["kept"] == true), "{second}");
}
