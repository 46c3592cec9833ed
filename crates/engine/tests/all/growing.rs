//! Scenes that grow while they are run, runs in memory, and simulations that are saved by themselves.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, PeriodicBox};
use lennard_engine::{
    Ending, Measurement, MemoryOptions, OwnParts, Recording, Simulation, prepare, prepare_with,
    restored, run_in_memory, snapshot,
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
    common::scene(text, &[])
}

fn run(simulation: &mut Simulation, recording: &mut Recording, until: Option<u64>) -> Ending {
    let options = MemoryOptions { until, stop: &AtomicBool::new(false), progress: &mut () };
    run_in_memory(simulation, recording, options).unwrap_or_else(|e| panic!("{e}"))
}

/// The scene of a simulation as text, with another stage at its end.
fn grown(simulation: &Simulation, stage: &str) -> Scene {
    let text = simulation.scene_to_grow().resolved_toml();
    scene(&(text.replace("measure = true", "measure = false") + "\n" + stage))
}

#[test]
fn a_scene_that_grew_has_the_bits_and_means_of_one_that_was_whole() {
    let whole_text = format!("{SYSTEM}{MELT}{MEASURE}");
    let first = whole_text.replace(MEASURE, "").replace("measure = false\n", "");
    let mut simulation = prepare(scene(&first)).unwrap_or_else(|e| panic!("{e}"));
    let mut recording = Recording::default();
    run(&mut simulation, &mut recording, Some(33));
    assert_eq!(simulation.state.step, 33);
    run(&mut simulation, &mut recording, None);
    let longer = grown(&simulation, MEASURE);
    simulation.grow(longer.clone(), Measurement::Anew).unwrap_or_else(|e| panic!("{e}"));
    let mut recording = Recording::default();
    run(&mut simulation, &mut recording, None);

    let mut whole = prepare(longer).unwrap_or_else(|e| panic!("{e}"));
    let mut of_whole = Recording::default();
    run(&mut whole, &mut of_whole, None);
    assert_eq!(simulation.state.positions, whole.state.positions);
    assert_eq!(simulation.state.velocities, whole.state.velocities);
    let (record, _) = recording.results(&simulation, 1);
    let (expected, _) = of_whole.results(&whole, 1);
    // As text, since a mean that is too short has an error that is no number.
    let (found, wanted) = (record.averages, expected.averages);
    assert_eq!(format!("{found:?}"), format!("{wanted:?}"));
    // The rows of the measured stage alone, and of all.
    assert_eq!(recording.thermo[0].len(), 16);
    assert_eq!(of_whole.thermo[0].len(), 28);
}

#[test]
fn a_look_at_the_moment_changes_no_bit() {
    let text = format!("{SYSTEM}{MEASURE}");
    let mut looked_at = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    let mut left_alone = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    for until in [0, 7, 23, 80] {
        if until > 0 {
            run(&mut looked_at, &mut Recording::default(), Some(until));
            run(&mut left_alone, &mut Recording::default(), Some(until));
        }
        let moment = looked_at.moment().unwrap_or_else(|e| panic!("{e}"));
        assert!(moment.pressure.is_finite() && moment.potential_energy < -3.0);
        assert_eq!(looked_at.state, left_alone.state, "step {until}");
    }
}

#[test]
fn what_is_no_growth_is_refused() {
    let text = format!("{SYSTEM}{MELT}{MEASURE}");
    let mut simulation = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    run(&mut simulation, &mut Recording::default(), Some(90));
    let refused = |simulation: &mut Simulation, change: &dyn Fn(&mut Scene)| {
        let mut other = simulation.scene_to_grow();
        change(&mut other);
        let error = simulation.grow(other, Measurement::GoesOn).unwrap_err();
        error.to_string()
    };
    let message = refused(&mut simulation, &|s| s.system.seed += 1);
    assert!(message.contains("another scene"), "{message}");
    assert!(
        message.contains("the scene of the simulation; stages, observables and output may change")
    );
    let message = refused(&mut simulation, &|s| s.stages.truncate(1));
    assert!(message.contains("all stages that have begun"), "{message}");
    let message = refused(&mut simulation, &|s| s.stages[1].steps = 29);
    assert!(message.contains("another stage `measure`"), "{message}");
    assert!(message.contains("stage `measure` as it was run, 30 steps or more"));
    let message = refused(&mut simulation, &|s| s.stages[0].steps += 1);
    assert!(message.contains("stage `melt` as it was run, 60 steps or more"));
    // What a stage still has to do may change.
    let mut shorter = simulation.scene_to_grow();
    shorter.stages[1].steps = 30;
    assert!(simulation.grow(shorter, Measurement::GoesOn).is_ok());
}

#[test]
fn a_simulation_is_saved_by_itself_before_its_first_step_and_after_some() {
    let text = format!("{SYSTEM}{MELT}{MEASURE}");
    let mut simulation = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
    for until in [0, 41, 97] {
        if until > 0 {
            run(&mut simulation, &mut Recording::default(), Some(until));
        }
        let saved = snapshot(&simulation);
        let mut other = restored(&saved, Path::new("memory")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(other.state.positions, simulation.state.positions);
        run(&mut other, &mut Recording::default(), None);
        let mut undisturbed = prepare(scene(&text)).unwrap_or_else(|e| panic!("{e}"));
        run(&mut undisturbed, &mut Recording::default(), None);
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
    assert!(message.contains("positions beside a start that the scene makes"), "{message}");
    assert!(message.contains("allowed: \"file\""), "{message}");
    let text = format!(
        "[start]\nkind = \"file\"\nfile = \"start.xyz\"\n[system]\ntemperature = 1.0\n[truncation]\nr_cut = 2.5\n{MEASURE}"
    );
    let simulation =
        prepare_with(scene(&text), Some(start), OwnParts::none()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(simulation.state.positions[1], DVec3::splat(3.0));
}
