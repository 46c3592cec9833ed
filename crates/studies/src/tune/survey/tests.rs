use lennard_core::random::Streams;
use lennard_forcefield::TruncationKind;
use rand_distr::{Distribution, StandardNormal};

use super::*;

/// A survey with these frames of `n_atoms` particles in `volume`, at T = 0.8, of a cut Lennard-Jones fluid.
fn survey(frames: Vec<Frame>, n_atoms: usize, volume: f64, sight: f64) -> (Scene, Survey) {
    const TEXT: &str = "[system]\nn_atoms = 864\ndensity = 0.5\ntemperature = 0.8\n\
                        [truncation]\nr_cut = 3.0\n[[stage]]\nname = \"p\"\nsteps = 1\n";
    let scene = Scene::parse(TEXT, "test.toml", &[]).unwrap();
    let run = Terms::of(&scene, scene.truncation, n_atoms, volume, sight).unwrap();
    let survey = Survey {
        frames,
        ends: Vec::new(),
        time: 1.0,
        temperature: 0.8,
        n_atoms: n_atoms as f64,
        volume,
        n_dof: 3.0 * n_atoms as f64,
        run,
    };
    (scene, survey)
}

#[test]
fn the_step_law_of_oscillators_is_the_exact_one() {
    // 30 oscillators ½kx² in each of three directions: With velocity Verlet, U per particle is 3T/2·(1 + h²k/4) at the kinetic
    // temperature of whole steps, and 3T/2 at the temperature of half steps. W is taken as 2U for a second quantity of a known law.
    let (n, k, t) = (30, 7.0, 0.8_f64);
    let noise = Streams::new(5).noise("oscillators");
    let frames = (0..20_000)
        .map(|i| {
            let mut random = noise.at(i, 0);
            let squares: f64 = (0..3 * n)
                .map(|_| {
                    let x: f64 = StandardNormal.sample(&mut random);
                    x * x * t / k
                })
                .sum();
            Frame {
                potential: 0.5 * k * squares,
                virial: k * squares,
                squared_force: k * k * squares,
                laplacian: 3.0 * n as f64 * k,
                pairs: Vec::new(),
            }
        })
        .collect();
    let (_, survey) = survey(frames, n, 10.0, 3.0);
    for nothing in survey.step_law(true) {
        assert!(nothing.mean.abs() < 1e-12, "{nothing:?}");
    }
    let [energy, pressure] = survey.step_law(false);
    let exact = 1.5 * t * k / 4.0;
    assert!(
        (energy.mean - exact).abs() < 4.0 * energy.standard_error,
        "{energy:?} {exact}"
    );
    assert!(energy.standard_error < 0.02 * exact);
    let exact = 2.0 * exact * n as f64 / 30.0;
    assert!(
        (pressure.mean - exact).abs() < 4.0 * pressure.standard_error,
        "{pressure:?} {exact}"
    );
    // ∂U/∂T of 3N oscillators is 3/2 a particle.
    assert!((survey.slopes().du_dt - 1.5).abs() < 0.05);
}

/// Frames in which every pair distance is as likely as in an ideal gas, times g(r).
fn frame(n: f64, density: f64, bins: usize, g: impl Fn(f64) -> f64) -> Frame {
    let pairs = (0..bins)
        .map(|bin| {
            let (low, high) = (bin as f64 * BIN_WIDTH, (bin + 1) as f64 * BIN_WIDTH);
            let shell = 4.0 / 3.0 * std::f64::consts::PI * (high.powi(3) - low.powi(3));
            (0.5 * n * density * shell * g(0.5 * (low + high))) as f32
        })
        .collect();
    Frame {
        potential: 0.0,
        virial: 0.0,
        squared_force: 1.0,
        laplacian: 1.0,
        pairs,
    }
}

#[test]
fn where_g_is_one_the_tail_makes_every_cutoff_the_same() {
    let (n, density, sight) = (864.0, 0.5, 6.0);
    let frames = (0..4)
        .map(|_| frame(n, density, bins_within(sight), |_| 1.0))
        .collect();
    let (scene, survey) = survey(frames, 864, n / density, sight);
    let at = |r_cut: f64, kind| {
        survey
            .terms(&scene, TruncationOptions::new(kind, r_cut))
            .unwrap()
    };
    let full = at(f64::MAX, TruncationKind::Cut);
    for r_cut in [2.0, 2.513, 4.0] {
        let change = survey.difference(&at(r_cut, TruncationKind::Cut), &full);
        for c in change {
            // Bins of 0.02 σ and counts in single precision.
            assert!(c.direct.mean.abs() < 1e-4, "{r_cut}: {c:?}");
            assert_eq!(c.response.mean, 0.0);
        }
    }
    // Without its tail the energy lacks 2πρ∫r²U dr = 8πρ/3·(r⁻⁹/3 − r⁻³).
    let shifted = survey.difference(&at(2.5, TruncationKind::ForceShift), &full)[0]
        .direct
        .mean;
    let tail =
        8.0 * std::f64::consts::PI * density / 3.0 * (2.5_f64.powi(-9) / 3.0 - 2.5_f64.powi(-3));
    assert!(shifted > -tail && shifted < -4.0 * tail, "{shifted} {tail}");
}

#[test]
fn a_shell_of_neighbors_beyond_the_cutoff_is_missed_by_its_energy() {
    // g = 1.5 between 3.2 and 3.4 σ: cutting at 3 misses half of what an even fluid has there.
    let (n, density, sight) = (864.0, 0.5, 6.0);
    let shell = |r: f64| if (3.2..3.4).contains(&r) { 1.5 } else { 1.0 };
    let frames = (0..4)
        .map(|_| frame(n, density, bins_within(sight), shell))
        .collect();
    let (scene, survey) = survey(frames, 864, n / density, sight);
    let at = |r_cut: f64| {
        survey
            .terms(&scene, TruncationOptions::new(TruncationKind::Cut, r_cut))
            .unwrap()
    };
    let full = at(f64::MAX);
    let missed = survey.difference(&at(3.0), &full)[0].direct.mean;
    let r = 3.3_f64;
    let energy = 4.0 * (r.powi(-12) - r.powi(-6));
    let expected = -0.5 * 2.0 * std::f64::consts::PI * density * r * r * 0.2 * energy;
    assert!(
        (missed / expected - 1.0).abs() < 0.02,
        "{missed} {expected}"
    );
    assert!(survey.difference(&at(3.6), &full)[0].direct.mean.abs() < 1e-4);
    assert!((survey.g(3.3) - 1.5).abs() < 1e-3 && (survey.g(2.0) - 1.0).abs() < 1e-3);
}

#[test]
fn a_response_that_is_lost_in_noise_adds_an_uncertainty_and_no_error() {
    let value = |mean, standard_error| Value {
        mean,
        standard_error,
        n_effective: 10.0,
    };
    let lost = Change {
        direct: value(1.0, 0.0),
        response: value(0.01, 1.0),
    }
    .total();
    assert!((lost.mean - 1.0).abs() < 1e-4 && lost.standard_error == 0.5);
    let seen = Change {
        direct: value(1.0, 0.0),
        response: value(1.0, 0.1),
    }
    .total();
    assert!((seen.mean - 1.99).abs() < 0.01 && (seen.standard_error - 0.1).abs() < 0.001);
}
