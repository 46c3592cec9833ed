//! The masses of particles.

use crate::species::SpeciesTable;

/// The masses of the particles.
#[derive(Debug, Clone, PartialEq)]
pub enum Masses {
    /// All particles have this mass.
    Uniform(f64),
    /// One mass per particle, `[N]`.
    Each(Vec<f64>),
}

impl Masses {
    /// The masses of the species; one number where all are equal.
    #[must_use]
    pub fn of_species(table: &SpeciesTable) -> Self {
        let first = table.species(0).mass;
        if table.all().iter().all(|s| s.mass == first) {
            return Self::Uniform(first);
        }
        let masses = (0..table.n_particles()).map(|i| table.species(table.of(i)).mass);
        Self::Each(masses.collect())
    }

    /// The mass of particle `i`.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> f64 {
        match self {
            Self::Uniform(m) => *m,
            Self::Each(m) => m[i],
        }
    }
}
