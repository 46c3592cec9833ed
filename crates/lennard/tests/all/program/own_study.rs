//! A study of a user's own: any key of the scene, multiplied or together with others, with a reading.

use crate::program::common::*;

const BASE: &str = r#"
system = { n_atoms = 108, density = 0.5, temperature = 1.5, seed = 3 }
truncation = { kind = "cut", r_cut = 2.0, tail_correction = false }
stage = [{ name = "production", steps = 12_000, thermostat = { kind = "bussi", tau = 0.2 } }]
"#;

const STUDY: &str = "base = \"base.toml\"\nreading = \"table\"\n\
    [grid]\n\"truncation.kind\" = [\"cut\", \"shift\"]\n\"integrator.dt\" = [0.002, 0.004, 0.008]\n";

/// Proves that a study over truncations and steps runs, keeps its points, and gives one point to a process.
/// It draws every property over the step.
#[test]
fn truncations_and_steps_make_a_study_with_a_table_and_figures() {
    let place = Place::with(&[("base.toml", BASE), ("study.toml", STUDY)]);
    contains(&place.succeed("sweep study.toml --points"), &["    4  shift-dt0.004\n"]);
    place.succeed("sweep study.toml --out out --point shift-dt0.004 --no-report");
    let record = place.json("sweep study.toml --out out --quiet --no-report");
    let points = record["points"].as_array().unwrap();
    let kept: Vec<bool> = points.iter().map(|p| p["kept"].as_bool().unwrap()).collect();
    assert_eq!(kept, [false, false, false, false, true, false]);
    assert_eq!(points[3]["settings"][0]["key"], "truncation.kind");
    assert_eq!(points[3]["settings"][0]["value"], "shift");
    assert_eq!(points[3]["settings"][1]["value"], 0.002);
    let table = place.read("out/table.csv");
    contains(table.lines().next().unwrap(), &[",truncation_kind,dt,"]);
    let words = ["time step dt / τ", "Potential energy", "Pressure", ">shift<"];
    contains(&place.read("out/report.html"), &words);
    contains(&place.read("out/report.html"), &["seeds of one state are averaged"]);
    // A figure of the literature is none of this study.
    assert!(!place.has("out/pressure.svg") && record.get("agreement").is_none());
}

/// Proves that a study of which all points fail writes no table, and says which reading has nothing and why.
#[test]
fn a_reading_without_points_writes_nothing() {
    let study = "base = \"base.toml\"\nreading = \"arrhenius\"\n[grid]\ntemperature = [1.5, 2.0, 2.5]\n\
        [set]\n\"stage.production.steps\" = 20\n";
    let place = Place::with(&[("base.toml", BASE), ("study.toml", study)]);
    let words = [
        "study.toml, line 2: `reading` has nothing to read: `arrhenius`",
        "found:   0 of 3 points failed",
    ];
    place.refused("sweep study.toml --out out --quiet --no-report", &words);
    assert!(!place.has("out/table.csv") && !place.has("out/report.html"));
}

/// Proves that a chart of a user's own points runs from the same reader of studies, and that what is no such chart is refused.
#[test]
fn truncations_and_steps_make_a_chart_of_a_users_own() {
    let study = "base = \"base.toml\"\nreading = \"chart\"\n[set]\n\"stage.production.steps\" = 10\n\
        [grid]\n\"truncation.kind\" = [\"cut\", \"shift\"]\ndt = { times = [1, 2] }\n";
    let place = Place::with(&[("base.toml", BASE), ("study.toml", study)]);
    let chart = place.json("chart study.toml --quick --out out --quiet");
    let points = chart["points"].as_array().unwrap();
    // The scene stands first, and a point that is the scene stands once. The tightest settings are the scene's here.
    let steps: Vec<f64> = points.iter().map(|p| number(&p["settings"]["dt"])).collect();
    assert_eq!(steps, [0.004, 0.008, 0.004, 0.008]);
    assert_eq!(points[2]["settings"]["truncation"]["kind"], "shift");

    place.write(
        "study.toml",
        &study.replace("[\"cut\", \"shift\"]", "[\"cut\"]").replace("[1, 2]", "[1]"),
    );
    let words = ["error: the chart: there is nothing to compare: 1 of the settings"];
    place.refused("chart study.toml --quick --out alone --quiet", &words);

    for (command, from, to, words) in [
        ("sweep", "dt", "dt", "`reading` is not read from a sweep"),
        ("chart", "\"chart\"", "\"table\"", "`reading` is no chart"),
        ("chart", "reading = \"chart\"\n", "", "found:   no reading"),
        ("chart", "times", "tims", "found:   `tims`\n  allowed: `times`, or a list of values"),
        ("chart", "dt = ", "density = ", "points that differ in `density`"),
        ("chart", "[1, 2]", "[1, -2]", "found:   -2\n  allowed: numbers above 0"),
        ("chart", "dt = ", "\"truncation.kinds\" = ", "multiplies what is no number"),
    ] {
        place.write("study.toml", &study.replace(from, to));
        place.refused(&format!("{command} study.toml --out other --quiet"), &[words]);
        assert!(!place.has("other"), "{words}");
    }
}

/// Proves that a study of stability of a user's own runs, however short. Its file is refused where it asks for what is not compared.
#[test]
fn a_users_own_fluid_is_tried_for_stability() {
    let study = "base = \"base.toml\"\nreading = \"stability\"\n[set]\n\"stage.production.steps\" = 10\n\
        [[point]]\n\"integrator.kind\" = [\"velocity-verlet\", \"leapfrog\"]\ndt = [0.002, 0.004]\n\
        [[point]]\n\"integrator.kind\" = \"leapfrog\"\ndt = [0.001, 0.003]\n\"kernel.precision\" = \"double\"\n";
    let place = Place::with(&[("base.toml", BASE), ("study.toml", study)]);
    let found = place.json("study stability study.toml --quick --out out --quiet");
    let claims = found["claims"].as_array().unwrap();
    // The claim is about another method than the points with small steps have.
    let of_order = |claim: &&serde_json::Value| {
        claim["quantity"].as_str().unwrap().starts_with("order of the energy RMS")
    };
    assert_eq!(claims.iter().find(of_order), None);
    contains(&place.read("out/report.html"), &["at 2 σ"]);

    let steps = "dt = [0.002, 0.004]";
    for (command, from, to, words) in [
        ("sweep", "dt", "dt", "allowed: `lennard study stability` for this file"),
        (
            "sweep",
            "\"stability\"",
            "[\"stability\", \"table\"]",
            "`reading` does not go with others",
        ),
        ("study stability", "\"stability\"", "\"chart\"", "or `lennard chart` for this file"),
        ("study stability", steps, "seed = [1, 2]", "points that differ in `seed`"),
        (
            "study stability",
            steps,
            "\"stage.production.thermostat\" = [\"none\", \"bussi\"]",
            "points that differ in `stage.production.thermostat`",
        ),
        ("study mechanics", "\"stability\"", "\"mechanics\"", "found:   1 site in a molecule"),
    ] {
        place.write("study.toml", &study.replace(from, to));
        place.refused(&format!("{command} study.toml --out other --quiet"), &[words]);
        assert!(!place.has("other"), "{words}");
    }
    place.write("study.toml", study);
    place.write("base.toml", &format!("{BASE}\n[[wall]]\nkind = \"wca\"\n"));
    let words =
        ["`wall` does not go with `lennard study stability`", "found:   a fluid with walls"];
    place.refused("study stability study.toml --out other --quiet", &words);
    place.write("out/report.html", BASE);
    place.write("study.toml", &study.replace("base.toml", "out/report.html"));
    let words = ["report.html lies in the output folder out"];
    place.refused("study stability study.toml --out out --force --quiet", &words);
    assert_eq!(place.read("out/report.html"), BASE);
}

/// Proves that five seeds of a user's own scene are judged by the reading of coverage, and that four are too few.
#[test]
fn printed_errors_of_a_users_own_scene_are_judged_over_seeds() {
    let study = "base = \"base.toml\"\nreading = \"coverage\"\n[grid]\nseed = [1, 2, 3, 4, 5]\n";
    let place = Place::with(&[("base.toml", BASE), ("study.toml", study)]);
    let record = place.json("sweep study.toml --out out --quiet");
    let quantities = record["coverage"]["quantities"].as_array().unwrap();
    let of_energy = quantities.iter().find(|q| q["name"] == "potential_energy").unwrap();
    let length = &of_energy["lengths"][0];
    assert_eq!(number(&length["given"]) + number(&length["without"]), 5.0, "{length}");
    assert!(place.has("out/coverage_quantities.csv") && place.has("out/seed5/run.json"));
    place.write("study.toml", &study.replace(", 5", ""));
    let words = ["`reading` lacks its axis: `coverage`", "found:   4 values of `seed`"];
    place.refused("sweep study.toml --out other", &words);
    assert!(!place.has("other"));
}
