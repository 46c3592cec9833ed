//! Scenes of the tests, and runs of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use lennard_engine::{Progress, Simulation, Unfollowed, prepare};
use lennard_observables::{Average, Findings};
use lennard_scene::{Scene, SceneError};
use tempfile::TempDir;

/// A dense fluid of dumbbells, the force shifted to zero at the cutoff.
pub(crate) const DUMBBELLS: &str = r#"
    system = { n_molecules = 108, density = 0.4, temperature = 2.0, seed = 5 }
    molecule = { bond_length = 0.67 }
    truncation = { kind = "force-shift", r_cut = 2.5 }
    integrator = { dt = 0.002 }
    stage = [{ name = "production", steps = 100 }]
    output = { thermo_every = 10 }
    observable = [{ kind = "molecules" }, { kind = "rdf", every = 10 }]
"#;

/// Keys of a scene with other values, as a command line says them: `key=value`, with blanks between.
pub(crate) fn pairs(overrides: &str) -> Vec<(String, String)> {
    let line = overrides.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut depth = 0;
    let ends = |c: char| {
        depth += i32::from("[{".contains(c)) - i32::from("]}".contains(c));
        depth == 0 && c.is_whitespace()
    };
    let words = line.split(ends).filter(|word| !word.is_empty());
    let owned = |(key, value): (&str, &str)| (key.to_owned(), value.to_owned());
    words.map(|word| owned(word.split_once('=').expect(word))).collect()
}

/// The scene that a text and overrides make.
pub(crate) fn parse(text: &str, overrides: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, "scene.toml", &pairs(overrides))
}

/// As [`parse`], for a scene that is one.
pub(crate) fn scene(text: &str, overrides: &str) -> Scene {
    parse(text, overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// The simulation of a scene before its first step.
pub(crate) fn prepared(scene: Scene) -> Simulation {
    prepare(scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Takes a simulation to its last step.
pub(crate) fn follow(simulation: &mut Simulation) {
    simulation.follow(&mut Unfollowed).unwrap_or_else(|e| panic!("{e}"));
}

/// The simulation of a scene after its last step.
pub(crate) fn ran(scene: Scene) -> Simulation {
    let mut simulation = prepared(scene);
    follow(&mut simulation);
    simulation
}

/// A mean of a run by its name.
pub(crate) fn average<'a>(findings: &'a [Findings], name: &str) -> Option<&'a Average> {
    findings.iter().flat_map(|found| &found.averages).find(|average| average.name == name)
}

/// Wants these words in a message.
#[track_caller]
pub(crate) fn contains(message: &str, words: &[&str]) {
    for part in words {
        assert!(message.contains(part), "wanted `{part}` in\n{message}");
    }
}

/// The message of what does not succeed.
#[track_caller]
pub(crate) fn refused<T, E: std::fmt::Display>(result: Result<T, E>) -> String {
    result.err().expect("refused").to_string()
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

/// Asks to stop once a step is done; several may be taken in one go.
pub(crate) struct AskToStop<'a>(pub(crate) u64, pub(crate) &'a AtomicBool);

impl Progress for AskToStop<'_> {
    fn update(&mut self, _stage: &str, done: u64, _total: u64) {
        if self.0 > 0 && done >= self.0 {
            self.1.store(true, Ordering::Relaxed);
        }
    }
}

/// A new folder, in memory where the system has a place for it: hundreds of short runs need not wait for a disk.
pub(crate) fn folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

/// Files by name.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// All files of a run, without what a clock has measured.
pub(crate) fn contents(folder: &Path) -> Files {
    let entry = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        let path = entry.path();
        if name.ends_with(".lennard") {
            let mut checkpoint = lennard_io::read_checkpoint(&path).unwrap();
            checkpoint.archive.arrays.retain(|name, _| !name.ends_with("seconds"));
            return (name, lennard_io::checkpoint_bytes(&checkpoint));
        }
        let mut bytes = fs::read(path).unwrap();
        if name == "run.json" {
            let mut record: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            for key in ["wall_s", "performance", "host"] {
                record.as_object_mut().unwrap().remove(key).unwrap();
            }
            bytes = record.to_string().into_bytes();
        }
        (name, bytes)
    };
    fs::read_dir(folder).unwrap().map(|e| entry(e.unwrap())).collect()
}

/// Wants the same files with the same bytes.
pub(crate) fn same_files(expected: &Files, found: &Files, what: &str) {
    let names = |files: &Files| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(expected), names(found), "{what}");
    for (name, bytes) in expected {
        assert!(*bytes == found[name], "{what}: {name} differs");
    }
}

/// A rigid triangle, as overrides.
pub(crate) const TRIANGLE: &str = "molecule.kind=sites molecule.sites=3 molecule.bond_length=0.7
    molecule.bonds=[[1, 2], [2, 3], [3, 1]] system.density=0.1 integrator.kind=velocity-verlet
    molecule.shape=[[0, 0, 0], [0.7, 0, 0], [0.35, 0.6062177826, 0]] bonds.method=direct";

/// The deterministic barostat.
pub(crate) const MTK: &str = "{ kind = \"mtk\", pressure = 1.0, tau = 0.5 }";
