//! Exchanges of velocities: what they keep, and what they drive.

use lennard_engine::Simulation;

use crate::common;

/// A dense gas in a long box at constant energy.
const GAS: &str = r#"
    system = { n_atoms = 324, box = [7.6, 7.6, 22.8], temperature = 1.9, seed = 5 }
    truncation = { kind = "switch", r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 4000 }]
    output = { thermo_every = 10 }
"#;

fn run(exchange: &str, steps: &str, dt: &str) -> Simulation {
    let overrides = format!(
        "stage.production.exchange={exchange}
        stage.production.steps={steps} integrator.dt={dt}"
    );
    common::ran(common::scene(GAS, &overrides))
}

/// The profile of a run: a value for each slab, and the mean named.
fn found(simulation: &Simulation, name: &str) -> (Vec<f64>, f64) {
    let all = simulation.findings();
    let table = all.iter().flat_map(|f| &f.tables).find(|t| t.name == "exchange_profile").unwrap();
    let average = common::average(&all, name).unwrap();
    (table.columns[2].numbers(), average.estimate.mean)
}

#[test]
fn exchanges_keep_energy_and_momentum() {
    for kind in ["heat", "momentum"] {
        let exchange = format!("{{ kind = {kind:?}, every = 20, slabs = 12 }}");
        // What the method conserves depends on the step: an exchange takes a part of order dt² of it.
        let driven = run(&exchange, "4000", "0.001");
        let start = driven.stage.as_ref().unwrap().start_energy;
        let end = driven.conserved_energy_per_particle().unwrap();
        // 200 exchanges of about 3 ε each would show as 2 ε for each particle.
        assert!((end - start).abs() < 1e-4, "{kind}: {end} {start}");
        let momentum = driven.system.momentum(&driven.state.velocities);
        assert!(momentum.length() < 1e-9, "{kind}: {momentum}");
    }
}

#[test]
fn heat_goes_to_the_middle_slab_and_momentum_to_the_first() {
    let driven = run("{ kind = \"heat\", every = 10, slabs = 12 }", "4000", "0.004");
    let (t, lambda) = found(&driven, "thermal_conductivity_by_exchange");
    assert!(t[6] > t[3] + 0.1 && t[3] > t[0] + 0.1, "{t:?}");
    assert!((0.2..3.0).contains(&lambda), "{lambda}");
    let driven =
        run("{ kind = \"momentum\", every = 10, slabs = 12, axis = \"z\" }", "4000", "0.004");
    let (v, eta) = found(&driven, "viscosity_by_exchange");
    assert!(v[0] > v[3] + 0.05 && v[3] > v[6] + 0.05, "{v:?}");
    assert!((0.1..2.0).contains(&eta), "{eta}");
    // A fluid with a gradient has no response functions of its own.
    assert_eq!(common::average(&driven.findings(), "heat_capacity_pressure"), None);
}
