//! The value that each kind of start returns, and who says it.

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox, SpeciesTable};
use lennard_scene::Scene;

use crate::close_pairs::{ClosePair, closest_pair};

/// Where the particles are, and how fast, before the first step.
#[derive(Debug, Clone)]
pub struct Start {
    /// The box.
    pub cell: PeriodicBox,
    /// Positions, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, if the start has any.
    pub velocities: Option<Vec<DVec3>>,
    /// The species of the particles.
    pub species: SpeciesTable,
    /// Whether the positions must be relaxed first.
    pub relax: bool,
    /// What is to be known of it: which frame of a file it is, and what its velocities lose.
    pub remarks: Vec<String>,
}

impl Start {
    /// Particles in motion, whose places need no check.
    #[must_use]
    pub fn at(
        cell: PeriodicBox,
        positions: Vec<DVec3>,
        velocities: Vec<DVec3>,
        species: SpeciesTable,
    ) -> Self {
        let velocities = Some(velocities);
        Self { cell, positions, velocities, species, relax: false, remarks: Vec::new() }
    }

    /// The closest pair nearer than `within`, in units of σ_ab of each pair.
    pub(super) fn closest(&self, scene: &Scene, within: f64) -> Option<ClosePair> {
        closest_pair(scene, &self.species, &self.cell, &self.positions, within)
    }
}

/// Who says where the particles are.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    /// The key of the scene.
    pub key: &'static str,
    /// The file, or what stands for it.
    pub name: String,
    /// Whether a user wrote the positions; otherwise the program makes them.
    pub is_given: bool,
}

impl Origin {
    pub fn given(key: &'static str, name: &impl ToString) -> Self {
        Self { key, name: name.to_string(), is_given: true }
    }
}

/// The random streams of a start.
pub(super) fn streams(scene: &Scene) -> Streams {
    Streams::new(scene.system.seed)
}
