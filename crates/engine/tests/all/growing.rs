//! Scenes that grow while they are run, runs in memory, and simulations that are saved by themselves.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, PeriodicBox};
use lennard_engine::{
    Addition, Control, Ending, OwnParts, Simulation, prepare, prepare_with, restored, snapshot,
};
use lennard_io::StartConfiguration;
use lennard_scene::Scene;

use crate::common;

const SYSTEM: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.1\nseed = 5\n\
                      [truncation]\nr_cut = 2.2\n[output]\nthermo_every = 5\n";
const MELT: &str =
    "[[stage]]\nname = \"melt\"\nsteps = 60\nthermostat = \"bussi\"\nmeasure = false\n";
const MEASURE: &str = "[[stage]]\nname = \"measure\"\nsteps = 80\n";

fn scene(text: &str) -> Scene {
    common::scene(text, "")
}

fn run(simulation: &mut Simulation, until: Option<u64>) -> Ending {
    let control = Control { stop: &AtomicBool::new(false), deadline: None, progress: &mut () };
    let until = until.unwrap_or(u64::MAX);
    simulation.run_until(until, control).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_scene_that_grew_has_the_bits_and_means_of_one_that_was_whole() {
    let whole_text = format!("{SYSTEM}{MELT}{MEASURE}");
    let first = whole_text.replace(MEASURE, "").replace("measure = false\n", "");
    let mut simulation = prepare(scene(&first)).unwrap_or_else(|e| panic!("{e}"));
    run(&mut simulation, Some(33));
    assert_eq!(simulation.state.step, 33);
    run(&mut simulation, None);
    let stage = MEASURE.replace("[[stage]]", "");
    let addition = Addition { stage: &stage, observables: None, output: None };
    simulation.add(&addition).unwrap_or_else(|e| panic!("{e}"));
    run(&mut simulation, None);

    let mut whole = prepare(simulation.scene.clone()).unwrap_or_else(|e| panic!("{e}"));
    run(&mut whole, None);
    assert_eq!(simulation.state.positions, whole.state.positions);
    assert_eq!(simulation.state.velocities, whole.state.velocities);
    // As text, since a mean that is too short has an error that is no number.
    let averages = |of: &Simulation| format!("{:?}", of.results().record.averages);
    assert_eq!(averages(&simulation), averages(&whole));
    // The rows of the measured stage alone, and of all.
    assert_eq!(simulation.recording.thermo[0].len(), 16);
    assert_eq!(whole.recording.thermo[0].len(), 28);
}

#[test]
fn a_scene_without_a_stage_grows_to_the_bits_of_one_that_was_planned() {
    let addition = |stage: &'static str| Addition { stage, observables: None, output: None };
    let scene = Scene::parse_to_grow(SYSTEM, "scene.toml", &[]).unwrap_or_else(|e| panic!("{e}"));
    let mut grown = prepare(scene).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(run(&mut grown, None), Ending::Finished);
    assert_eq!(grown.state.step, 0);
    grown.add(&addition("name = \"a\"\nsteps = 30\nmeasure = false")).unwrap();
    run(&mut grown, None);
    assert!(grown.scene.stages.iter().all(|stage| !stage.measure));
    let saved = snapshot(&grown);
    let mut again =
        restored(&saved, Path::new("memory"), &OwnParts::none()).unwrap_or_else(|e| panic!("{e}"));
    for simulation in [&mut grown, &mut again] {
        simulation.add(&addition("name = \"b\"\nsteps = 50")).unwrap();
        run(simulation, None);
    }
    let mut planned = prepare(grown.scene.clone()).unwrap_or_else(|e| panic!("{e}"));
    run(&mut planned, None);
    assert_eq!(grown.state.positions, planned.state.positions);
    assert_eq!(grown.state.positions, again.state.positions);
    let refused = Scene::parse(SYSTEM, "scene.toml", &[]).expect_err("a run has stages");
    assert!(refused.to_string().contains("no stage"), "{refused}");
}

#[test]
fn a_look_at_the_moment_changes_no_bit() {
    let text = format!("{SYSTEM}{MEASURE}");
    let mut looked_at = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    let mut left_alone = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    for until in [0, 7, 23, 80] {
        if until > 0 {
            run(&mut looked_at, Some(until));
            run(&mut left_alone, Some(until));
        }
        let moment = looked_at.moment().unwrap_or_else(|e| panic!("{e}"));
        assert!(moment.pressure.is_finite() && moment.potential_energy < -3.0);
        assert_eq!(looked_at.state, left_alone.state, "step {until}");
    }
}

#[test]
fn a_simulation_is_saved_by_itself_before_its_first_step_and_after_some() {
    let text = format!("{SYSTEM}{MELT}{MEASURE}");
    let mut simulation = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    for until in [0, 41, 97] {
        if until > 0 {
            run(&mut simulation, Some(until));
        }
        let saved = snapshot(&simulation);
        let mut other = restored(&saved, Path::new("memory"), &OwnParts::none())
            .unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(other.state.positions, simulation.state.positions);
        run(&mut other, None);
        let mut undisturbed = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
        run(&mut undisturbed, None);
        assert_eq!(other.state.positions, undisturbed.state.positions, "from step {until}");
    }
}

#[test]
fn a_start_from_memory_needs_a_scene_that_names_a_configuration() {
    let start = StartConfiguration {
        cell: PeriodicBox::new(DVec3::splat(8.0)).unwrap(),
        positions: vec![DVec3::ZERO, DVec3::splat(3.0)],
        velocities: None,
        momenta: None,
        species: lennard_io::FoundSpecies::default(),
        step: None,
        time: None,
        frames: 1,
    };
    let lattice = scene(&format!("{SYSTEM}{MEASURE}"));
    let error =
        prepare_with(lattice, Some(start.clone()), OwnParts::none()).err().map(|e| e.to_string());
    let message = error.unwrap_or_default();
    assert!(message.contains("positions beside a start that the scene has"), "{message}");
    assert!(message.contains("allowed: \"file\""), "{message}");
    let text = format!(
        "[start]\nkind = \"file\"\nfile = \"start.xyz\"\n[system]\ntemperature = 1.0\n[truncation]\nr_cut = 2.5\n{MEASURE}"
    );
    let simulation =
        prepare_with(scene(&text), Some(start), OwnParts::none()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(simulation.state.positions[1], DVec3::splat(3.0));
}
