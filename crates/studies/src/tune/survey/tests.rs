use lennard_core::System;
use lennard_core::random::Streams;
use lennard_forcefield::TruncationKind;
use rand_distr::{Distribution, StandardNormal};

use super::*;

/// A survey with these frames of `n_atoms` particles in `volume`, at T = 0.8, of a cut Lennard-Jones fluid.
fn survey(frames: Vec<Frame>, n_atoms: usize, volume: f64, sight: f64) -> (Scene, Survey) {
    const TEXT: &str = "[system]\nn_atoms = 864\ndensity = 0.5\ntemperature = 0.8\n\
                        [truncation]\nr_cut = 3.0\n[[stage]]\nname = \"p\"\nsteps = 1\n";
    let scene = Scene::parse(TEXT, "test.toml", &[]).unwrap();
    let fluid = Fluid::of(&scene, System::atoms(n_atoms));
    let run = Terms::of(&scene, scene.truncation, &fluid, volume, sight).unwrap();
    let survey = Survey {
        frames,
        ends: Vec::new(),
        time: 1.0,
        temperature: 0.8,
        n_atoms: n_atoms as f64,
        volume,
        fluid,
        run,
    };
    (scene, survey)
}

/// Pairs of atoms.
fn counts(pairs: Vec<f32>) -> Counts {
    Counts { pairs, leverage: None }
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
                laplacian: Some((3.0 * n as f64 - 3.0) * k),
                counts: counts(Vec::new()),
            }
        })
        .collect();
    let (_, survey) = survey(frames, n, 10.0, 3.0);
    for nothing in survey.step_law(true) {
        assert!(nothing.mean.abs() < 1e-12, "{nothing:?}");
    }
    let [energy, pressure] = survey.step_law(false);
    let exact = 1.5 * t * k / 4.0;
    assert!((energy.mean - exact).abs() < 4.0 * energy.standard_error, "{energy:?} {exact}");
    assert!(energy.standard_error < 0.02 * exact);
    let exact = 2.0 * exact * n as f64 / 30.0;
    assert!((pressure.mean - exact).abs() < 4.0 * pressure.standard_error, "{pressure:?} {exact}");
    // ∂U/∂T of 3N oscillators is 3/2 a particle.
    assert!((survey.slopes().du_dt - 1.5).abs() < 0.05);
}

/// Density of the fluid that is known by its g(r), and how far its pairs are seen.
const EVEN: (f64, f64) = (0.5, 6.0);

/// A survey in which every pair distance is as likely as in an ideal gas, times g(r).
fn survey_of(g: impl Fn(f64) -> f64) -> (Scene, Survey) {
    let (n, (density, sight)) = (864.0, EVEN);
    let pairs: Vec<f32> = (0..bins_within(sight))
        .map(|bin| {
            let (low, high) = (bin as f64 * BIN_WIDTH, (bin + 1) as f64 * BIN_WIDTH);
            let shell = 4.0 / 3.0 * std::f64::consts::PI * (high.powi(3) - low.powi(3));
            (0.5 * n * density * shell * g(0.5 * (low + high))) as f32
        })
        .collect();
    let frame = || Frame {
        potential: 0.0,
        virial: 0.0,
        squared_force: 1.0,
        laplacian: Some(1.0),
        counts: counts(pairs.clone()),
    };
    survey((0..4).map(|_| frame()).collect(), 864, n / density, sight)
}

#[test]
fn where_g_is_one_the_tail_makes_every_cutoff_the_same() {
    let (density, (scene, survey)) = (EVEN.0, survey_of(|_| 1.0));
    let at = |r_cut: f64, kind| survey.terms(&scene, TruncationOptions::new(kind, r_cut)).unwrap();
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
    let shifted = survey.difference(&at(2.5, TruncationKind::ForceShift), &full)[0].direct.mean;
    let tail =
        8.0 * std::f64::consts::PI * density / 3.0 * (2.5_f64.powi(-9) / 3.0 - 2.5_f64.powi(-3));
    assert!(shifted > -tail && shifted < -4.0 * tail, "{shifted} {tail}");
}

#[test]
fn a_shell_of_neighbors_beyond_the_cutoff_is_missed_by_its_energy() {
    // g = 1.5 between 3.2 and 3.4 σ: cutting at 3 misses half of what an even fluid has there.
    let shell = |r: f64| if (3.2..3.4).contains(&r) { 1.5 } else { 1.0 };
    let (density, (scene, survey)) = (EVEN.0, survey_of(shell));
    let at = |r_cut: f64| {
        survey.terms(&scene, TruncationOptions::new(TruncationKind::Cut, r_cut)).unwrap()
    };
    let full = at(f64::MAX);
    let missed = survey.difference(&at(3.0), &full)[0].direct.mean;
    let r = 3.3_f64;
    let energy = 4.0 * (r.powi(-12) - r.powi(-6));
    let expected = -0.5 * 2.0 * std::f64::consts::PI * density * r * r * 0.2 * energy;
    assert!((missed / expected - 1.0).abs() < 0.02, "{missed} {expected}");
    assert!(survey.difference(&at(3.6), &full)[0].direct.mean.abs() < 1e-4);
    assert!((survey.g(0, 3.3) - 1.5).abs() < 1e-3 && (survey.g(0, 2.0) - 1.0).abs() < 1e-3);
}

#[test]
fn a_response_that_is_lost_in_noise_adds_an_uncertainty_and_no_error() {
    let value = |mean, standard_error| Estimate::new(mean, standard_error, 10.0);
    let lost = Change { direct: value(1.0, 0.0), response: value(0.01, 1.0) }.total();
    assert!((lost.mean - 1.0).abs() < 1e-4 && lost.standard_error == 0.5);
    let seen = Change { direct: value(1.0, 0.0), response: value(1.0, 0.1) }.total();
    assert!((seen.mean - 1.99).abs() < 0.01 && (seen.standard_error - 0.1).abs() < 0.001);
}

/// The scene of these tables and an accuracy.
fn accurate(tables: &str) -> Scene {
    let stages = "accuracy = { potential_energy = 0.01 }\n[[stage]]\nname = \"e\"\nsteps = 300\nthermostat = \"bussi\"\n\
        [[stage]]\nname = \"p\"\nsteps = 100\nthermostat = \"bussi\"\n";
    Scene::parse(&format!("{stages}{tables}"), "test.toml", &[]).unwrap()
}

/// A short survey of a scene, with the frames of its one chain.
fn surveyed(text: &str) -> (Sample, Survey) {
    let scene = accurate(text);
    let sample = Sample::prepare(&scene).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let survey = pool.install(|| Survey::run(&sample, Duration::from_millis(100)));
    (sample, survey.unwrap())
}

/// What the run's own terms give for U, W and, by masses, ∇²U of each frame, over the values of the engine.
fn beside_the_engine(survey: &Survey) -> [f64; 3] {
    let sums = |of: &dyn Fn(&Frame) -> f64| survey.frames.iter().map(of).sum::<f64>();
    let leverage = |f: &Frame| {
        let counts = f.counts.leverage.as_ref().unwrap_or(&f.counts.pairs);
        dot(counts, &survey.run.virial)
    };
    [
        sums(&|f| dot(&f.counts.pairs, &survey.run.conserved)) / sums(&|f| f.potential),
        sums(&leverage) / sums(&|f| f.virial),
        sums(&|f| dot(&f.counts.pairs, &survey.run.laplacian))
            / sums(&|f| f.laplacian.unwrap_or(f64::NAN)),
    ]
}

#[test]
fn pairs_of_species_add_up_to_the_energy_the_virial_and_the_laplacian_of_the_engine() {
    let mixture = "[start]\nlattice = \"sc\"\n[system]\nn_atoms = 512\ndensity = 1.0\ntemperature = 2.0\n\
        [[species]]\nname = \"A\"\nfraction = 0.75\n\
        [[species]]\nname = \"B\"\nfraction = 0.25\nsigma = 0.88\nepsilon = 0.5\n\
        [mixing]\nrule = \"explicit\"\n[[pair]]\na = \"A\"\nb = \"B\"\nsigma = 0.8\nepsilon = 1.5\n\
        [truncation]\nr_cut_in = \"pair\"\n";
    let (sample, survey) = surveyed(mixture);
    // The stiffest pair bounds the step: σ_AB√(1/ε_AB) is the shortest time.
    assert_eq!(sample.fastest.unwrap().species, [0, 1]);
    let one = lennard_engine::watchdog::rough_stable_dt(2.0 / 1.5, 2.0);
    assert!((sample.stable_dt / (one * 0.8 / 1.5_f64.sqrt()) - 1.0).abs() < 1e-12);
    let [u, w, l] = beside_the_engine(&survey);
    // Bins of 0.02 σ, where the energy of close pairs changes by a third from edge to edge.
    assert!(
        (u - 1.0).abs() < 0.02 && (w - 1.0).abs() < 0.02 && (l - 1.0).abs() < 0.02,
        "{u} {w} {l}"
    );
    let beyond: Vec<f64> = (0..3).map(|kind| survey.g(kind, 2.9)).collect();
    assert!(beyond.iter().all(|g| (g - 1.0).abs() < 0.15), "{beyond:?}");
}

#[test]
fn masses_weigh_forces_and_laplacians() {
    let of_mass = |mass: f64| {
        surveyed(&format!(
            "[system]\nn_atoms = 500\ndensity = 0.7\ntemperature = 1.5\n[[species]]\nname = \"A\"\nfraction = 0.5\n\
             [[species]]\nname = \"B\"\nfraction = 0.5\nmass = {mass}\n[mixing]\nrule = \"geometric\"\n"
        ))
    };
    let (sample, survey) = of_mass(0.25);
    assert_eq!(sample.fastest.unwrap().species, [1, 1]);
    assert!(survey.frames.iter().all(|f| f.laplacian.is_none()));
    let mean = |series: &[f64]| statistics::mean(series);
    let laplacian = mean(&survey.laplacians());
    // Positions do not know masses: half of the particles count once, the others four times. By ⟨|F|²⟩ = T⟨∇²U⟩, particle by particle.
    let forces = mean(&survey.series(|f| f.squared_force));
    assert!((forces / (1.5 * laplacian) - 1.0).abs() < 0.1, "{forces} {laplacian}");
    let (_, light) = of_mass(1.0);
    let ratio = laplacian / mean(&light.laplacians());
    assert!((ratio - 2.5).abs() < 0.15, "{ratio}");
}

/// A fluid of dumbbells, up to the method of its bonds.
const DUMBBELLS: &str = "[system]\nn_molecules = 256\ndensity = 0.4\ntemperature = 2.0\n[molecule]\nbond_length = 0.67\n[bonds]\n";

#[test]
fn sites_of_molecules_add_up_to_the_molecular_virial() {
    let (sample, survey) = surveyed(&format!("{DUMBBELLS}method = \"direct\"\n"));
    assert!((survey.density() - 0.4).abs() < 1e-9);
    assert_eq!(sample.fluid.n_dof(), 5.0 * 256.0 - 3.0);
    let [u, _, l] = beside_the_engine(&survey);
    assert!((u - 1.0).abs() < 0.02 && (l - 1.0).abs() < 0.02, "{u} {l}");
    // Pushes and pulls nearly cancel in W: it is measured by 3NT, which P has beside it.
    let mean =
        |of: &dyn Fn(&Frame) -> f64| statistics::mean(&survey.series(of)) / (3.0 * 256.0 * 2.0);
    let engine = mean(&|f| f.virial);
    let found = mean(&|f| dot(f.counts.leverage.as_ref().unwrap(), &survey.run.virial));
    assert!((found - engine).abs() < 0.06, "{found} {engine}");
    // The virial of sites is another one: the arms of the sites count.
    let sites = mean(&|f| dot(&f.counts.pairs, &survey.run.virial));
    assert!((sites - engine).abs() > 0.5, "{sites} {engine}");
}

#[test]
fn springs_bound_the_step_where_they_are_faster_than_collisions() {
    let limit = |stiffness: f64| {
        let scene = accurate(&format!(
            "{DUMBBELLS}method = \"spring\"\nstiffness = {stiffness}\nscheme = \"explicit\"\n[integrator]\ndt = 0.001\n"
        ));
        crate::lab::stable_dt_of_springs(&scene, crate::tune::sample::VERLET_LIMIT).unwrap()
    };
    // ω² = 2k/m for two unit masses.
    assert!((limit(40_000.0) - 2.0 / 80_000.0_f64.sqrt()).abs() < 1e-12);
    assert!((limit(4.0) / limit(400.0) - 10.0).abs() < 1e-9);
}
