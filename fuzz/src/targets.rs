//! The readers, each with what must hold for any bytes.

use std::io::Write;

use lennard_core::Array;
use lennard_io::{read_checkpoint_bytes, read_configuration_bytes, read_trajectory_bytes};
use lennard_scene::Scene;

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
    /// Words that mean something in this format.
    pub words: &'static [&'static str],
}

/// Every reader.
pub const TARGETS: &[Target] = &[
    Target {
        name: "scene",
        body: scene,
        repair: None,
        reshape: None,
        words: SCENE_WORDS,
    },
    Target {
        name: "extended-xyz",
        body: extended_xyz,
        repair: None,
        reshape: None,
        words: XYZ_WORDS,
    },
    Target {
        name: "nist",
        body: start,
        repair: None,
        reshape: None,
        words: XYZ_WORDS,
    },
    Target {
        name: "lammps-dump",
        body: start,
        repair: None,
        reshape: None,
        words: LAMMPS_WORDS,
    },
    Target {
        name: "lammps-data",
        body: start,
        repair: None,
        reshape: None,
        words: LAMMPS_WORDS,
    },
    Target {
        name: "gzip",
        body: gzip,
        repair: None,
        reshape: None,
        words: XYZ_WORDS,
    },
    Target {
        name: "checkpoint",
        body: checkpoint,
        repair: Some(seal),
        reshape: None,
        words: CHECKPOINT_WORDS,
    },
    Target {
        name: "restart",
        body: restart,
        repair: Some(seal),
        reshape: Some(reshape),
        words: CHECKPOINT_WORDS,
    },
];

const SCENE_WORDS: &[&str] = &[
    "[[stage]]\n",
    "[system]\n",
    "[[wall]]\nkind = \"hard\"\n",
    "[field]\nacceleration = [0.0, 0.0, -1e308]\n",
    "[molecule]\nbond_length = 0.67\n",
    "[contact]\nkind = \"hard\"\ndiameter = 1.0\n",
    "[contact]\nlaw = \"hertz\"\nstiffness = 1e300\nrestitution = 0.01\n",
    "[potential]\nkind = \"none\"\n",
    "box = 1e-300\npositions = [[0, 0, 0], [1e300, -1e300, nan]]\n",
    "velocities = [[1e308, 0, 0]]\n",
    "held = [0, 1, 18446744073709551615]\n",
    "[[species]]\nname = \"A\"\nfraction = 0.5\n",
    "[[species]]\nname = \"B\"\ncount = 1000000000\nsigma = 1e-300\n",
    "[mixing]\nrule = \"lorentz-berthelot\"\nk = -1.0\n",
    "[[pair]]\na = \"A\"\nb = \"B\"\nepsilon = 0.0\nr_cut = 1e6\n",
    "r_cut_in = \"pair\"",
    "fraction = 1e-300",
    "mass = 1e300",
    "[bonds]\nmethod = \"relaxation\"\n",
    "n_molecules = 1000000000",
    "sites = 64",
    "bond_length = 1e-300",
    "stiffness = 1e300",
    "axis = \"x\"",
    "thickness = 1e300",
    "[[",
    "]]",
    "steps = 18446744073709551615",
    "n_atoms = 1000000000000",
    "n_atoms = -1",
    "density = 1e-300",
    "density = 1e300",
    "box = [1.0, 2.0, 3.0]",
    "box = 1e308",
    "nan",
    "inf",
    "-0.0",
    "1e999",
    "r_cut = 1e-310",
    "kind = \"respa\"",
    "kind = \"\"",
    "thermostat = { kind = \"bussi\" }",
    "thermostat = \"nose-hoover\"",
    "barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.0 }",
    "barostat = { kind = \"mtk\", pressure = { from = 1.0, to = 2.0 } }",
    "coupling = \"xy-z\"",
    "temperature = { from = 2.0, to = 1.0 }",
    "every = 0",
    "bins = 4294967296",
    "\"\"\"",
    "'''",
    "\\u0000",
    "1979-05-27T07:32:00Z",
    "= {",
    "}",
    "#",
    "\r",
    "a.b.c.d = 1\n",
    "[a]\n[a]\n",
    "skin = 1e300",
    "dt = 5e-324",
    "seed = 0xffffffffffffffff",
];

const XYZ_WORDS: &[&str] = &[
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
    "velo:R:3",
    "forces:R:3",
    "Lattice=\"1 0 0 0 1 0 0 0 1\"",
    "Lattice=\"",
    "pbc=\"T T F\"",
    "length_scale=1e-300",
    "\r\n",
    "\n\n\n",
    "2147483648",
    "\u{feff}",
    "R:99999999999999999999",
    "Time=1e400",
    "1.0E+00",
    "1d0",
    "\t",
];

const LAMMPS_WORDS: &[&str] = &[
    "18446744073709551615",
    "4294967296",
    "-1",
    "0",
    "nan",
    "1e999",
    "-1e308",
    "1e-320",
    "2147483647 2147483647 2147483647",
    "ITEM: TIMESTEP\n",
    "ITEM: NUMBER OF ATOMS\n",
    "ITEM: BOX BOUNDS pp pp pp\n",
    "ITEM: BOX BOUNDS xy xz yz pp pp pp\n",
    "ITEM: UNITS\nlj\n",
    "ITEM: TIME\n",
    "ITEM: ATOMS ",
    "id type x y z ix iy iz",
    "xsu ysu zsu ",
    "element mass ",
    "Masses\n\n",
    "Atoms # atomic\n\n",
    "Velocities\n\n",
    "Atom Type Labels\n\n",
    "Pair Coeffs\n\n",
    " xlo xhi\n",
    " xy xz yz\n",
    " atoms\n",
    " bonds\n",
    "#",
    "\r\n",
    "\n\n\n",
    "\t",
];

const CHECKPOINT_WORDS: &[&str] = &[
    "\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}",
    "\u{1}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}",
    "\u{5}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}",
    "\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{7f}",
    "LENNARD\u{1a}",
    "{",
    "}",
    "\"",
    "\"step\":18446744073709551616",
    "state/positions",
    "null",
    "[[[[[[[[",
];

/// A scene: an error with a message of reasonable length, or a scene that reads back equal from its own text.
pub fn scene(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    match Scene::parse(&text, "hostile.toml", &[]) {
        Ok(scene) => {
            let resolved = scene.resolved_toml();
            let again = Scene::parse(&resolved, "resolved.toml", &[]);
            assert_eq!(again.as_ref().ok(), Some(&scene), "{again:?}\n{resolved}");
            true
        }
        Err(error) => {
            assert_short(&error.to_string());
            false
        }
    }
}

/// Extended XYZ: whole frames of finite numbers, or an error that names a line.
pub fn extended_xyz(bytes: &[u8]) -> bool {
    let _ = read_configuration_bytes(bytes);
    match read_trajectory_bytes(bytes) {
        Ok(frames) => {
            for frame in &frames {
                let n = frame.positions.len();
                assert!(n > 0);
                let optional = frame.velocities.iter().chain(&frame.forces);
                assert!(optional.clone().all(|v| v.len() == n));
                assert!(
                    frame
                        .positions
                        .iter()
                        .chain(optional.flatten())
                        .all(|r| r.is_finite())
                );
                // Every particle takes at least a letter and three digits with their blanks and line end.
                assert!(8 * n <= bytes.len() + 8);
            }
            true
        }
        Err(error) => {
            assert!(error.line().is_some_and(|line| line >= 1));
            assert_short(&error.to_string());
            false
        }
    }
}

/// A start configuration in NIST columns, LAMMPS dump or data, or whatever else the bytes look like.
pub fn start(bytes: &[u8]) -> bool {
    match read_configuration_bytes(bytes) {
        Ok(start) => {
            assert!(!start.positions.is_empty() && start.positions.iter().all(|r| r.is_finite()));
            assert!(start.cell.volume() > 0.0 && start.cell.volume().is_finite());
            assert!(
                start
                    .velocities
                    .is_none_or(|v| v.len() == start.positions.len())
            );
            true
        }
        Err(error) => {
            assert_short(&error.to_string());
            false
        }
    }
}

/// Gzip of whatever bytes is read as the bytes themselves; bytes that begin like gzip are read as they are.
pub fn gzip(bytes: &[u8]) -> bool {
    let accepted = start(bytes);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let compressed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    let compressed = compressed.expect("memory takes all bytes");
    let twice = bytes.starts_with(&[0x1f, 0x8b]);
    match (
        read_configuration_bytes(bytes),
        read_configuration_bytes(&compressed),
    ) {
        (Ok(plain), Ok(inflated)) => assert_eq!(plain, inflated),
        (Err(_), Err(_)) => {}
        // Text within gzip within gzip is not looked for.
        (Ok(_), Err(_)) if twice => {}
        (plain, inflated) => panic!("{plain:?} as it is, {inflated:?} from gzip"),
    }
    accepted
}

/// A checkpoint: arrays no larger than the bytes that they came from, or an error.
pub fn checkpoint(bytes: &[u8]) -> bool {
    match read_checkpoint_bytes(bytes) {
        Ok(checkpoint) => {
            let total: usize = checkpoint.archive.arrays.values().map(words).sum();
            assert!(8 * total <= bytes.len());
            assert!(checkpoint.scene.len() <= bytes.len());
            true
        }
        Err(error) => {
            assert_short(&error.to_string());
            false
        }
    }
}

fn words(array: &Array) -> usize {
    match array {
        Array::F64(v) => v.len(),
        Array::I64(v) => v.len(),
        Array::U64(v) => v.len(),
        Array::Vec3(v) => 3 * v.len(),
    }
}

pub(crate) fn assert_short(message: &str) {
    assert!(
        !message.is_empty() && message.len() < LONGEST_MESSAGE,
        "{message}"
    );
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
