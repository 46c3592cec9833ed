//! The table `[system]` written out again.

use std::path::Path;

use lennard_core::DVec3;
use serde::Serialize;

use crate::{Geometry, Scene, Start};

/// The table with every default in its place.
#[derive(Serialize, Default)]
pub(crate) struct ResolvedSystem {
    #[serde(skip_serializing_if = "Option::is_none")]
    positions: Option<Vec<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocities: Option<Vec<[f64; 3]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    held: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    configuration: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lattice: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    n_atoms: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    n_molecules: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    density: Option<f64>,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    sides: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    vacuum: Option<f64>,
    temperature: f64,
    seed: u64,
}

impl Scene {
    /// The table `[system]` with every default.
    pub(crate) fn resolved_system(&self) -> ResolvedSystem {
        let mut system = ResolvedSystem {
            temperature: self.system.temperature,
            seed: self.system.seed,
            held: self.system.held.iter().map(|i| i + 1).collect(),
            ..ResolvedSystem::default()
        };
        let mut place = |geometry: &Geometry| match geometry {
            Geometry::Density(density) => system.density = Some(*density),
            Geometry::Box(sides) => system.sides = Some(*sides),
        };
        match &self.system.start {
            Start::Lattice {
                lattice,
                n_atoms,
                geometry,
                vacuum,
            } => {
                place(geometry);
                system.lattice = Some(lattice.name());
                match &self.molecule {
                    None => system.n_atoms = Some(*n_atoms),
                    Some(_) => system.n_molecules = Some(*n_atoms),
                }
                system.vacuum = Some(*vacuum);
            }
            Start::Slab(slab) => system.n_atoms = Some(slab.n_atoms),
            Start::Listed {
                sides,
                positions,
                velocities,
            } => {
                let in_rows = |all: &Vec<DVec3>| all.iter().map(DVec3::to_array).collect();
                place(&Geometry::Box(*sides));
                system.positions = Some(in_rows(positions));
                system.velocities = velocities.as_ref().map(in_rows);
            }
            Start::Configuration { path, geometry } => {
                if let Some(geometry) = geometry {
                    place(geometry);
                }
                system.configuration = Some(text(path));
            }
        }
        system
    }
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
