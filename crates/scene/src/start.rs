//! How the particles are placed before the first step.

use std::path::PathBuf;

use lennard_core::DVec3;
use lennard_io::FileUnits;

use crate::{Geometry, HalfCrystal, Lattice, Slab};

/// How the particles are placed.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// On a lattice, or at random without overlaps.
    Lattice {
        /// Which one.
        lattice: Lattice,
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
    Configuration {
        /// The file: extended XYZ, LAMMPS dump or data, GRO, or the NIST columns.
        path: PathBuf,
        /// The box, for files that name none.
        geometry: Option<Geometry>,
        /// The units of the file.
        units: FileUnits,
    },
}

impl Start {
    /// Number of listed particles, or of molecules on a lattice or in a slab; `None` where a file has it.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        match self {
            Self::Lattice { n_atoms, .. } => Some(*n_atoms),
            Self::Slab(slab) => Some(slab.n_atoms),
            Self::HalfCrystal(start) => Some(start.n_atoms),
            Self::Listed { positions, .. } => Some(positions.len()),
            Self::Configuration { .. } => None,
        }
    }

    /// Number of particles, with so many sites in a molecule; `None` where a file has it.
    #[must_use]
    pub fn particles(&self, sites: usize) -> Option<usize> {
        match self {
            // Every site is listed; elsewhere the scene counts molecules.
            Self::Listed { positions, .. } => Some(positions.len()),
            _ => Some(self.count()? * sites),
        }
    }

    /// Whether each particle has the velocity that the scene lists, total momentum included.
    #[must_use]
    pub fn lists_velocities(&self) -> bool {
        matches!(self, Self::Listed { velocities: Some(_), .. })
    }
}
