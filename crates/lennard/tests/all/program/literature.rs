//! Sweeps and comparisons as a user types them.

use crate::program::common::lennard_in;

const BASE: &str = r#"
[system]
n_atoms = 108
density = 0.7
temperature = 1.5

[truncation]
r_cut = 2.5

[integrator]
kind = "velocity-verlet"
dt = 0.004

[[stage]]
name = "equilibrate"
steps = 200
thermostat = { kind = "bussi", tau = 0.1 }

[[stage]]
name = "production"
steps = 1500
"#;

fn prepared(sweep: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("base.toml"), BASE).unwrap();
    std::fs::write(folder.path().join("sweep.toml"), sweep).unwrap();
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_sweep_runs_its_points_once_and_every_run_has_a_page() {
    let folder =
        prepared("base = \"base.toml\"\n[grid]\ndensity = [0.5, 0.7]\ntemperature = 1.5\n");
    let first = lennard_in(folder.path(), &["sweep", "sweep.toml", "--out", "out", "--json"]);
    let told = text(&first.stderr);
    assert!(first.status.success(), "{told}");
    let whole = told.lines().filter(|line| line.starts_with("100 %"));
    assert_eq!(whole.collect::<Vec<_>>(), ["100 %: 2 of 2 points"], "{told}");
    let record: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!(record["points"].as_array().unwrap().len(), 2);
    assert_eq!(record["ending"], "finished");
    let page = std::fs::read_to_string(folder.path().join("out/rho0.5-T1.5/report.html")).unwrap();
    assert!(page.contains("<svg") && !page.contains("src=\"http"));
    assert!(
        folder.path().join("out/report.html").exists()
            && folder.path().join("out/table.csv").exists()
    );
    // Of a dozen columns, the ones that say nothing here would push the verdicts out of view.
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("State of all points: "));
    assert!(page.contains("T, half steps") && !page.contains("T, whole steps"));
    // The picture comes first, then the verdicts; the points are folded. On a narrow screen their rows have names.
    let at = |part: &str| page.find(part).unwrap_or_else(|| panic!("{part}"));
    assert!(at("<svg") < at("<table"), "a picture answers first");
    assert!(
        at("<h2>All points together</h2>") < at("<details>")
            && at("<details>") < at("<h2>Points</h2>")
    );
    let points = page.split("<th scope=\"col\">Point</th>").next().unwrap();
    assert!(points.trim_end().ends_with("<table class=\"stacks\">\n<thead><tr>"));
    assert!(page.contains("data-name=\"Verdicts of U/N, P, c_v\""));
    let heads = page.split("<th scope=\"col\">Point</th>").nth(1).unwrap();
    let last = heads.split("</th></tr>").next().unwrap();
    assert!(last.ends_with(">Verdicts of U/N, P, c_v"), "{last}");

    let again =
        lennard_in(folder.path(), &["sweep", "sweep.toml", "--out", "out", "--json", "--quiet"]);
    let again: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert!(again["points"].as_array().unwrap().iter().all(|p| p["kept"] == true));

    // Another scene must not be taken for the finished one, nor overwrite it unasked.
    let other = ["sweep", "sweep.toml", "--out", "out", "--quiet", "--set", "truncation.r_cut=2.2"];
    let refused = lennard_in(folder.path(), &other);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("another scene"));
}

#[test]
fn comparing_refuses_what_did_not_finish_and_names_a_truncation_without_reference() {
    let folder = prepared("");
    let run = |extra: &[&str]| {
        let all: Vec<&str> = ["run", "base.toml", "--quiet"].iter().chain(extra).copied().collect();
        lennard_in(folder.path(), &all)
    };
    assert!(
        run(&["--out", "shifted", "--no-report", "--set", "truncation.kind=force-shift"])
            .status
            .success()
    );
    assert!(!folder.path().join("shifted/report.html").exists());
    let compared = lennard_in(folder.path(), &["compare", "shifted", "--all"]);
    assert!(compared.status.success());
    let said = text(&compared.stdout);
    // Long notes are wrapped.
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(
        (words.join(" ")).contains("no equation of state for Lennard-Jones with shifted force"),
        "{said}"
    );
    assert!(!said.contains("Thol"), "{said}");

    // As a killed run leaves it.
    let path = folder.path().join("shifted/run.json");
    let record = std::fs::read_to_string(&path)
        .unwrap()
        .replace("\"finished\": true", "\"finished\": false");
    std::fs::write(&path, record).unwrap();
    let refused = lennard_in(folder.path(), &["compare", "shifted"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("did not finish"), "{}", text(&refused.stderr));
    assert!(refused.stdout.is_empty());
}

/// A sweep of tiny runs at constant temperature, as JSON.
fn swept(points: &str) -> (tempfile::TempDir, serde_json::Value, String) {
    let folder = prepared(&format!(
        "base = \"base.toml\"\n[set]\n\"truncation.r_cut\" = 2.2\n\"stage.production.steps\" = 3000\n\
         \"stage.production.thermostat\" = {{ kind = \"bussi\", tau = 0.1 }}\n\"output.thermo_every\" = 5\n{points}"
    ));
    let done =
        lennard_in(folder.path(), &["sweep", "sweep.toml", "--out", "out", "--json", "--quiet"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    (folder, serde_json::from_slice(&done.stdout).unwrap(), page)
}

#[test]
fn states_outside_the_equation_inside_the_dome_and_above_freezing_are_said_to_be_ones_and_not_judged()
 {
    let (folder, record, page) = swept(
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
        assert!(words.contains(wanted), "{words}");
        assert!(page.contains(wanted), "the page does not say {wanted}");
        for row in point["compared"]["rows"].as_array().unwrap() {
            let quantity = row["quantity"].as_str().unwrap();
            let verdict = row["verdict"].as_str().unwrap();
            let of_the_run_itself =
                ["temperature", "temperature_half_steps", "configurational_temperature"];
            assert!(
                of_the_run_itself.contains(&quantity) || row["reference"].is_null(),
                "{words}: {quantity} {verdict}"
            );
        }
        let remarks = point["compared"]["remarks"].to_string();
        assert!(remarks.contains("nothing is judged by it"), "{remarks}");
    }
    // Nothing to sum up but the two temperatures of single phases, and there is none.
    assert_eq!(record["agreement"].as_array().unwrap().len(), 0);

    // The table of the command line warns before it begins, and fits a terminal.
    let again = lennard_in(folder.path(), &["sweep", "sweep.toml", "--out", "out"]);
    for line in text(&again.stdout).lines() {
        let is_table = line.starts_with(['┌', '│', '╞', '└']);
        assert!(!is_table || line.chars().count() <= 100, "{line}");
    }
    assert!(text(&again.stdout).contains("it is run and not judged"));
}

#[test]
fn compare_prints_one_document_with_both_temperatures_and_the_state() {
    let (folder, ..) = swept("[[point]]\ndensity = 0.5\ntemperature = 2.0\n");
    let done = lennard_in(folder.path(), &["compare", "out/rho0.5-T2", "--json"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let document: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(document["schema"], "lennard-compare/1");
    let run = &document["runs"][0];
    assert_eq!(run["atoms"], 108);
    assert_eq!(run["state"]["phase"], "supercritical");
    assert_eq!(run["state"]["half_steps"], true);
    let row = |name: &str| {
        let rows = run["rows"].as_array().unwrap();
        rows.iter().find(|r| r["quantity"] == name).unwrap().clone()
    };
    let whole = row("temperature")["measured"].as_f64().unwrap();
    let half = row("temperature_half_steps")["measured"].as_f64().unwrap();
    assert!(half > whole && half < 1.02 * whole, "{whole} {half}");
    assert_eq!(run["state"]["temperature"].as_f64().unwrap(), half);
    let energy = row("potential_energy");
    let gap = energy["measured"].as_f64().unwrap() - energy["reference"].as_f64().unwrap();
    assert!((gap - energy["difference"].as_f64().unwrap()).abs() < 1e-12);
    assert!(energy["source"].as_str().unwrap().contains("Thol 2016"));
    let shown = text(&lennard_in(folder.path(), &["compare", "out/rho0.5-T2", "--all"]).stdout);
    assert!(shown.contains("T, whole steps") && shown.contains("T, half steps"), "{shown}");
}

#[test]
fn sweeps_with_no_points_and_truncations_that_no_equation_fits_are_said_clearly() {
    // A newcomer takes one for the other.
    let folder = prepared("base = \"base.toml\"\n[grid]\ndensity = []\n");
    let refused = lennard_in(folder.path(), &["sweep", "base.toml", "--out", "out"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("this is a scene and no sweep"), "{said}");
    assert!(said.contains("`lennard run` for this file"), "{said}");
    assert!(!folder.path().join("out").exists());
    let refused = lennard_in(folder.path(), &["sweep", "sweep.toml", "--out", "out"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("a sweep with no points"), "{}", text(&refused.stderr));

    // There is an equation for shifting at 2.5 σ, and for no other cutoff.
    let (_folder, record, page) =
        swept("\"truncation.kind\" = \"shift\"\n[[point]]\ndensity = 0.5\ntemperature = 2.0\n");
    let compared = &record["points"][0]["compared"];
    assert!(compared["equation"].is_null());
    let remarks = compared["remarks"].to_string();
    assert!(remarks.contains("not compared with any equation of state"), "{remarks}");
    assert!(page.contains("not compared with any equation of state"));
    let rows = compared["rows"].as_array().unwrap();
    let energy = rows.iter().find(|r| r["quantity"] == "potential_energy").unwrap();
    assert!(energy["reference"].is_null() && energy["verdict"] != "agrees", "{energy}");
}

#[test]
fn a_crystal_beside_its_liquid_is_headed_by_the_phase_that_grows() {
    let folder = tempfile::tempdir().unwrap();
    let run = [
        "run",
        "two-phase/melting",
        "--quiet",
        "--no-report",
        "--out",
        "out",
        "--set",
        "system.n_atoms=700",
        "--set",
        "start.cells=4",
        "--set",
        "start.layers=6",
        "--set",
        "truncation.r_cut=2.5",
        "--set",
        "stage.settle.steps=100",
        "--set",
        "stage.production.steps=200",
    ];
    let ran = lennard_in(folder.path(), &run);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let compared = lennard_in(folder.path(), &["compare", "out", "--json"]);
    let compared: serde_json::Value = serde_json::from_slice(&compared.stdout).unwrap();
    let headline = compared["runs"][0]["headline"].as_str().unwrap();
    assert!(headline.starts_with("No velocity is told, "), "{headline}");
    let said = text(&lennard_in(folder.path(), &["compare", "out"]).stdout);
    assert!(said.contains("No velocity is told, "), "{said}");
    assert!(said.contains("a crystal beside its liquid"), "{said}");
}

#[test]
fn a_sweep_of_slabs_is_not_told_that_two_phases_are_not_judged() {
    let folder = prepared(
        "base = \"slab.toml\"\n[set]\n\"system.n_atoms\" = 300\n\"stage.equilibrate.steps\" = 10\n\
         \"stage.production.steps\" = 20\n[grid]\ntemperature = [0.8]\n",
    );
    let copied = lennard_in(folder.path(), &["new", "slab", "--like", "interface/slab"]);
    assert!(copied.status.success(), "{}", text(&copied.stderr));
    let done = lennard_in(folder.path(), &["sweep", "sweep.toml", "--no-report"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let told = text(&done.stdout);
    assert!(told.contains("1 point, 1 at a time"), "{told}");
    assert!(!told.contains("it is run and not judged"), "{told}");
}
