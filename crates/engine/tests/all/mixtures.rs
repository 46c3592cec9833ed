//! Mixtures: the bits of one species, mixed starts, equipartition, files, and what is refused.

use lennard_core::{DVec3, System};
use lennard_engine::{Simulation, StopAt, Unfollowed, evaluate_energy, prepare, start};
use lennard_io::{Frame, FrameStyle};
use lennard_scene::Scene;

use crate::common::{self, bits, ran};

/// A liquid.
const LIQUID: &str = r#"
    system = { n_atoms = 108, density = 0.9, temperature = 1.5, seed = 7 }
    integrator = { dt = 0.003 }
    stage = [{ name = "production", steps = 1000 }]
    output = { thermo_every = 10 }
"#;

/// Two species of unlike sizes, depths and masses.
const SPECIES: &str = r#"
    species = [
        { name = "A", fraction = 0.7 },
        { name = "B", fraction = 0.3, sigma = 0.9, epsilon = 0.6, mass = 4.0 },
    ]
    mixing = { rule = "lorentz-berthelot", k = -0.2 }
    truncation = { kind = "shift", r_cut = 2.2, r_cut_in = "pair" }
"#;

fn scene(overrides: &str) -> Scene {
    common::scene(&format!("{LIQUID}{SPECIES}"), overrides)
}

#[test]
fn species_alike_in_all_but_name_have_the_bits_of_one() {
    let two = r#"[{ name = "red", fraction = 0.4 }, { name = "blue", fraction = 0.6 }]"#;
    for kind in ["cut", "shift", "switch"] {
        let common = format!(
            r#"system.n_atoms=256 stage.0.steps=300 truncation={{ kind = "{kind}", r_cut = 2.5 }}"#
        );
        let with = |species| ran(scene(&format!("{common} species={species} mixing.k=0.0")));
        let (alone, both) = (with(r#"[{ name = "red" }]"#), with(two));
        let plain = ran(common::scene(LIQUID, &common));
        assert!(bits(&both) == bits(&plain), "{kind}");
        assert!(bits(&alone) == bits(&plain), "{kind}");
        assert_eq!(both.system.species().counts(), [102, 154]);
        let pressure = |s: &Simulation| s.pressure().map(f64::to_bits);
        assert_eq!(pressure(&both), pressure(&plain), "{kind}");
        assert!(pressure(&both).is_some());
    }
}

#[test]
fn species_are_mixed_at_random_by_the_seed() {
    let species = |seed: &str| {
        let scene = scene(&format!("system.n_atoms=864 system.seed={seed}"));
        start(&scene).unwrap_or_else(|e| panic!("{e}")).species
    };
    let (one, other) = (species("1"), species("2"));
    assert_eq!(one.counts(), [605, 259]);
    assert_eq!(one, species("1"));
    assert_ne!(one, other);
    // A layered start has all of B in a few layers; each of twelve layers of 72 has about 22 here.
    for layer in 0..12 {
        let b = (72 * layer..72 * (layer + 1)).filter(|i| one.of(*i) == 1).count();
        assert!((10..=34).contains(&b), "layer {layer}: {b}");
    }
}

#[test]
fn a_lattice_too_dense_for_the_larger_species_is_relaxed() {
    let dense = "species.B.sigma=1.6 system.density=0.7 system.n_atoms=256";
    assert!(start(&scene(dense)).unwrap_or_else(|e| panic!("{e}")).relax);
    let simulation = ran(scene(&format!("{dense} stage.0.steps=50")));
    assert!(simulation.state.positions.iter().all(|r| r.is_finite()));
    assert!(!start(&scene("")).unwrap_or_else(|e| panic!("{e}")).relax);
}

/// 2K_a/(3N_a) of each species.
fn temperatures(system: &System, velocities: &[DVec3]) -> Vec<f64> {
    let species = system.species();
    (0..species.n_species())
        .map(|a| {
            let sum: f64 = species
                .particles(a)
                .map(|i| system.masses.of(i) * velocities[i].length_squared())
                .sum();
            sum / (3.0 * species.count(a) as f64)
        })
        .collect()
}

/// Every bath that holds a temperature, and every barostat with its bath, gives unequal masses the same temperature.
#[test]
fn baths_and_barostats_give_each_species_the_temperature_of_the_bath() {
    let tail = r#"{ kind = "cut", r_cut = 2.2 }"#;
    let canonical = lennard_integrators::thermostats().iter().filter(|t| t.canonical);
    let mut baths: Vec<(String, String)> =
        canonical.map(|t| (format!("{:?}", t.name), "\"none\"".to_owned())).collect();
    for barostat in lennard_integrators::barostats() {
        let bath = barostat.thermostat.unwrap_or("bussi");
        let barostat = format!("{{ kind = {:?}, pressure = 2.0 }}", barostat.name);
        baths.push((format!("{bath:?}"), barostat));
    }
    assert!(baths.len() >= 5);
    for (bath, barostat) in &baths {
        let mut simulation = prepare(scene(&format!(
            "system.n_atoms=108 system.density=0.8
            truncation={tail} stage.0.steps=10000 stage.0.thermostat={bath}
            stage.0.barostat={barostat}"
        )))
        .unwrap_or_else(|e| panic!("{bath}: {e}"));
        let mut series: [Vec<f64>; 2] = Default::default();
        for step in 1..=100 {
            simulation
                .follow(&mut StopAt::new(100 * step))
                .unwrap_or_else(|e| panic!("{bath}, {barostat}: {e}"));
            let t = temperatures(&simulation.system, &simulation.state.velocities);
            series[0].push(t[0]);
            series[1].push(t[1]);
        }
        for (a, t) in series.iter().enumerate() {
            let t = &t[20..];
            let mean = t.iter().sum::<f64>() / t.len() as f64;
            // 80 samples of a species of 32 particles: σ_T = T·√(2/96)/√80 = 0.024, and some correlation. The step of 0.003
            // makes whole steps colder by up to a per cent.
            assert!((mean - 1.5).abs() < 0.12, "{bath}, {barostat}: species {a} at {mean}");
        }
    }
}

/// The energy that barostats conserve has the work of the tail of all pairs of species in it.
#[test]
fn barostats_conserve_energy_with_the_tails_of_all_pairs() {
    for barostat in lennard_integrators::barostats() {
        let bath = format!("{:?}", barostat.thermostat.unwrap_or("bussi"));
        let words = format!("{{ kind = {:?}, pressure = 2.0 }}", barostat.name);
        let simulation = ran(scene(&format!(
            r#"system.n_atoms=256
            truncation={{ kind = "cut", r_cut = 2.2 }} stage.0.steps=1000
            stage.0.thermostat={bath} stage.0.barostat={words}"#
        )));
        assert!(simulation.stage_run().tail_work < 0.0, "{words}");
        let rms = simulation.thermodynamics().conservation().energy_rms_per_atom;
        assert!(rms < 2e-3, "{words}: {rms}");
    }
}

#[test]
fn walls_that_are_hit_or_are_springs_take_particles_of_all_species() {
    let between = |wall: &str, steps: &str| {
        ran(scene(&format!(
            "system.n_atoms=108 system.density=0.4 wall={wall}
            stage.0.steps={steps}"
        )))
    };
    for wall in [
        r#"[{ kind = "hard" }]"#,
        r#"[{ kind = "soft", stiffness = 500.0 }]"#,
        r#"[{ kind = "hard", restitution = 0.9 }]"#,
    ] {
        let simulation = between(wall, "2000");
        let kept = simulation.thermodynamics().conservation();
        assert!(kept.energy_rms_per_atom < 1e-3, "{wall}: {kept:?}");
    }
    // A wall at a temperature gives heavy and light particles this one.
    let mut simulation = common::prepared(scene(
        r#"system.n_atoms=108 system.density=0.4
        wall=[{ kind = "thermal", temperature = 3.0 }] stage.0.steps=40000"#,
    ));
    let mut means = [0.0; 2];
    for sample in 1..=40 {
        simulation
            .follow(&mut StopAt::new(20_000 + 500 * sample))
            .unwrap_or_else(|e| panic!("{e}"));
        let t = temperatures(&simulation.system, &simulation.state.velocities);
        means[0] += t[0] / 40.0;
        means[1] += t[1] / 40.0;
    }
    // 40 samples of 32 particles: σ_T = T·√(2/96)/√40 = 0.07.
    assert!(means.iter().all(|t| (t - 3.0).abs() < 0.3), "{means:?}");
}

/// RESPA with one split for all pairs of species, below each of their cutoffs.
const SPLIT: &str = r#"stage.0.steps=800
    integrator={ kind = "respa", dt = 0.006, inner_steps = 3, r_split = 1.8, split_width = 0.3 }"#;

#[test]
fn respa_conserves_the_energy_of_a_mixture() {
    let simulation = ran(scene(SPLIT));
    let kept = simulation.thermodynamics().conservation();
    assert!(kept.energy_rms_per_atom < 2e-3, "{kept:?}");
}

#[test]
fn a_file_of_a_mixture_gives_the_same_energy_and_the_same_species() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("start.xyz");
    let simulation = ran(scene("stage.0.steps=20"));
    let style =
        FrameStyle { species: simulation.system.species().clone(), ..FrameStyle::default() };
    let frame = Frame { state: &simulation.state, extra: &[] };
    lennard_io::write_frame(&path, &style, &frame).unwrap();
    let start = format!("start = {{ kind = \"file\", file = {path:?} }}\n");
    let text = format!("{start}{LIQUID}{SPECIES}").replace("n_atoms = 108, density = 0.9, ", "");
    let system = text.replace(", fraction = 0.7", "").replace(", fraction = 0.3", "");
    let evaluated = evaluate_energy(&common::scene(&system, "")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(&evaluated.species, simulation.system.species());
    let there = simulation.state.energetics.potential_energy.unwrap();
    assert!((evaluated.report.potential_energy / there - 1.0).abs() < 1e-12);
    // A name in the file that no species has.
    let text = std::fs::read_to_string(&path).unwrap().replace("\nB ", "\nXe ");
    std::fs::write(&path, text).unwrap();
    let refused = common::refused(evaluate_energy(&common::scene(&system, "")));
    common::contains(&refused, &["`start.file`", "\"Xe\""]);
}

/// Forces are checked against all pairs with the species of each particle: a swapped species is seen.
#[test]
fn the_check_of_forces_knows_the_species() {
    let simulation = ran(scene(""));
    let seen = simulation.force_check.seen();
    assert!(seen.forces >= 10 && seen.largest_deviation <= 1.0, "{seen:?}");
    let mut other = common::prepared(scene("system.seed=8"));
    // The check takes the species of the system, and the forces have the species of another seed.
    other.system = simulation.system;
    assert!(other.follow(&mut Unfollowed).is_err());
}
