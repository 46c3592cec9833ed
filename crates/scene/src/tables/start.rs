//! The tables `[system]` and `[start]`: how many particles there are, in which box, and how they stand at the start.

use std::path::PathBuf;

use lennard_core::options::{Keys, OptionValue, Options};
use lennard_core::{DVec3, PeriodicBox};
use lennard_io::FileUnits;
use serde::{Deserialize, Serialize};

use crate::limits::{
    COLDEST, DENSEST, HOTTEST, LONGEST_SIDE, MOST_ATOMS, MOST_ENTRIES, SHORTEST_SIDE, THINNEST,
};
use crate::methods::Method;
use crate::tables::as_toml;

/// The table `[system]`.
#[derive(Debug, Clone, PartialEq)]
pub struct System {
    /// Where the particles are at step 0.
    pub start: Arrangement,
    /// Temperature of the first velocities in ε/k_B (where the start has none) and of every thermostat
    /// that names no other; ≥ 0.
    pub temperature: f64,
    /// Seed of every random stream.
    pub seed: u64,
    /// Particles that never move, by their numbers from 0, ascending.
    pub held: Vec<usize>,
}

lennard_core::choices! {
    /// A cubic lattice.
    pub enum Lattice {
        /// Face-centred cubic, 4 particles a cell.
        #[default]
        Fcc = "fcc",
        /// Simple cubic, 1 particle a cell.
        Sc = "sc",
        /// Body-centred cubic, 2 particles a cell.
        Bcc = "bcc",
    }
}

/// The size of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Geometry {
    /// A cube that holds the particles at this number density, σ⁻³.
    Density(f64),
    /// Three sides in σ.
    Box([f64; 3]),
}

/// A box with the part of it that particles fill at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// The lower corner of the filled part, σ.
    pub corner: DVec3,
    /// The sides of the filled part, σ.
    pub filled: DVec3,
    /// Lattice cells along each axis; `None` for a random start.
    pub cells: Option<[usize; 3]>,
}

/// How the particles are placed.
#[derive(Debug, Clone, PartialEq)]
pub enum Arrangement {
    /// On a lattice, or at random without overlaps.
    Lattice {
        /// Which one; `None` for places at random, relaxed until nothing overlaps.
        lattice: Option<Lattice>,
        /// Number of particles, or of molecules where particles are bonded.
        n_atoms: usize,
        /// Size of the region that they fill; a density is of molecules where particles are bonded.
        geometry: Geometry,
        /// Empty length in σ added along z, the filled region in the middle: a slab between two vacuums;
        /// 0 for a homogeneous fluid.
        vacuum: f64,
    },
    /// Liquid between two parts of vapor.
    Slab(Slab),
    /// A crystal beside its liquid.
    HalfCrystal(HalfCrystal),
    /// As the scene lists them.
    Listed {
        /// Sides of the box, σ; of the part between the walls, where there are walls.
        sides: [f64; 3],
        /// A position for each particle, σ. Along a walled axis they count from the lower wall.
        positions: Vec<DVec3>,
        /// A velocity for each particle, σ/τ; `None` for velocities of the system's temperature.
        velocities: Option<Vec<DVec3>>,
    },
    /// As a file says.
    File {
        /// Its path: extended XYZ, LAMMPS dump or data, GRO, or the NIST columns.
        path: PathBuf,
        /// The box, for files that name none.
        geometry: Option<Geometry>,
        /// The units of the file.
        units: FileUnits,
    },
}

impl Arrangement {
    /// Number of listed particles, or of molecules on a lattice or in a slab; `None` where a file has it.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        match self {
            Self::Lattice { n_atoms, .. } => Some(*n_atoms),
            Self::Slab(slab) => Some(slab.n_atoms),
            Self::HalfCrystal(start) => Some(start.n_atoms),
            Self::Listed { positions, .. } => Some(positions.len()),
            Self::File { .. } => None,
        }
    }

    /// Whether each particle has the velocity that the scene lists, total momentum included.
    #[must_use]
    pub fn lists_velocities(&self) -> bool {
        matches!(self, Self::Listed { velocities: Some(_), .. })
    }
}

/// A face-centred crystal from the lower end of z, and its liquid above it.
///
/// The cross-section is `cells` whole cells wide, without strain: its side is cells·(4/ρ_s)^{1/3}. The liquid has the other particles, at its
/// own density. There are two fronts, since the box is periodic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfCrystal {
    /// Number of particles, in both phases together.
    pub n_atoms: usize,
    /// Cells across x and across y.
    pub cells: usize,
    /// Cells along z.
    pub layers: usize,
    /// Density of the crystal at the start, σ⁻³.
    pub crystal_density: f64,
    /// Density of the liquid at the start, σ⁻³.
    pub liquid_density: f64,
}

/// Particles of a cell of the face-centred cubic lattice.
pub(crate) fn per_cell() -> usize {
    Lattice::Fcc.basis().len()
}

impl HalfCrystal {
    /// How many particles start in the crystal.
    #[must_use]
    pub fn n_crystal(&self) -> usize {
        per_cell() * self.cells * self.cells * self.layers
    }

    /// The edge of a cell, σ.
    fn edge(&self) -> f64 {
        (per_cell() as f64 / self.crystal_density).cbrt()
    }

    /// The side of the cross-section, σ.
    #[must_use]
    pub fn side(&self) -> f64 {
        self.cells as f64 * self.edge()
    }

    /// The length of the crystal, σ.
    #[must_use]
    pub fn crystal_length(&self) -> f64 {
        self.layers as f64 * self.edge()
    }

    /// The length of the liquid, σ.
    #[must_use]
    pub fn liquid_length(&self) -> f64 {
        let n_liquid = self.n_atoms.saturating_sub(self.n_crystal()) as f64;
        n_liquid / (self.liquid_density * self.side().powi(2))
    }
}

lennard_core::options! {
    /// The keys of a start with a crystal beside its liquid.
    pub(crate) struct CrystalKeys {
        /// Face-centred cells across x and across y.
        cells: Option<usize> = None, else "as many as make the crystal about twice as long as wide", Whole(1, MOST_ENTRIES as i64);
        /// Face-centred cells along z.
        layers: Option<usize> = None, else "as many as take half of the particles", Whole(1, MOST_ATOMS);
        /// Density of the crystal at the start; its cross-section is without strain.
        crystal_density: Option<f64> = None, else "melting line of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Density of the liquid at the start.
        liquid_density: Option<f64> = None, else "freezing line of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
    }
}

impl From<&HalfCrystal> for CrystalKeys {
    fn from(start: &HalfCrystal) -> Self {
        Self {
            cells: Some(start.cells),
            layers: Some(start.layers),
            crystal_density: Some(start.crystal_density),
            liquid_density: Some(start.liquid_density),
        }
    }
}

impl Lattice {
    /// The sites of a cell as fractions of its edges.
    #[must_use]
    pub fn basis(self) -> &'static [[f64; 3]] {
        match self {
            Self::Fcc => &[[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]],
            Self::Sc => &[[0.0, 0.0, 0.0]],
            Self::Bcc => &[[0.0, 0.0, 0.0], [0.5, 0.5, 0.5]],
        }
    }
}

/// A slab of liquid across z between two parts of vapor.
///
/// The cross-section is a square. Its side follows from the number of particles:
/// A = N/(ρ_l·d + ρ_v·(L_z − d)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Number of particles, in both phases together.
    pub n_atoms: usize,
    /// Density of the liquid at the start, σ⁻³.
    pub liquid_density: f64,
    /// Density of the vapor at the start, σ⁻³.
    pub vapor_density: f64,
    /// Thickness d of the liquid, σ.
    pub thickness: f64,
    /// Length L_z of the box, σ.
    pub length: f64,
}

impl Slab {
    /// The least length of the vapor between the two surfaces, σ.
    pub const LEAST_VAPOR: f64 = 4.0;

    /// The area of the cross-section, σ².
    #[must_use]
    pub fn area(&self) -> f64 {
        let per_area = self.liquid_density * self.thickness
            + self.vapor_density * (self.length - self.thickness);
        self.n_atoms as f64 / per_area
    }

    /// How many of the particles start as vapor.
    #[must_use]
    pub fn n_vapor(&self) -> usize {
        let volume = self.area() * (self.length - self.thickness);
        ((self.vapor_density * volume).round() as usize).min(self.n_atoms)
    }

    /// The sides of the box, σ.
    pub(crate) fn sides(&self) -> DVec3 {
        let side = self.area().sqrt();
        DVec3::new(side, side, self.length)
    }
}

lennard_core::options! {
    /// The keys of a start with a slab of liquid.
    pub(crate) struct SlabKeys {
        /// Density of the liquid at the start.
        liquid_density: Option<f64> = None, else "saturation of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Density of the vapor at the start.
        vapor_density: Option<f64> = None, else "saturation of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Thickness of the liquid across z; 12 σ or more for the densities and the tension of bulk phases.
        thickness: Option<f64> = None, else "1.5 times the side of the cross-section, or a third of `length`", Between(SHORTEST_SIDE, LONGEST_SIDE), in "σ";
        /// Length of the box along z.
        length: Option<f64> = None, else "3 times `thickness`", Between(SHORTEST_SIDE, LONGEST_SIDE), in "σ";
    }
}

impl From<&Slab> for SlabKeys {
    fn from(slab: &Slab) -> Self {
        Self {
            liquid_density: Some(slab.liquid_density),
            vapor_density: Some(slab.vapor_density),
            thickness: Some(slab.thickness),
            length: Some(slab.length),
        }
    }
}

lennard_core::options! {
    /// The keys of `[system]`.
    pub(crate) struct SystemKeys {
        /// Number of particles; `positions` and files have their own.
        n_atoms: Option<usize> = None, else "needed", Whole(1, MOST_ATOMS);
        /// Number of molecules, in place of `n_atoms`: their centres stand on the lattice, their axes along its body diagonals.
        n_molecules: Option<usize> = None, else "needed with `[molecule]`", Whole(1, MOST_ATOMS);
        /// Number density of the start; the box is a cube.
        density: Option<f64> = None, else "this or `box`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Box sides. With a `file`, the box of a file that names none.
        sides as "box": Option<Sides> = None, else "this or `density`", Words("one side, or three sides [Lx, Ly, Lz], each a finite number above 0"), in "σ";
        /// Particles that never move: their mass is infinite.
        held: Option<Numbers> = None, else "none", Words("a list of numbers of particles, from 1, each once, and not all of them");
        /// Temperature of the first velocities (where neither scene nor file gives them) and of every thermostat that names no other.
        temperature: Option<f64> = None, else "needed; `0.0` with `positions`", ZeroOrBetween(COLDEST, HOTTEST), in "ε/k_B";
        /// Seed of every random stream.
        seed: u64 = 1, Whole(0, i64::MAX);
    }
}

/// `[start]`: its kind, with the keys of the kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(crate) enum StartKeys {
    Lattice(LatticeKeys),
    Random(RandomKeys),
    Slab(SlabKeys),
    HalfCrystal(CrystalKeys),
    Positions(PositionKeys),
    File(FileKeys),
}

impl Method for StartKeys {
    fn keys() -> Vec<(&'static str, Keys)> {
        vec![
            ("lattice", LatticeKeys::KEYS),
            ("random", RandomKeys::KEYS),
            ("slab", SlabKeys::KEYS),
            ("half-crystal", CrystalKeys::KEYS),
            ("positions", PositionKeys::KEYS),
            ("file", FileKeys::KEYS),
        ]
    }
}

lennard_core::options! {
    /// The keys of a start on a lattice.
    pub(crate) struct LatticeKeys {
        /// Which lattice. In a cube, fcc takes 4m³ particles, bcc 2m³, sc m³; in another box, 4abc, 2abc or abc with nearly cubic cells (edges within 10 % of each other).
        lattice: Lattice = Lattice::Fcc, Names(Lattice::names);
        /// Empty length added to the box along z, with the particles in the middle: a slab between two surfaces. `density` and `box` then describe the filled part.
        vacuum: f64 = 0.0, Between(0.0, LONGEST_SIDE), in "σ";
    }
}

lennard_core::options! {
    /// The keys of a start at random.
    pub(crate) struct RandomKeys {
        /// As on a lattice.
        vacuum: f64 = 0.0, Between(0.0, LONGEST_SIDE), in "σ";
    }
}

lennard_core::options! {
    /// The keys of a start from positions.
    pub(crate) struct PositionKeys {
        /// The positions, in the `box`. With molecules, the sites of each follow each other. Along an axis with walls they count from the lower wall.
        positions: Option<Vec<[f64; 3]>> = None, else "needed", Words("a list with one position [x, y, z] for each particle"), in "σ";
        /// Velocities of the `positions`. Their total momentum is kept.
        velocities: Option<Vec<[f64; 3]>> = None, else "velocities of `system.temperature`", Words("a list with one velocity [vx, vy, vz] for each of `positions`"), in "σ/τ";
    }
}

lennard_core::options! {
    /// The keys of a start from a file.
    pub(crate) struct FileKeys {
        /// The file (extended XYZ, LAMMPS dump or data, GRO, NIST columns; each may be compressed by gzip), relative to the scene file.
        file: Option<String> = None, else "needed", Words("the path of a file that can be read");
        /// One σ in the unit of length of the file, where that is not σ: 0.3405 for argon in nm, 3.405 in ångström.
        length_scale: Option<f64> = None, else "the file holds reduced units", Between(1e-12, 1e12), in "file units per σ";
        /// One τ in the unit of time of the file, for its velocities: 2.156 for argon in ps.
        time_scale: Option<f64> = None, else "needed with `length_scale`, where the file has velocities", Between(1e-12, 1e12), in "file units per τ";
    }
}

/// Numbers of particles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Numbers(pub Vec<u64>);

/// One side of a cube, or three sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "WrittenSides")]
pub(crate) struct Sides(pub [f64; 3]);

#[derive(Deserialize)]
#[serde(untagged)]
enum WrittenSides {
    Cube(f64),
    Sides([f64; 3]),
}

impl From<WrittenSides> for Sides {
    fn from(written: WrittenSides) -> Self {
        match written {
            WrittenSides::Cube(side) => Self([side; 3]),
            WrittenSides::Sides(sides) => Self(sides),
        }
    }
}

macro_rules! written_as_toml {
    ($($value:ident)*) => {$(
        impl OptionValue for $value {
            fn written(&self) -> String {
                as_toml(self)
            }
        }
    )*};
}

written_as_toml! { Sides Numbers }
