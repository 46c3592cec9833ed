//! Means of whole runs: where they are known exactly, where two roads lead to them, and where there are none.

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
    common::average(std::slice::from_ref(findings), name)
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
    let words = ["no response functions: the measured stages sample no ensemble"];
    common::contains(&scaled.remarks_in_words(), &words);
    let bent = findings(&format!("truncation.kind=force-shift {BATH}"));
    assert!(named(&bent, "speed_of_sound").is_none());
    assert!(named(&bent, "thermal_pressure_coefficient").is_some());
    common::contains(&bent.remarks_in_words(), &["not given", "speed_of_sound"]);
}

/// T of velocities and of positions, the frequency of forces and of velocities, D of displacements and of velocities, and U from g(r).
#[test]
fn temperature_diffusion_and_structure_of_a_fluid_agree_by_independent_roads() {
    let run = common::ran(common::scene(
        FLUID,
        r#"system={ n_atoms = 108, density = 0.8, temperature = 1.2, seed = 5 }
            truncation={ r_cut = 2.5, tail_correction = false } stage.equilibrate.steps=1500
            stage.production.steps=10000 output.thermo_every=5 observable=[
            { kind = "msd", every = 5 }, { kind = "vacf", every = 5, window = 2.0 },
            { kind = "rdf", every = 50 }, { kind = "einstein-frequency", every = 5 }]"#,
    ));
    let all = run.findings();
    let mean = |name: &str| common::average(&all, name).unwrap().estimate;
    let column = |name: &str| all.iter().flat_map(|f| &f.tables).find_map(|t| t.numbers(name));
    let column = |name: &str| column(name).unwrap();
    let agree = |one: &str, other: &str, most: f64| {
        let (a, b) = (mean(one), mean(other));
        let error = a.standard_error.hypot(b.standard_error);
        assert!((a.mean - b.mean).abs() < 4.0 * error && error < most * a.mean, "{a:?} {b:?}");
    };
    agree("temperature", "configurational_temperature", 0.01);
    let by_velocities = "diffusion_coefficient_green_kubo";
    agree("diffusion_coefficient_uncorrected", by_velocities, 0.12);

    // ⟨F²⟩ = m·T·⟨∇²U⟩, and the velocity forgets itself as 1 − Ω_E²·t²/2 + O(t⁴): a tenth of it at the first lag.
    let frequency = mean("einstein_frequency").mean;
    let forces = &run.thermodynamics().series().squared_force;
    let squared_force = forces.iter().sum::<f64>() / forces.len() as f64;
    let by_forces = (squared_force / 3.0 / mean("temperature").mean).sqrt();
    assert!((frequency / by_forces - 1.0).abs() < 0.01, "{frequency} {by_forces}");
    let remembered = column("vacf");
    let by_velocities = (2.0 * (1.0 - remembered[1] / remembered[0])).sqrt() / (5.0 * 0.004);
    assert!((frequency / by_velocities - 1.0).abs() < 0.05, "{frequency} {by_velocities}");

    // U/N = ½(N − 1)/V·Σ g·U·(shell), up to the cutoff. Bins of 0.011 σ replace U by its value in the middle, which errs by 1e-3 of
    // each of a dozen pairs.
    let (radii, g) = (column("r"), column("g"));
    let pairs = radii.iter().zip(&g).filter(|(r, _)| **r < 2.5);
    let energy: f64 = pairs.map(|(r, g)| (r.powi(-10) - r.powi(-4)) * g).sum();
    let shells = 8.0 * std::f64::consts::PI * (radii[1] - radii[0]);
    let energy = shells * energy * 107.0 / run.state.cell.volume();
    assert!((energy - mean("potential_energy").mean).abs() < 0.05, "{energy}");
    // A dense liquid has some twelve neighbors, as the close-packed lattice has.
    let neighbors = mean("coordination_number").mean;
    assert!((11.0..13.0).contains(&neighbors), "{neighbors}");
}
