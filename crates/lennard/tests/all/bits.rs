//! The library and the command line compute the same bits, whatever pieces a run is put together from.

use std::fs;
use std::path::Path;

use lennard::prelude::*;

/// Keys of a small liquid with their values.
const KEYS: [&str; 6] = [
    "system.n_atoms=108",
    "truncation.r_cut=2.2",
    "stage.melt.steps=40",
    "stage.equilibrate.steps=60",
    "stage.production.steps=200",
    "output.trajectory_every=50",
];

fn liquid() -> SceneBuilder {
    KEYS.iter().fold(SceneBuilder::open("verlet-1967/liquid"), |builder, pair| {
        let (key, value) = pair.split_once('=').unwrap();
        match value.parse::<i64>() {
            Ok(whole) => builder.set(key, whole),
            Err(_) => builder.set(key, value.parse::<f64>().unwrap()),
        }
    })
}

fn prepared(builder: &SceneBuilder) -> Simulation {
    Simulation::new(builder.build().unwrap()).unwrap()
}

fn averages(simulation: &Simulation) -> serde_json::Value {
    serde_json::to_value(&simulation.results().record.averages).unwrap()
}

/// A file of two runs, which must be the same.
fn same_file(one: &Path, other: &Path, name: &str) {
    let read = |folder: &Path| fs::read(folder.join(name)).unwrap();
    assert!(read(one) == read(other), "{name} differs");
}

#[test]
fn memory_a_folder_and_the_command_line_have_the_same_bits() {
    let temporary = tempfile::tempdir().unwrap();
    let [by_hand, by_us] = ["command", "library"].map(|name| temporary.path().join(name));
    let folder = by_hand.to_str().unwrap();
    let mut arguments = vec!["lennard", "run", "verlet-1967/liquid", "--quiet", "--out", folder];
    arguments.extend(KEYS.iter().flat_map(|key| ["--set", key]));
    assert_eq!(lennard::program::main(arguments.into_iter().map(Into::into)), 0);
    let record = prepared(&liquid()).run_in_folder(&by_us).unwrap();
    for name in ["scene.toml", "thermo.csv", "trajectory.xyz", "final.xyz", "rdf.csv"] {
        same_file(&by_hand, &by_us, name);
    }
    let mut in_memory = prepared(&liquid()).on_threads(2).unwrap();
    in_memory.run().unwrap();
    assert_eq!(averages(&in_memory), serde_json::to_value(&record.averages).unwrap());
    assert_eq!(in_memory.recording.frames.len(), 4);
    assert_eq!(in_memory.recording.frames[3].positions, in_memory.state.positions);
    assert_eq!(in_memory.thermo().numbers("step").unwrap().last(), Some(&300.0));
}

#[test]
fn steps_in_pieces_and_a_saved_simulation_have_the_bits_of_one_run() {
    let temporary = tempfile::tempdir().unwrap();
    let mut whole = prepared(&liquid());
    whole.run().unwrap();
    let mut pieces = prepared(&liquid().set("stage.production.steps", 100));
    pieces.step(150).unwrap();
    pieces.moment().unwrap();
    let file = temporary.path().join("state.lennard");
    pieces.save(&file).unwrap();
    let mut loaded = Simulation::load(&file).unwrap();
    for simulation in [&mut pieces, &mut loaded] {
        simulation.step(150).unwrap();
        assert_eq!(simulation.state, whole.state);
        assert_eq!(averages(simulation), averages(&whole));
    }
}

#[test]
fn a_stage_that_is_added_is_measured_by_itself_and_stands_in_the_scene() {
    let mut liquid = prepared(&liquid());
    liquid.run().unwrap();
    let hot = toml! { name = "hot" steps = 50 temperature = 2.0 thermostat = "bussi" };
    liquid.add_stage(hot).unwrap();
    liquid.run().unwrap();
    assert_eq!(liquid.state.step, 350);
    assert_eq!(liquid.thermo().numbers("step").unwrap().first(), Some(&310.0));
    let again = SceneBuilder::from_toml(liquid.scene.resolved_toml());
    let mut again = prepared(&again);
    again.run().unwrap();
    assert_eq!(again.state, liquid.state);
    assert_eq!(averages(&again), averages(&liquid));
}

#[test]
fn arrays_start_where_another_simulation_is() {
    let mut first = prepared(&liquid());
    first.step(50).unwrap();
    let state = first.state.clone();
    let scene = liquid_from("start.xyz").build().unwrap();
    let started = |velocities| {
        let (sides, positions) = (state.cell.lengths(), state.positions.clone());
        Simulation::from_arrays(scene.clone(), sides, positions, velocities, OwnParts::none())
    };
    let mut second = started(Some(state.velocities.clone())).unwrap();
    let [one, other] = [&mut first, &mut second].map(|s| s.moment().unwrap());
    assert!((one.potential_energy - other.potential_energy).abs() < 1e-12);
    second.run().unwrap();
    assert_eq!(second.state.step, 30);
    let short = started(Some(vec![])).err().expect("refused").to_string();
    assert_eq!(short, "one velocity for each position is wanted");
    let hot = vec![lennard::DVec3::NAN; state.len()];
    let hot = started(Some(hot)).err().expect("refused").to_string();
    assert_eq!(hot, "a position or velocity is not a finite number from -1e9 to 1e9");
}

/// The same liquid from a file that is not there: arrays stand for it.
fn liquid_from(file: &str) -> SceneBuilder {
    SceneBuilder::new()
        .set("start.kind", "file")
        .set("start.file", file)
        .set("system.temperature", 0.722)
        .set("truncation.r_cut", 2.2)
        .stages([toml! { name = "production" steps = 30 }])
}
