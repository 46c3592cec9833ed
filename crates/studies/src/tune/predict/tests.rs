//! The ceiling of the step, and the law of the drift by crossings of the cutoff.

use super::*;

#[test]
fn the_ceiling_is_the_last_rung_before_the_drift_and_the_law_passes_through_what_is_seen() {
    let rung = |dt, drift| Rung { dt, drift };
    let drift = |mean| Some(Estimate::new(mean, 2e-7, f64::NAN));
    let rungs = vec![
        rung(0.010, drift(1e-7)),
        rung(0.012, drift(1e-5)),
        rung(0.016, drift(8e-4)),
        rung(0.020, None),
    ];
    let free = Stability::of(&rungs, None);
    assert_eq!(free.ceiling, 0.016);
    assert!((free.of_step(0.012) / 1e-5 - 1.0).abs() < 1e-9);
    assert!((free.of_step(0.016) / 8e-4 - 1.0).abs() < 1e-9);
    assert!(free.of_step(0.006) < 1e-10);
    assert_eq!(Stability::of(&rungs, Some(2e-5)).ceiling, 0.012);
    assert_eq!(Stability::of(&rungs[3..], None).ceiling, 0.010);
    // What a short run cannot tell is not taken for good.
    assert_eq!(Stability::of(&rungs, Some(2e-7)).ceiling, 0.005);
}

#[test]
fn energy_diffuses_by_crossings_of_the_cutoff_as_the_law_says() {
    // A cutoff of 1.5 σ, where the force jumps by 1.2 ε/σ, drowns every other error of the step.
    const TEXT: &str = "[system]\nn_atoms = 256\ndensity = 0.6\ntemperature = 1.2\n\
        [truncation]\nr_cut = 1.5\n[integrator]\ndt = 0.004\n\
        [[stage]]\nname = \"heat\"\nsteps = 1500\nthermostat = \"bussi\"\n\
        [[stage]]\nname = \"p\"\nsteps = 40000\n[output]\nthermo_every = 125\n\
        [[observable]]\nkind = \"rdf\"\nevery = 125\nr_max = 1.5\nbins = 30\n";
    let scene = Scene::parse(TEXT, "test.toml", &[]).unwrap();
    let dt = scene.integrator.dt;
    let mut simulation = lennard_engine::prepare(scene.clone()).unwrap();
    simulation.run().unwrap();
    let rows = simulation.thermodynamics().series();
    let energies = rows.conserved_energy.windows(2).map(|w| (256.0 * (w[1] - w[0])).powi(2));
    let steps: Vec<f64> = energies.collect();
    let measured = lennard_observables::statistics::mean(&steps) / (256.0 * 125.0 * dt);
    let t = lennard_observables::statistics::mean(&rows.temperature);
    // Pairs in the last twentieth of a diameter below the cutoff.
    let rdf = simulation.findings().into_iter().flat_map(|found| found.tables);
    let g = *rdf.filter_map(|table| table.numbers("g")).next().unwrap().last().unwrap();
    let model = Model::new(&scene.potential, &scene.truncation).unwrap();
    let pair = scene.species_pair(0, 0);
    let law = variance_growth(&model, &pair, 0.5 * 0.6 * g, 2.0 * t, dt);
    // 320 squares of normal increments know their mean to 8 %; the bounded error of the step adds some per cent.
    assert!((measured / law - 1.0).abs() < 0.3, "{measured:e} {law:e}");
}
