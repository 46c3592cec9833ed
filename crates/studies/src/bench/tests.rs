use super::*;
use crate::Silent;

fn options(set: &[(&str, &str)]) -> BenchOptions {
    let small = [("system.n_atoms", "108"), ("truncation.r_cut", "2.2")];
    let set = small.iter().chain(set);
    BenchOptions {
        scene: usual_scene(true),
        overrides: set.map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect(),
        isas: vec!["portable".into()],
        precisions: vec![],
        threads: vec![1],
        repeats: 2,
        quick: true,
        command: "lennard study bench".into(),
        machine: vec![],
    }
}

#[test]
fn each_variant_is_measured_once_and_its_numbers_agree_with_one_another() {
    let study = Bench::new(options(&[])).unwrap().run(&mut Silent).unwrap();
    assert_eq!(
        (study.atoms, study.kernels.len()),
        (108, 1),
        "portable lanes have no mixed precision"
    );
    for k in &study.kernels {
        assert_eq!(k.threads, 1);
        for s in [k.speed, k.step_ns, k.forces_ns, k.totals_ns, k.list_share] {
            assert!(s.lowest <= s.median && s.median <= s.highest && s.lowest >= 0.0, "{k:?}");
        }
        // ns per atom-step and million atom-steps a second are the same measurement.
        assert!((k.speed.highest * k.step_ns.lowest - 1e3).abs() < 1e-6);
        // A list holds more than the pairs that count, and a pair that counts is never left out.
        assert!(k.lanes_per_pair >= 1.0 && k.lanes_per_pair < 20.0, "{}", k.lanes_per_pair);
        assert!(k.bytes_per_atom > 72.0);
        assert!(k.limit.is_some_and(|l| l > 0.0) && k.limit_share.is_some_and(|s| s > 0.0));
    }
    // (2π/3)·ρ·r_cut³ pairs per atom in a structureless fluid: near it in a dense one.
    let expected = 2.0 / 3.0 * std::f64::consts::PI * study.density * study.r_cut.powi(3);
    assert!((study.pairs_per_atom / expected - 1.0).abs() < 0.1, "{}", study.pairs_per_atom);
    let skin = study.skin.as_ref().unwrap();
    assert!(skin.points.iter().any(|p| p.skin == skin.chosen) && skin.excess >= 0.0);
}

#[test]
fn the_state_that_is_timed_has_the_temperature_that_a_bath_of_the_scene_holds() {
    let mut options = options(&[("system.n_atoms", "864"), ("stage.melt.thermostat", "bussi")]);
    options.precisions = vec!["double".into()];
    options.repeats = 1;
    let study = Bench::new(options.clone()).unwrap().run(&mut Silent).unwrap();
    let scene = load(&options.scene, &options.overrides).unwrap();
    let wanted = lennard_engine::measured_stage(&scene).temperature;
    // Four times the canonical fluctuation of 864 particles, T·√(2/3N).
    let allowed = 4.0 * (2.0 / (3.0 * 864.0_f64)).sqrt();
    let off = study.temperature / wanted - 1.0;
    assert!(off.abs() < allowed, "{off}");
}
