//! Small systems and seeded noise shared by the tests.

use std::path::PathBuf;

use glam::DVec3;
use lennard_core::{PeriodicBox, State};
use lennard_io::{
    Beside, FileUnits, FormatError, Frames, StartConfiguration, TrajectoryFrame,
    read_configuration_in,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub type Noise = Xoshiro256PlusPlus;

pub fn noise(seed: u64) -> Noise {
    Noise::seed_from_u64(seed)
}

/// A file of this name, and the folder that goes with it when the test ends.
pub fn scratch(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

/// What is found where a file holds this text.
pub fn read_beside(
    text: impl AsRef<[u8]>,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let (_folder, path) = scratch("start");
    std::fs::write(&path, text).unwrap();
    read_configuration_in(&path, beside)
}

/// Holds a refusal to its words.
#[track_caller]
pub fn refused<T>(result: Result<T, impl ToString>, words: &[&str]) {
    let Err(error) = result else { panic!("taken, where this was wanted: {words:?}") };
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in {message}");
    }
}

/// Every frame of a trajectory.
pub fn frames_of(bytes: &[u8]) -> Result<Vec<TrajectoryFrame>, FormatError> {
    let mut frames = Frames::of_bytes(bytes, FileUnits::default())?;
    std::iter::from_fn(|| frames.next_frame().transpose()).collect()
}

pub fn cell() -> PeriodicBox {
    PeriodicBox::new(DVec3::new(10.0, 11.5, 12.25)).unwrap()
}

/// `n` particles within `reach` boxes of the home box, with velocities and forces of many sizes.
pub fn system(n: usize, reach: f64, seed: u64) -> State {
    let mut noise = noise(seed);
    let mut vector = |size: DVec3| {
        DVec3::from_array(std::array::from_fn(|axis| size[axis] * noise.random_range(-1.0..1.0)))
    };
    let positions = (0..n).map(|_| vector(reach * cell().lengths())).collect();
    let velocities = (0..n).map(|i| vector(DVec3::splat(10_f64.powi(i as i32 % 7 - 3)))).collect();
    let mut state = State::new(cell(), positions, velocities);
    state.forces = (0..n).map(|_| vector(DVec3::splat(300.0))).collect();
    state.step = 1200;
    state.time = 4.8;
    state
}

/// What a byte may be replaced by: those that formats give a meaning, and some that none does.
const TELLING_BYTES: &[u8] = b"0123456789.-+eE \t\n\r\"{}=:\\,TFnaif\0\xff\x80\x01";

/// Words that hostile files are made of.
const TELLING_WORDS: [&str; 24] = [
    "18446744073709551615",
    "18446744073709551616",
    "9999999999",
    "4294967296",
    "-1",
    "0",
    "nan",
    "inf",
    "1e999",
    "-1e308",
    "1e-320",
    "Properties=",
    "pos:R:3",
    "species:S:1:pos:R:3:",
    "map_shift:I:3",
    "Lattice=\"1 0 0 0 1 0 0 0 1\"",
    "Lattice=\"",
    "pbc=\"T T F\"",
    "length_scale=1e-300",
    "\r\n",
    "\n\n\n",
    "2147483648",
    "\u{feff}",
    "R:99999999999999999999",
];

/// One to eight random changes: bytes replaced, pieces removed, doubled, moved, words put in, ends cut off.
pub fn mutate(text: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut out = text.to_vec();
    for _ in 0..noise.random_range(1..=8) {
        if out.is_empty() {
            out.push(b'0');
        }
        let at = noise.random_range(0..out.len());
        let end = (at + noise.random_range(1..40)).min(out.len());
        match noise.random_range(0..8) {
            0 => out[at] = TELLING_BYTES[noise.random_range(0..TELLING_BYTES.len())],
            1 => out[at] ^= 1 << noise.random_range(0..8),
            2 => drop(out.drain(at..end)),
            3 => out.truncate(at),
            4 => {
                let piece = out[at..end].to_vec();
                let to = noise.random_range(0..=out.len());
                out.splice(to..to, piece);
            }
            5 => {
                let word = TELLING_WORDS[noise.random_range(0..TELLING_WORDS.len())];
                out.splice(at..at, word.bytes());
            }
            6 => {
                let word = TELLING_WORDS[noise.random_range(0..TELLING_WORDS.len())];
                out.splice(at..end, word.bytes());
            }
            _ => out[at] = noise.random(),
        }
    }
    out
}
