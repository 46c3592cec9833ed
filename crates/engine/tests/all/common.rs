//! Scenes of the tests, and runs of them.

use lennard_engine::{Simulation, Unfollowed, prepare};
use lennard_scene::{Scene, SceneError};

/// The scene that a text and overrides make.
pub(crate) fn parse(text: &str, overrides: &[(&str, &str)]) -> Result<Scene, SceneError> {
    let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let overrides: Vec<_> = overrides.iter().map(owned).collect();
    Scene::parse(text, "scene.toml", &overrides)
}

/// As [`parse`], for a scene that is one.
pub(crate) fn scene(text: &str, overrides: &[(&str, &str)]) -> Scene {
    parse(text, overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// The simulation of a scene before its first step.
pub(crate) fn prepared(scene: Scene) -> Simulation {
    prepare(scene).unwrap_or_else(|e| panic!("{e}"))
}

/// The simulation of a scene after its last step.
pub(crate) fn ran(scene: Scene) -> Simulation {
    let mut simulation = prepared(scene);
    simulation
        .run(&mut Unfollowed)
        .unwrap_or_else(|e| panic!("{e}"));
    simulation
}

/// Positions, velocities and forces as bits.
pub(crate) fn bits(simulation: &Simulation) -> Vec<[u64; 3]> {
    let s = &simulation.state;
    let all = s.positions.iter().chain(&s.velocities).chain(&s.forces);
    all.map(|v| v.to_array().map(f64::to_bits)).collect()
}

/// Does work on a pool with so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}
