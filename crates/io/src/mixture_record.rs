//! Species and pairs of species in the record of a run.

use serde::{Deserialize, Serialize};

/// A species of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeciesRecord {
    /// Its name.
    pub name: String,
    /// Symbol in files.
    pub element: String,
    /// Number of particles.
    pub count: u64,
    /// Mole fraction.
    pub fraction: f64,
    /// Mass of a particle, m.
    pub mass: f64,
}

/// What acts between two species.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairRecord {
    /// Name of one species.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// σ_ab, σ.
    pub sigma: f64,
    /// ε_ab, ε.
    pub epsilon: f64,
    /// Cutoff, σ.
    pub r_cut: f64,
}
