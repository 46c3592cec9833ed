//! The readers, each with what must hold for any bytes.

use std::fmt::Display;
use std::io::Write;
use std::sync::LazyLock;

use lennard_core::Array;
use lennard_forcefield::Model;
use lennard_io::{FileUnits, FormatError, Frames, read_checkpoint_bytes, read_configuration_bytes};
use lennard_scene::Scene;
use tempfile::TempDir;

use crate::restart::{reshape, restart};

/// An error longer than this (bytes) has taken over what it was given.
const LONGEST_MESSAGE: usize = 4000;

/// Changes bytes, with random whole numbers below what it asks for.
pub type Reshape = fn(&mut Vec<u8>, &mut dyn FnMut(usize) -> usize);

/// A reader with its corpus.
pub struct Target {
    /// The name of the target and of its folder in `fuzz/corpus`.
    pub name: &'static str,
    /// Takes any bytes; says whether they were accepted; panics where something is wrong.
    pub body: fn(&[u8]) -> bool,
    /// Makes mutated bytes worth reading on: without a right checksum nothing behind it would ever be reached.
    pub repair: Option<fn(&mut [u8])>,
    /// Changes that bytes alone would hardly ever make, on what the format means; half of the inputs get some.
    pub reshape: Option<Reshape>,
    /// The list of `words.toml` whose words mean something in this format.
    pub words: &'static str,
}

/// A reader whose mutated bytes are read as they are.
const fn plain(name: &'static str, body: fn(&[u8]) -> bool, words: &'static str) -> Target {
    Target { name, body, repair: None, reshape: None, words }
}

/// A reader of checkpoints, whose mutated bytes get a right checksum.
const fn sealed(name: &'static str, body: fn(&[u8]) -> bool, reshape: Option<Reshape>) -> Target {
    Target { repair: Some(seal), reshape, ..plain(name, body, "checkpoint") }
}

/// Every reader.
pub const TARGETS: &[Target] = &[
    plain("scene", scene, "scene"),
    plain("extended-xyz", start, "xyz"),
    plain("frames", frames, "xyz"),
    plain("nist", start, "xyz"),
    plain("lammps-dump", start, "lammps"),
    plain("lammps-data", start, "lammps"),
    plain("gro", start, "lammps"),
    plain("gzip", gzip, "xyz"),
    plain("table", table, "table"),
    sealed("checkpoint", checkpoint, None),
    sealed("restart", restart, Some(reshape)),
];

/// Gives bytes to the reader of this name.
///
/// # Panics
/// Where something is wrong, or no reader has the name.
pub fn read(name: &str, bytes: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("a reader of this name").body)(bytes)
}

/// Looks at what was accepted, and otherwise at the length of the error.
pub(crate) fn judged<T, E: Display>(read: Result<T, E>, look: impl FnOnce(T)) -> bool {
    match read {
        Ok(found) => {
            look(found);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < LONGEST_MESSAGE, "{message}");
            false
        }
    }
}

/// A scene as resolved reads back as the same scene.
fn reads_back(scene: &Scene) {
    let resolved = scene.resolved_toml();
    let again = Scene::parse(&resolved, "resolved.toml", &[]);
    assert_eq!(again.as_ref().ok(), Some(scene), "{again:?}\n{resolved}");
}

/// A scene: an error with a message of reasonable length, or a scene that reads back equal from its own text.
fn scene(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    judged(Scene::parse(&text, "hostile.toml", &[]), |scene| {
        reads_back(&scene);
    })
}

/// Frames of a trajectory in whatever format the bytes look like: whole frames of finite numbers, as many and in a box, or an error.
fn frames(bytes: &[u8]) -> bool {
    /// A byte of gzip stands for so many, and two bits of XTC for a particle at most.
    const MOST_PER_BYTE: usize = 4 * 1032;
    // A particle of a text has three numbers, each with a space.
    let is_text = !bytes.starts_with(&[0x1f, 0x8b]) && std::str::from_utf8(bytes).is_ok();
    let most = if is_text { bytes.len() / 6 + 1 } else { MOST_PER_BYTE * bytes.len() };
    let read = || {
        let mut frames = Frames::of_bytes(bytes, FileUnits::default())?;
        let mut first = None;
        while let Some(frame) = frames.next_frame()? {
            let n = frame.positions.len();
            assert!(n > 0 && n <= most && *first.get_or_insert(n) == n);
            assert!(frame.cell.is_some_and(|cell| cell.volume().is_finite()));
            let optional = frame.velocities.iter().chain(&frame.momenta).chain(&frame.forces);
            assert!(optional.clone().all(|all| all.len() == n));
            assert!(frame.positions.iter().chain(optional.flatten()).all(|r| r.is_finite()));
        }
        Ok(frames.next_frame()?.is_none())
    };
    read().unwrap_or_else(|error: FormatError| {
        assert!(!matches!(error, FormatError::Content { line: 0, .. }), "{error}");
        judged(Err::<(), _>(error), drop)
    })
}

/// A start configuration in NIST columns, LAMMPS dump or data, GRO, or whatever else the bytes look like.
fn start(bytes: &[u8]) -> bool {
    judged(read_configuration_bytes(bytes), |start| {
        let vectors = start.velocities.iter().chain(&start.momenta).flatten();
        assert!(!start.positions.is_empty());
        assert!(start.positions.iter().chain(vectors).all(|r| r.is_finite()));
        assert!(start.cell.volume() > 0.0 && start.cell.volume().is_finite());
        assert!(start.velocities.is_none_or(|v| v.len() == start.positions.len()));
    })
}

/// Gzip of whatever bytes is read as the bytes themselves; bytes that begin like gzip are read as they are.
fn gzip(bytes: &[u8]) -> bool {
    let accepted = start(bytes);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let compressed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    let compressed = compressed.expect("memory takes all bytes");
    let twice = bytes.starts_with(&[0x1f, 0x8b]);
    match (read_configuration_bytes(bytes), read_configuration_bytes(&compressed)) {
        (Ok(plain), Ok(inflated)) => assert_eq!(plain, inflated),
        (Err(_), Err(_)) => {}
        // Text within gzip within gzip is not looked for.
        (Ok(_), Err(_)) if twice => {}
        (plain, inflated) => panic!("{plain:?} as it is, {inflated:?} from gzip"),
    }
    accepted
}

/// A table of a potential: an error of reasonable length, or energies and forces that are numbers up to the cutoff.
fn table(bytes: &[u8]) -> bool {
    /// Where the tables of the corpus begin and where they are cut, σ.
    const BEGIN: f64 = 1.0;
    const R_CUT: f64 = 1.14;
    static FOLDER: LazyLock<TempDir> = LazyLock::new(crate::restart::temporary);
    let file = FOLDER.path().join("hostile.table");
    std::fs::write(&file, bytes).expect("a file for a table");
    let text = format!(
        "[system]\nn_atoms = 108\ndensity = 0.3\ntemperature = 1.0\n\
         [potential]\nkind = \"table\"\nfile = {file:?}\n\
         [truncation]\nkind = \"shift\"\nr_cut = {R_CUT}\n\
         [[stage]]\nname = \"production\"\nsteps = 1\n"
    );
    judged(Scene::parse(&text, "hostile.toml", &[]), |scene| {
        let model = Model::new(&scene.potential, &scene.truncation);
        let model = model.expect("the scene was checked");
        for k in 0..=20 {
            let r = BEGIN + (R_CUT - BEGIN) * f64::from(k) / 20.0;
            let pair = model.eval(r * r);
            assert!(pair.energy.is_finite() && pair.force.is_finite(), "r = {r}");
        }
        reads_back(&scene);
    })
}

/// A checkpoint: arrays no larger than the bytes that they came from, or an error.
fn checkpoint(bytes: &[u8]) -> bool {
    judged(read_checkpoint_bytes(bytes), |checkpoint| {
        let total: usize = checkpoint.archive.arrays.values().map(words).sum();
        assert!(8 * total <= bytes.len());
        assert!(checkpoint.scene.len() <= bytes.len());
    })
}

fn words(array: &Array) -> usize {
    match array {
        Array::F64(v) => v.len(),
        Array::U64(v) => v.len(),
        Array::Vec3(v) => 3 * v.len(),
    }
}

/// Bytes of the prefix of a checkpoint, and where its length stands in it.
const PREFIX: usize = 24;
const LENGTH: std::ops::Range<usize> = 16..24;
const CHECKSUM: usize = 4;

/// Writes the right length and checksum into what may be a checkpoint.
fn seal(bytes: &mut [u8]) {
    if bytes.len() < PREFIX + CHECKSUM {
        return;
    }
    let length = (bytes.len() as u64).to_le_bytes();
    bytes[LENGTH].copy_from_slice(&length);
    let body = bytes.len() - CHECKSUM;
    let sum = crc32fast::hash(&bytes[..body]).to_le_bytes();
    bytes[body..].copy_from_slice(&sum);
}
