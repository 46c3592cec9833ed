//! Scenes that grow while they are run, and runs in memory. The library tests both of a whole run.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, PeriodicBox};
use lennard_engine::{
    Addition, Control, Ending, OwnParts, Simulation, prepare_with, restored, snapshot,
};
use lennard_io::StartConfiguration;
use lennard_scene::Scene;

use crate::common;

const SYSTEM: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.1\nseed = 5\n\
                      [truncation]\nr_cut = 2.2\n[output]\nthermo_every = 5\n";
const MEASURE: &str = "[[stage]]\nname = \"measure\"\nsteps = 80\n";

fn scene(text: &str) -> Scene {
    common::scene(text, "")
}

fn run(simulation: &mut Simulation) -> Ending {
    let control = Control { stop: &AtomicBool::new(false), deadline: None, progress: &mut () };
    simulation.run_until(u64::MAX, control).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_scene_without_a_stage_grows_to_the_bits_of_one_that_was_planned() {
    let addition = |stage: &'static str| Addition { stage, observables: None, output: None };
    let scene = Scene::parse_to_grow(SYSTEM, "scene.toml", &[]).unwrap_or_else(|e| panic!("{e}"));
    let mut grown = common::prepared(scene);
    assert_eq!(run(&mut grown), Ending::Finished);
    assert_eq!(grown.state.step, 0);
    grown.add(&addition("name = \"a\"\nsteps = 30\nmeasure = false")).unwrap();
    run(&mut grown);
    assert!(grown.scene.stages.iter().all(|stage| !stage.measure));
    let saved = snapshot(&grown);
    let mut again =
        restored(&saved, Path::new("memory"), &OwnParts::none()).unwrap_or_else(|e| panic!("{e}"));
    for simulation in [&mut grown, &mut again] {
        simulation.add(&addition("name = \"b\"\nsteps = 50")).unwrap();
        run(simulation);
    }
    let mut planned = common::prepared(grown.scene.clone());
    run(&mut planned);
    assert_eq!(grown.state.positions, planned.state.positions);
    assert_eq!(grown.state.positions, again.state.positions);
    common::contains(&common::refused(common::parse(SYSTEM, "")), &["no stage"]);
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
    let refused = common::refused(prepare_with(lattice, Some(start.clone()), OwnParts::none()));
    let words = ["positions beside a start that the scene has", "allowed: \"file\""];
    common::contains(&refused, &words);
    let text = format!(
        "[start]\nkind = \"file\"\nfile = \"start.xyz\"\n[system]\ntemperature = 1.0\n[truncation]\nr_cut = 2.5\n{MEASURE}"
    );
    let simulation =
        prepare_with(scene(&text), Some(start), OwnParts::none()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(simulation.state.positions[1], DVec3::splat(3.0));
}
