//! Mixtures as a user runs them.

use serde_json::Value;

use crate::program::common::*;

/// The shipped scene of Kob and Andersen with 500 particles and changes: what `compare` says of it.
fn kob_andersen(changes: &str) -> Value {
    let place = Place::with(&[]);
    place.succeed(&format!(
        "run mixture/kob-andersen --out out --no-report --quiet --set system.n_atoms=500 \
         --set start.lattice=fcc {changes}"
    ));
    place.json("compare out")["runs"][0].clone()
}

#[test]
fn a_run_of_kob_andersen_stands_beside_the_runs_of_others_at_their_states_alone() {
    let compared =
        kob_andersen("--set stage.equilibrate.steps=2000 --set stage.production.steps=12000");
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
        let is_coarse = number(&row["tolerance"]) > 0.05 * number(&row["scale"]);
        assert_eq!(row["verdict"], if is_coarse { "too-coarse" } else { "agrees" }, "{row}");
        contains(row["source"].as_str().unwrap(), &["`kob-andersen`"]);
    }
    assert!(judged >= 3, "{judged}");
    assert!(row(&compared, "rdf_first_peak_B_B")["reference"].is_null());
    // A third of a per cent colder is another state: nothing is taken between two rows.
    for change in ["system.temperature=1.993", "system.n_atoms=256"] {
        let short = "--set stage.equilibrate.steps=100 --set stage.production.steps=300";
        let compared = kob_andersen(&format!("--set {change} {short}"));
        let rows = compared["rows"].as_array().unwrap();
        assert!(rows.iter().all(|r| r["source"] != "gamdpy (table `kob-andersen`)"));
        contains(&compared["remarks"].to_string(), &["(ρ 1.2, T 1.028, x_A 0.8)"]);
    }
}
