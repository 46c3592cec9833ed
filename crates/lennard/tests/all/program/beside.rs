//! `lennard compare` of several runs, and of runs beside a user's own literature.

use crate::program::common::*;

/// Under a bath, long enough for errors of means.
const LONG: &str = "--set stage.production.steps=15000 --set system.temperature=1.3 --set system.density=0.6 \
    --set 'stage.production.thermostat={ kind = \"bussi\", tau = 0.1 }' --set 'observable=[{ kind = \"rdf\", every = 20 }]'";

/// A folder with a run of the fluid for each of these lists of words, called `run0`, `run1` and so on.
fn place_of(runs: &[&str]) -> Place {
    let place = Place::with(&[("scene.toml", FLUID)]);
    for (k, more) in runs.iter().enumerate() {
        let run = format!("run scene.toml --quiet --no-report --out run{k} {LONG}");
        place.succeed(&format!("{run} {more}"));
    }
    place
}

#[test]
fn two_precisions_of_one_run_have_differences_with_errors_and_a_page_with_both() {
    let place = place_of(&["--precision double", "--precision mixed"]);
    let found = place.json("compare run0 run1");
    assert!(!place.has("runs"), "--json writes nothing");
    let quantities = found["quantities"].as_array().unwrap();
    let energy = quantities.iter().find(|q| q["quantity"] == "potential_energy").unwrap();
    let [first, second] = [0, 1].map(|k| &energy["rows"][k]);
    let of = |key: &str| number(&second[key]);
    assert!(first["reference"].is_null());
    assert_eq!(second["reference"], first["measured"]);
    assert_eq!(of("difference"), of("measured") - number(&first["measured"]));
    let error = number(&first["standard_error"]).hypot(of("standard_error"));
    assert_eq!(of("combined_error"), error);
    assert_eq!(of("tolerance"), 4.0 * error);
    let remarks = found["remarks"].to_string();
    let words = ["The scenes differ in `kernel.precision` (", "Their U(t) correlate by r = "];
    contains(&remarks, &words);

    let said = place.succeed("compare run0 run1");
    contains(&said, &["page: runs/compare-1/report.html"]);
    let page = place.read("runs/compare-1/report.html");
    contains(
        &page,
        &["Radial distribution function", "Temperature", "Potential energy", "Pressure"],
    );
    let figure = place.read("runs/compare-1/figures/potential_energy.svg");
    contains(&figure, &[">A</text>", ">B</text>"]);
    let table = place.read("runs/compare-1/compare.csv");
    let heading = "quantity,a,a_standard_error,b,b_standard_error,b_minus_a,";
    assert!(table.starts_with(heading), "{table}");
    // The same run twice is no confirmation.
    let same = place.json("compare run0 run0")["remarks"].to_string();
    contains(&same, &["one trajectory"]);
}

#[test]
fn beyond_three_runs_each_has_a_row_and_the_terminal_a_hundred_columns() {
    let place = place_of(&["--seed 1", "--seed 2", "--seed 3", "--set system.temperature=1.6"]);
    for verbose in ["", "--verbose"] {
        let line = format!("compare run0 run1 run2 run3 --no-report {verbose}");
        let said = place.succeed(&line);
        assert!(!place.has("runs"));
        assert!(said.lines().all(|line| line.chars().count() <= 100), "{said}");
        contains(&said, &["│ run0 ", "│ run3 ", "│ run3 − first "]);
        contains(&said, &["Not at the state of run0: run3.", "not of method alone"]);
    }
}

#[test]
fn values_of_ones_own_stand_beside_the_runs_at_their_state() {
    let place = place_of(&[""]);
    let sweep = "base = \"scene.toml\"\n[grid]\ndensity = [0.5, 0.6]\n";
    place.write("sweep.toml", sweep);
    place.succeed("sweep sweep.toml --out iso --quiet --no-report");
    let first = place.json("compare run0");
    let u = number(&row(&first["runs"][0], "potential_energy")["measured"]);
    let csv = format!(
        "# mine\nquantity,value,error,temperature,density,source,note\n\
         potential_energy,{},0.001,1.3,0.6,\"Me, 1999\",\npressure,7,,1.3,0.3,Me,elsewhere\n",
        u + 1.0
    );
    place.write("my.csv", &csv);
    let found = place.json("compare run0 --reference my.csv");
    let own = &found["own"];
    assert_eq!((own.as_array().unwrap().len(), &own[0]["given"]["line"]), (1, &3.into()));
    assert_eq!((&own[0]["verdict"], &own[0]["source"]), (&"differs".into(), &"Me, 1999".into()));
    assert!((number(&own[0]["difference"]) + 1.0).abs() < 1e-12);
    assert_eq!(found["without_a_run"][0]["line"], 4);
    let said = place.succeed("compare run0 --reference my.csv");
    contains(&said, &["Beside your own literature", "line 4"]);
    // A sweep stands for its points.
    let points = place.json("compare iso --reference my.csv");
    assert_eq!(points["runs"].as_array().unwrap().len(), 2);
    // A value without an error.
    place.write(
        "my.csv",
        "quantity,value,error,temperature,density,source\npressure,1,,1.3,0.6,Me\n",
    );
    let found = place.json("compare run0 --reference my.csv");
    let remark = found["own"][0]["remark"].as_str().unwrap();
    contains(remark, &["its error is not known, and it counts as exact"]);
}

#[test]
fn temperatures_without_errors_show_no_other_state() {
    let short = "--set stage.production.steps=60 --seed";
    let place = place_of(&[&format!("{short} 1"), &format!("{short} 2")]);
    let found = place.json("compare run0 run1");
    let [a, b] = [0, 1].map(|k| number(&found["runs"][k]["state"]["temperature"]));
    assert!((a / b - 1.0).abs() > 0.01, "{a} {b}");
    assert!(!found["remarks"].to_string().contains("Not at the state"), "{}", found["remarks"]);
}

#[test]
fn literature_that_cannot_be_read_is_refused_by_line_and_nothing_is_written() {
    let short = "--set stage.production.steps=100 --seed";
    let place = place_of(&[&format!("{short} 1"), &format!("{short} 2")]);
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
        place.write("my.csv", text);
        let output = place.output("compare run0 run1 --reference my.csv");
        ended(&output, 2, &[words]);
        assert!(output.stdout.is_empty() && !place.has("runs"));
    }
    let known = place.json("list quantities");
    assert!(known["entries"].as_array().unwrap().iter().any(|q| q["name"] == "pressure"));
}
