//! Runs at constant pressure: conservation, the right pressure and density, and what is refused.

use lennard_engine::{Simulation, Unfollowed};
use lennard_observables::ChangingBox;
use lennard_scene::Scene;

use crate::common;

/// A liquid at T = 1.2 and P = 1.19, where the density is 0.75.
const LIQUID: &str = r#"
    system = { n_atoms = 256, density = 0.72, temperature = 1.2, seed = 31 }
    truncation = { r_cut = 3.0 }
    integrator = { dt = 0.004 }
    [[stage]]
    name = "equilibrate"
    steps = 400
    thermostat = { kind = "bussi", tau = 0.1 }
    barostat = { kind = "stochastic-cell-rescaling", pressure = 1.19 }
    [[stage]]
    name = "production"
    steps = 400
    thermostat = "bussi"
    barostat = { kind = "stochastic-cell-rescaling", pressure = 1.19 }
"#;

fn scene(overrides: &str) -> Scene {
    common::scene(LIQUID, overrides)
}

fn ran(overrides: &str) -> Simulation {
    common::ran(scene(overrides))
}

/// Both stages with this barostat, and the bath that it goes with.
fn with_barostat(barostat: &str, bath: &str) -> String {
    let of = |stage: &str| format!("{stage}.barostat={barostat} {stage}.thermostat={bath}");
    of("stage.equilibrate") + " " + &of("stage.production")
}

/// Stages at constant volume.
const CLOSED: &str = "stage.equilibrate.barostat=none stage.production.barostat=none";

/// Every barostat by its scene words, with a bath.
fn barostats() -> Vec<(String, &'static str)> {
    let specs = lennard_integrators::barostats().iter();
    let words = |kind: &str| format!("{{ kind = \"{kind}\", pressure = 1.19 }}");
    specs.map(|s| (words(s.name), s.thermostat.unwrap_or("bussi"))).collect()
}

#[test]
fn the_conserved_quantity_has_the_tail_of_the_box_as_it_is() {
    for (barostat, bath) in barostats() {
        let long = "stage.equilibrate.steps=4000 stage.production.steps=4000
            output.thermo_every=10";
        let simulation = ran(&format!("{} {long}", with_barostat(&barostat, bath)));
        let volume = simulation.state.cell.volume();
        let tail = simulation.tail().unwrap().pressure * volume * volume;
        assert!((simulation.stage_run().tail_work / tail - 1.0).abs() < 1e-12);
        let kept = simulation.thermodynamics().conservation();
        // 2·10⁻⁴ ε per particle is the energy error of the steps; U_tail in place of V·P_tail makes it 19 times as much.
        assert!(kept.energy_rms_per_atom < 4e-4, "{barostat}: {}", kept.energy_rms_per_atom);
        // Sixteen τ of a drift of 10⁻⁵ ε/τ would be as large as the fluctuation.
        let drift = kept.energy_drift_per_atom_per_tau;
        assert!(drift.abs() < 3e-5, "{barostat}: {drift:e}");
    }
}

#[test]
fn nose_hoover_chains_conserve_their_energy_at_constant_volume() {
    let simulation = ran(&format!(
        "{CLOSED} stage.production.thermostat=nose-hoover stage.equilibrate.steps=2000
            stage.production.steps=10000"
    ));
    let kept = simulation.thermodynamics().conservation();
    assert!(kept.energy_rms_per_atom < 3e-4, "{kept:?}");
    let drift = kept.energy_drift_per_atom_per_tau;
    assert!(drift.abs() < 1e-6 + 4.0 * kept.energy_drift_standard_error, "{kept:?}");
    let series = &simulation.thermodynamics().series().temperature;
    let mean = series.iter().sum::<f64>() / series.len() as f64;
    assert!((mean - 1.2).abs() < 0.02, "{mean}");
}

#[test]
fn a_ramp_takes_the_fluid_from_one_temperature_to_the_other() {
    for bath in ["bussi", "langevin", "nose-hoover", "rescale"] {
        let simulation = ran(&format!(
            "{CLOSED} stage.production.thermostat={bath} stage.equilibrate.steps=1000
                stage.production.temperature={{ from = 1.2, to = 2.4 }} stage.production.steps=5000"
        ));
        let series = &simulation.thermodynamics().series().temperature;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        // The middle fifth and the last tenth of the way.
        let n = series.len();
        let (middle, end) = (mean(&series[2 * n / 5..3 * n / 5]), mean(&series[9 * n / 10..]));
        assert!((middle - 1.8).abs() < 0.1, "{bath}: {middle}");
        assert!((end - 2.34).abs() < 0.12, "{bath}: {end}");
    }
}

#[test]
fn boiling_is_foreseen() {
    let boiling =
        "{ kind = \"stochastic-cell-rescaling\", pressure = 0.01, compressibility = 0.1 }";
    let simulation = common::prepared(scene(&format!(
        "system.temperature=1.0
        stage.production.barostat={boiling} stage.production.temperature=1.0"
    )));
    let said = simulation.remarks.join("\n");
    assert!(said.contains("a liquid boils in the end"), "{said}");
}

/// κ sets how far the box is proposed to move: with the κ of the gas, the first proposals were boxes of less than two cutoffs.
#[test]
fn a_liquid_that_will_boil_and_a_great_pressure_have_proposals_of_their_own_size() {
    for pressure in ["0.01", "500"] {
        let words = format!("{{ kind = \"stochastic-cell-rescaling\", pressure = {pressure} }}");
        let short = "stage.equilibrate.steps=60 stage.production.steps=60 truncation.r_cut=2.0";
        let volume =
            ran(&format!("{} {short}", with_barostat(&words, "bussi"))).state.cell.volume();
        assert!(volume != 256.0 / 0.72, "{pressure}: no proposal was accepted");
    }
}

#[test]
fn a_box_that_shrinks_below_twice_the_cutoff_stops_the_run_by_name() {
    // No equation of state describes the shifted force, so that nothing is foreseen.
    let pressed =
        "{ kind = \"stochastic-cell-rescaling\", pressure = 60.0, interval = 1, tau = 0.2 }";
    let mut simulation = common::prepared(scene(&format!(
        "system.n_atoms=108
        truncation.kind=force-shift truncation.r_cut=2.5
        stage.equilibrate.barostat={pressed} stage.equilibrate.steps=5000"
    )));
    let message = simulation.follow(&mut Unfollowed).unwrap_err().to_string();
    let words = [
        "the box has shrunk to ",
        "below twice the cutoff of 2.5 σ",
        "take more particles, a shorter cutoff or a lower pressure",
    ];
    common::contains(&message, &words);
}

#[test]
#[ignore = "minutes: run by `cargo xtask physics`"]
fn the_mean_pressure_is_that_of_the_barostat_and_the_density_that_of_the_equation() {
    for (barostat, bath) in barostats() {
        let simulation = ran(&format!(
            "{} system.n_atoms=864 truncation.r_cut=4.0 stage.equilibrate.steps=10000
                stage.production.steps=100000",
            with_barostat(&barostat, bath)
        ));
        let findings = simulation.findings();
        let average = |name: &str| {
            let found = common::average(&findings, name).unwrap().estimate;
            (found.mean, found.standard_error)
        };
        let (volume, _) = average("volume");
        let (pressure, error) = average("pressure");
        // Without total momentum the mean of ρT + W/3V + P_tail is P₀ + T/V.
        let wanted = 1.19 + 1.2 / volume;
        assert!((pressure - wanted).abs() < 3.0 * error + 1e-3, "{barostat}: {pressure} ± {error}");
        let (density, error) = average("density");
        let equation = lennard_literature::thol_2016();
        let reference = equation.density(wanted, 1.2).unwrap();
        assert!(
            (density - reference).abs() < 3.0 * error + 0.001 * reference,
            "{barostat}: {density} ± {error} where {reference}"
        );
        assert!(simulation.observable::<ChangingBox>().is_some());
    }
}
