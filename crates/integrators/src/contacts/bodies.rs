//! At what distance two bodies touch.

use lennard_core::{Exclusions, Masses, SpeciesTable};

/// The contact distance of each pair of bodies, and the pairs that never touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    species: Option<SpeciesTable>,
    /// Contact distance of each pair of species, σ; one number where the particles are alike.
    distances: Vec<f64>,
    exclusions: Exclusions,
}

impl Bodies {
    /// Equal spheres of a diameter, σ.
    #[must_use]
    pub fn alike(diameter: f64, exclusions: Exclusions) -> Self {
        Self { species: None, distances: vec![diameter], exclusions }
    }

    /// Bodies of several species, where `distance(a, b)` is the contact distance of two of them, σ.
    #[must_use]
    pub fn of_species(
        species: SpeciesTable,
        distance: impl Fn(usize, usize) -> f64,
        exclusions: Exclusions,
    ) -> Self {
        let n = species.n_species();
        Self {
            distances: (0..n * n).map(|k| distance(k / n, k % n)).collect(),
            species: Some(species),
            exclusions,
        }
    }

    /// The contact distance of two particles, σ.
    #[inline]
    #[must_use]
    pub fn distance(&self, i: usize, j: usize) -> f64 {
        match &self.species {
            None => self.distances[0],
            Some(species) => self.distances[species.of(i) * species.n_species() + species.of(j)],
        }
    }

    /// The largest contact distance, σ.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.distances.iter().copied().fold(0.0, f64::max)
    }

    /// The pairs that never touch: the ends of bonds.
    #[must_use]
    pub fn exclusions(&self) -> &Exclusions {
        &self.exclusions
    }
}

/// The reduced mass of two bodies; `None` where both are held, which nothing moves.
pub(crate) fn reduced_mass(masses: &Masses, i: usize, j: usize) -> Option<f64> {
    (!(masses.is_held(i) && masses.is_held(j))).then(|| masses.reduced(i, j))
}
