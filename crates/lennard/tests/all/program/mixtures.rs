//! Mixtures as a user runs them.

use crate::program::common::{Place, lennard_in};
use serde_json::Value;

fn row<'a>(compared: &'a Value, quantity: &str) -> &'a Value {
    let rows = compared["rows"].as_array().unwrap();
    let found = rows.iter().find(|r| r["quantity"] == quantity);
    found.unwrap_or_else(|| panic!("no {quantity}"))
}

/// The shipped scene of Kob and Andersen with 500 particles and changes: what `compare` says of it.
fn kob_andersen(changes: &[&str]) -> Value {
    let place = Place::with(&[]);
    let mut arguments =
        vec!["run", "mixture/kob-andersen", "--out", "out", "--no-report", "--quiet"];
    let small = ["system.n_atoms=500", "start.lattice=fcc"];
    for change in small.iter().chain(changes) {
        arguments.extend(["--set", change]);
    }
    let ran = lennard_in(place.root(), &arguments);
    assert!(ran.status.success(), "{ran:?}");
    let compared = lennard_in(place.root(), &["compare", "out", "--json"]);
    let all: Value = serde_json::from_slice(&compared.stdout).unwrap();
    all["runs"][0].clone()
}

#[test]
fn a_run_of_kob_andersen_stands_beside_the_runs_of_others_at_their_states_alone() {
    let compared = kob_andersen(&["stage.equilibrate.steps=2000", "stage.production.steps=12000"]);
    let mut judged = 0;
    for (quantity, reference) in [
        ("potential_energy", -4.653947433),
        ("pressure", 19.31773286),
        ("heat_capacity", 1.5 + 4.822395312 / 4.0),
        ("rdf_first_peak_A_A", 2.821),
        ("rdf_first_peak_A_B", 3.294),
    ] {
        let row = row(&compared, quantity);
        // Energies of so short a run may be no results.
        if row["verdict"] == "too-short" {
            continue;
        }
        judged += 1;
        assert_eq!(row["primary"], true, "{quantity}");
        assert_eq!(row["reference"], reference, "{row}");
        let is_coarse = row["tolerance"].as_f64() > row["scale"].as_f64().map(|s| 0.05 * s);
        let verdict = if is_coarse { "too-coarse" } else { "agrees" };
        assert_eq!(row["verdict"], verdict, "{row}");
        assert!(row["source"].as_str().unwrap().contains("`kob-andersen`"));
    }
    assert!(judged >= 3, "{judged}");
    assert!(row(&compared, "rdf_first_peak_B_B")["reference"].is_null());
    // A third of a per cent colder is another state: nothing is taken between two rows.
    for change in ["system.temperature=1.993", "system.n_atoms=256"] {
        let compared =
            kob_andersen(&[change, "stage.equilibrate.steps=100", "stage.production.steps=300"]);
        let rows = compared["rows"].as_array().unwrap();
        assert!(rows.iter().all(|r| r["source"] != "gamdpy (table `kob-andersen`)"));
        let remarks = compared["remarks"].to_string();
        assert!(remarks.contains("(ρ 1.2, T 1.028, x_A 0.8)"), "{remarks}");
    }
}
