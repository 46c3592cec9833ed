//! Response functions of whole runs, where they are known exactly, and where there are none.

use lennard_observables::{Average, Findings, Observable};

use crate::common;

const FLUID: &str = r#"
    system = { n_atoms = 256, density = 0.6, temperature = 1.2, seed = 3 }
    truncation = { r_cut = 3.0 }
    integrator = { dt = 0.004 }
    stage = [
        { name = "equilibrate", steps = 500, thermostat = { kind = "bussi", tau = 0.1 } },
        { name = "production", steps = 2000 },
    ]
"#;

fn findings(overrides: &str) -> Findings {
    let simulation = common::ran(common::scene(FLUID, overrides));
    simulation.thermodynamics().finish(0.0)
}

fn named<'a>(findings: &'a Findings, name: &str) -> Option<&'a Average> {
    findings.averages.iter().find(|a| a.name == name)
}

const BATH: &str = "stage.production.thermostat=bussi";

#[test]
fn a_power_has_its_exact_scaling_exponent() {
    // U = W/12 for r⁻¹²: γ = 12/3 and R = 1, whatever the run, except for pairs that cross the cutoff with u = 6e-7.
    let found = findings(&format!(
        r#"potential={{ kind = "soft-sphere", exponent = 12 }}
        truncation.r_cut=3.3 {BATH}"#
    ));
    let value = |name| named(&found, name).unwrap().estimate.mean;
    let (gamma, r) = (value("density_scaling_exponent"), value("energy_virial_correlation"));
    assert!((gamma - 4.0).abs() < 1e-4 && (r - 1.0).abs() < 1e-6, "{gamma} {r}");
    assert!(value("speed_of_sound") > 0.0);
}

#[test]
fn every_ensemble_gives_response_functions_and_says_how() {
    let held = format!(
        r#"{BATH} stage.production.barostat={{ kind = "stochastic-cell-rescaling", pressure = 0.5 }}"#
    );
    for (overrides, words) in [
        ("", "of K and W at constant energy"),
        (BATH, "of U and W at constant temperature"),
        (&held, "of volume and enthalpy at constant pressure"),
    ] {
        let found = findings(overrides);
        let said = found.remarks_in_words();
        assert!(said.contains(words), "{said}");
        for name in ["heat_capacity", "heat_capacity_pressure", "speed_of_sound"] {
            assert!(named(&found, name).is_some(), "{words}: no {name}");
        }
        let r = named(&found, "energy_virial_correlation");
        assert_eq!(r.is_some(), words.contains("U and W"));
    }
}

#[test]
fn what_an_ensemble_or_a_truncation_does_not_give_is_said_by_name() {
    let scaled = findings("stage.production.thermostat=rescale");
    assert!(named(&scaled, "speed_of_sound").is_none());
    let said = scaled.remarks_in_words();
    assert!(
        said.contains("no response functions: the measured stages sample no ensemble"),
        "{said}"
    );
    let bent = findings(&format!("truncation.kind=force-shift {BATH}"));
    assert!(named(&bent, "speed_of_sound").is_none());
    assert!(named(&bent, "thermal_pressure_coefficient").is_some());
    let said = bent.remarks_in_words();
    assert!(said.contains("not given") && said.contains("speed_of_sound"), "{said}");
}
