//! `lennard compare` of several runs, and of runs beside a user's own literature.

use serde_json::Value;

use crate::program::common::{Place, lennard_in, stderr, stdout};

const SCENE: &str = r#"
[system]
n_atoms = 108
density = 0.6
temperature = 1.3

[truncation]
r_cut = 2.5

[[stage]]
name = "equilibrate"
steps = 1000
thermostat = { kind = "bussi", tau = 0.1 }

[[stage]]
name = "production"
steps = 15000
thermostat = { kind = "bussi", tau = 0.1 }

[[observable]]
kind = "rdf"
every = 20
"#;

/// A folder with a run for each of these overrides, called `run0`, `run1` and so on.
fn place_of(overrides: &[&str]) -> Place {
    runs_of(SCENE, overrides)
}

fn runs_of(scene: &str, overrides: &[&str]) -> Place {
    let place = Place::with(&[("scene.toml", scene)]);
    for (k, set) in overrides.iter().enumerate() {
        let out = format!("run{k}");
        let run = ["run", "scene.toml", "--quiet", "--no-report", "--set", set, "--out", &out];
        let ran = lennard_in(place.root(), &run);
        assert!(ran.status.success(), "{}", stderr(&ran));
    }
    place
}

fn json(place: &Place, arguments: &[&str]) -> Value {
    let output = lennard_in(place.root(), &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn two_precisions_of_one_run_have_differences_with_errors_and_a_page_with_both() {
    let place = place_of(&["kernel.precision=\"double\"", "kernel.precision=\"mixed\""]);
    let found = json(&place, &["compare", "run0", "run1"]);
    assert!(!place.path("runs").exists(), "--json writes nothing");
    let quantities = found["quantities"].as_array().unwrap();
    let energy = quantities.iter().find(|q| q["quantity"] == "potential_energy").unwrap();
    let [first, second] = [0, 1].map(|k| &energy["rows"][k]);
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap();
    let error = |row| number(row, "standard_error");
    assert!(first["reference"].is_null());
    assert_eq!(second["reference"], first["measured"]);
    assert_eq!(
        number(second, "difference"),
        number(second, "measured") - number(first, "measured")
    );
    assert_eq!(number(second, "combined_error"), error(first).hypot(error(second)));
    assert_eq!(number(second, "tolerance"), 4.0 * number(second, "combined_error"));
    let remarks = found["remarks"].to_string();
    assert!(remarks.contains("The scenes differ in `kernel.precision` ("), "{remarks}");
    assert!(remarks.contains("Their U(t) correlate by r = "), "{remarks}");

    let said = stdout(&lennard_in(place.root(), &["compare", "run0", "run1"]));
    assert!(said.contains("page: runs/compare-1/report.html"), "{said}");
    let page = place.read("runs/compare-1/report.html");
    for title in ["Radial distribution function", "Temperature", "Potential energy", "Pressure"] {
        assert!(page.contains(title), "{title}");
    }
    let figure = place.read("runs/compare-1/figures/potential_energy.svg");
    assert!(["A", "B"].iter().all(|run| figure.contains(&format!(">{run}</text>"))), "{figure}");
    let table = place.read("runs/compare-1/compare.csv");
    assert!(
        table.starts_with("quantity,a,a_standard_error,b,b_standard_error,b_minus_a,"),
        "{table}"
    );
    // The same run twice is no confirmation.
    let same = json(&place, &["compare", "run0", "run0"])["remarks"].to_string();
    assert!(same.contains("one trajectory"), "{same}");
}

#[test]
fn beyond_three_runs_each_has_a_row_and_the_terminal_a_hundred_columns() {
    let overrides = ["system.seed=1", "system.seed=2", "system.seed=3", "system.temperature=1.6"];
    let place = place_of(&overrides);
    for extra in [&["--no-report"][..], &["--no-report", "--verbose"]] {
        let runs = ["compare", "run0", "run1", "run2", "run3"];
        let output = lennard_in(place.root(), &[&runs, extra].concat());
        let said = stdout(&output);
        assert!(output.status.success() && !place.path("runs").exists(), "{}", stderr(&output));
        assert!(said.lines().all(|line| line.chars().count() <= 100), "{said}");
        for run in ["│ run0 ", "│ run3 ", "│ run3 − first "] {
            assert!(said.contains(run), "{run}: {said}");
        }
        assert!(said.contains("Not at the state of run0: run3."), "{said}");
        assert!(said.contains("not of method alone"), "{said}");
    }
}

#[test]
fn values_of_ones_own_stand_beside_the_runs_at_their_state() {
    let place = place_of(&["system.seed=1"]);
    let sweep = "base = \"scene.toml\"\n[grid]\ndensity = [0.5, 0.6]\n";
    std::fs::write(place.path("sweep.toml"), sweep).unwrap();
    let ran = lennard_in(
        place.root(),
        &["sweep", "sweep.toml", "--out", "iso", "--quiet", "--no-report"],
    );
    assert!(ran.status.success(), "{}", stderr(&ran));
    let first = json(&place, &["compare", "run0"]);
    let measured = first["runs"][0]["rows"].as_array().unwrap();
    let energy = measured.iter().find(|row| row["quantity"] == "potential_energy").unwrap();
    let u = energy["measured"].as_f64().unwrap();
    let csv = format!(
        "# mine\nquantity,value,error,temperature,density,source,note\n\
         potential_energy,{},0.001,1.3,0.6,\"Me, 1999\",\npressure,7,,1.3,0.3,Me,elsewhere\n",
        u + 1.0
    );
    std::fs::write(place.path("my.csv"), csv).unwrap();
    let found = json(&place, &["compare", "run0", "--reference", "my.csv"]);
    let own = &found["own"];
    assert_eq!((own.as_array().unwrap().len(), &own[0]["given"]["line"]), (1, &3.into()));
    assert_eq!((&own[0]["verdict"], &own[0]["source"]), (&"differs".into(), &"Me, 1999".into()));
    assert!((own[0]["difference"].as_f64().unwrap() + 1.0).abs() < 1e-12);
    assert_eq!(found["without_a_run"][0]["line"], 4);
    let said = stdout(&lennard_in(place.root(), &["compare", "run0", "--reference", "my.csv"]));
    assert!(said.contains("Beside your own literature") && said.contains("line 4"), "{said}");
    // A sweep stands for its points.
    let points = json(&place, &["compare", "iso", "--reference", "my.csv"]);
    assert_eq!(points["runs"].as_array().unwrap().len(), 2);
}

#[test]
fn temperatures_without_errors_show_no_other_state_and_a_value_without_an_error_counts_as_exact() {
    let bath = "steps = 15000\nthermostat = { kind = \"bussi\", tau = 0.1 }";
    assert!(SCENE.contains(bath));
    let place = runs_of(&SCENE.replace(bath, "steps = 60"), &["system.seed=1", "system.seed=2"]);
    let found = json(&place, &["compare", "run0", "run1"]);
    let [a, b] = [0, 1].map(|k| found["runs"][k]["state"]["temperature"].as_f64().unwrap());
    assert!((a / b - 1.0).abs() > 0.01, "{a} {b}");
    assert!(!found["remarks"].to_string().contains("Not at the state"), "{}", found["remarks"]);

    let place = place_of(&["system.seed=1"]);
    let csv = "quantity,value,error,temperature,density,source\npressure,1,,1.3,0.6,Me\n";
    std::fs::write(place.path("my.csv"), csv).unwrap();
    let found = json(&place, &["compare", "run0", "--reference", "my.csv"]);
    let remark = found["own"][0]["remark"].as_str().unwrap();
    assert!(remark.contains("its error is not known, and it counts as exact"), "{remark}");
}

#[test]
fn literature_that_cannot_be_read_is_refused_by_line_and_nothing_is_written() {
    let place = place_of(&["stage.production.steps=100", "system.seed=2"]);
    let heading = "quantity,value,error,temperature,density,source\n";
    for (text, words) in [
        (
            "quantity,valeu,error,temperature,density,source\n",
            "my.csv:1: found no column `value` among quantity, valeu",
        ),
        ("", "my.csv:1: found no heading"),
        (
            &format!("{heading}presure,1,,1.3,0.6,Me\n"),
            "my.csv:2: found quantity = `presure`; allowed: a name of `lennard list quantities`, or of a mean of these runs; nearest: pressure",
        ),
        (
            &format!("# mine\n\n{heading}pressure,1.O,,1.3,0.6,Me\n"),
            "my.csv:4: found value = `1.O`; allowed: a finite number",
        ),
        (&format!("{heading}pressure,nan,,1.3,0.6,Me\n"), "found value = `nan`"),
        (&format!("{heading}pressure,,,1.3,0.6,Me\n"), "my.csv:2: found no value"),
        (&format!("{heading}pressure,1,-1,1.3,0.6,Me\n"), "found error = -1; allowed: at least 0"),
        (&format!("{heading}pressure,1\n"), "my.csv:2: found "),
    ] {
        std::fs::write(place.path("my.csv"), text).unwrap();
        let refused =
            lennard_in(place.root(), &["compare", "run0", "run1", "--reference", "my.csv"]);
        let said = stderr(&refused);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{words}: {said}");
        assert!(refused.stdout.is_empty() && !place.path("runs").exists());
    }
    let known = json(&place, &["list", "quantities"]);
    assert!(known["entries"].as_array().unwrap().iter().any(|q| q["name"] == "pressure"));
}
