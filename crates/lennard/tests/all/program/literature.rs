//! Sweeps and comparisons as a user types them.

use serde_json::Value;

use crate::program::common::*;

const BASE: &str = r#"
system = { n_atoms = 108, density = 0.7, temperature = 1.5 }
truncation = { r_cut = 2.5 }
integrator = { kind = "velocity-verlet", dt = 0.004 }
stage = [
    { name = "equilibrate", steps = 200, thermostat = { kind = "bussi", tau = 0.1 } },
    { name = "production", steps = 1500 },
]
"#;

fn prepared(sweep: &str) -> Place {
    let sweep = format!("base = \"base.toml\"\n{sweep}");
    Place::with(&[("base.toml", BASE), ("sweep.toml", &sweep)])
}

#[test]
fn a_sweep_runs_its_points_once_and_every_run_has_a_page() {
    let place = prepared("[grid]\ndensity = [0.5, 0.7]\ntemperature = 1.5\n");
    let first = place.output("sweep sweep.toml --out out --json");
    let told = ended(&first, 0, &[]);
    let whole = told.lines().filter(|line| line.starts_with("100 %"));
    assert_eq!(whole.collect::<Vec<_>>(), ["100 %: 2 of 2 points"], "{told}");
    let record = json(&stdout(&first));
    assert_eq!(record["points"].as_array().unwrap().len(), 2);
    assert_eq!(record["ending"], "finished");
    let page = place.read("out/rho0.5-T1.5/report.html");
    assert!(page.contains("<svg") && !page.contains("src=\"http"));
    assert!(place.has("out/table.csv"));
    // Of a dozen columns, the ones that say nothing here would push the verdicts out of view.
    let page = place.read("out/report.html");
    contains(&page, &["State of all points: ", "T, half steps"]);
    assert!(!page.contains("T, whole steps"));
    // The picture comes first, then the verdicts; the points are folded. On a narrow screen their rows have names.
    let at = |part: &str| page.find(part).unwrap_or_else(|| panic!("{part}"));
    assert!(at("<svg") < at("<table"), "a picture answers first");
    let parts = ["<h2>All points together</h2>", "<details>", "<h2>Points</h2>"].map(at);
    assert!(parts.is_sorted(), "{parts:?}");
    let (before, heads) = page.split_once("<th scope=\"col\">Point</th>").unwrap();
    assert!(before.trim_end().ends_with("<table class=\"stacks\">\n<thead><tr>"));
    contains(&page, &["data-name=\"Verdicts of U/N, P, c_v\""]);
    let last = heads.split("</th></tr>").next().unwrap();
    assert!(last.ends_with(">Verdicts of U/N, P, c_v"), "{last}");
    let again = place.json("sweep sweep.toml --out out --quiet");
    assert!(again["points"].as_array().unwrap().iter().all(|p| p["kept"] == true));
}

#[test]
fn comparing_names_a_truncation_without_reference() {
    let place = prepared("");
    let shifted = "--no-report --set truncation.kind=force-shift";
    place.succeed(&format!("run base.toml --quiet --out shifted {shifted}"));
    assert!(!place.has("shifted/report.html"));
    let said = place.succeed("compare shifted --all");
    let words = "no equation of state for Lennard-Jones with shifted force";
    contains(&in_one_line(&said), &[words]);
    assert!(!said.contains("Thol"), "{said}");
    let compared = &place.json("compare shifted")["runs"][0];
    assert!(compared["equation"].is_null());
    assert!(row(compared, "potential_energy")["reference"].is_null());
}

/// A sweep of tiny runs at constant temperature: its place, its document and its page.
fn swept(points: &str) -> (Place, Value, String) {
    let place = prepared(&format!(
        "[set]\n\"truncation.r_cut\" = 2.2\n\"stage.production.steps\" = 3000\n\
         \"stage.production.thermostat\" = {{ kind = \"bussi\", tau = 0.1 }}\n\"output.thermo_every\" = 5\n{points}"
    ));
    let record = place.json("sweep sweep.toml --out out --quiet");
    let page = place.read("out/report.html");
    (place, record, page)
}

#[test]
fn states_outside_the_equation_inside_the_dome_and_above_freezing_are_said_to_be_ones_and_not_judged()
 {
    let (place, record, page) = swept(
        "[[point]]\ndensity = 0.85\ntemperature = 0.3\n[[point]]\ndensity = 0.3\ntemperature = 0.8\n\
         [[point]]\ndensity = 1.05\ntemperature = 1.0\n",
    );
    let points = record["points"].as_array().unwrap();
    for (point, wanted) in points.iter().zip([
        "covers temperatures from",
        "inside the vapor–liquid dome",
        "denser than the freezing liquid",
    ]) {
        let words = point["compared"]["state"]["words"].as_str().unwrap();
        contains(words, &[wanted]);
        contains(&page, &[wanted]);
        for row in point["compared"]["rows"].as_array().unwrap() {
            let of_the_run_itself =
                ["temperature", "temperature_half_steps", "configurational_temperature"];
            let is_of_itself = of_the_run_itself.iter().any(|name| row["quantity"] == *name);
            assert!(is_of_itself || row["reference"].is_null(), "{words}: {row}");
        }
        contains(&point["compared"]["remarks"].to_string(), &["nothing is judged by it"]);
    }
    // Nothing to sum up but the two temperatures of single phases, and there is none.
    assert_eq!(record["agreement"].as_array().unwrap().len(), 0);

    // The table of the command line warns before it begins, and fits a terminal.
    let again = place.succeed("sweep sweep.toml --out out");
    for line in again.lines() {
        let is_table = line.starts_with(['┌', '│', '╞', '└']);
        assert!(!is_table || line.chars().count() <= 100, "{line}");
    }
    contains(&again, &["it is run and not judged"]);
}

#[test]
fn compare_prints_one_document_with_both_temperatures_and_the_state() {
    let (place, ..) = swept("[[point]]\ndensity = 0.5\ntemperature = 2.0\n");
    let document = place.json("compare out/rho0.5-T2");
    assert_eq!(document["schema"], "lennard-compare/1");
    let run = &document["runs"][0];
    assert_eq!(run["atoms"], 108);
    assert_eq!(run["state"]["phase"], "supercritical");
    assert_eq!(run["state"]["half_steps"], true);
    let measured = |name: &str| number(&row(run, name)["measured"]);
    let (whole, half) = (measured("temperature"), measured("temperature_half_steps"));
    assert!(half > whole && half < 1.02 * whole, "{whole} {half}");
    assert_eq!(run["state"]["temperature"], half);
    let energy = row(run, "potential_energy");
    let gap = measured("potential_energy") - number(&energy["reference"]);
    assert!((gap - number(&energy["difference"])).abs() < 1e-12);
    contains(energy["source"].as_str().unwrap(), &["Thol 2016"]);
    let shown = place.succeed("compare out/rho0.5-T2 --all");
    contains(&shown, &["T, whole steps", "T, half steps"]);
}

#[test]
fn sweeps_with_no_points_are_said_clearly() {
    // A newcomer takes one for the other.
    let place = prepared("[grid]\ndensity = []\n");
    let words = ["this is a scene and no sweep", "`lennard run` for this file"];
    place.refused("sweep base.toml --out out", &words);
    assert!(!place.has("out"));
    place.refused("sweep sweep.toml --out out", &["a sweep with no points"]);
}

#[test]
fn a_crystal_beside_its_liquid_is_headed_by_the_phase_that_grows() {
    let place = Place::with(&[]);
    place.succeed(
        "run two-phase/melting --quiet --no-report --out out --set system.n_atoms=700 --set start.cells=4 \
         --set start.layers=6 --set truncation.r_cut=2.5 --set stage.settle.steps=100 --set stage.production.steps=200",
    );
    let compared = place.json("compare out");
    let headline = compared["runs"][0]["headline"].as_str().unwrap();
    assert!(headline.starts_with("No velocity is told, "), "{headline}");
    let said = place.succeed("compare out");
    contains(&said, &["No velocity is told, ", "a crystal beside its liquid"]);
}

#[test]
fn a_sweep_of_slabs_is_not_told_that_two_phases_are_not_judged() {
    let sweep = "base = \"slab.toml\"\n[set]\n\"system.n_atoms\" = 300\n\"stage.equilibrate.steps\" = 10\n\
         \"stage.production.steps\" = 20\n[grid]\ntemperature = [0.8]\n";
    let place = Place::with(&[("sweep.toml", sweep)]);
    place.succeed("new slab --like interface/slab");
    let told = place.succeed("sweep sweep.toml --no-report");
    contains(&told, &["1 point, 1 at a time"]);
    assert!(!told.contains("it is run and not judged"), "{told}");
}
