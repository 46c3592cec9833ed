//! The pairs of species of a mixture.

use lennard_core::SpeciesTable;

use crate::binned::Part;

/// Two species by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SpeciesPair {
    pub a: usize,
    pub b: usize,
}

impl SpeciesPair {
    /// All pairs a ≤ b, row by row.
    pub(crate) fn all(species: &SpeciesTable) -> impl Iterator<Item = Self> + use<> {
        let n = species.n_species();
        (0..n).flat_map(move |a| (a..n).map(move |b| Self { a, b }))
    }

    /// The pairs of a mixture; none where there is one species.
    pub(crate) fn of_mixture(species: &SpeciesTable) -> impl Iterator<Item = Self> + use<> {
        let is_mixture = species.is_mixture();
        Self::all(species).filter(move |_| is_mixture)
    }

    /// The same two, the other first.
    pub(crate) fn reversed(self) -> Self {
        Self { a: self.b, b: self.a }
    }

    /// Number of ordered pairs of particles: N_a·N_b, or N_a(N_a − 1).
    pub(crate) fn ordered(self, species: &SpeciesTable) -> f64 {
        let (a, b) = (species.count(self.a) as f64, species.count(self.b) as f64);
        if self.a == self.b { a * (a - 1.0) } else { a * b }
    }

    /// What names of results end with: `_A_B`.
    pub(crate) fn suffix(self, species: &SpeciesTable) -> String {
        format!("_{}_{}", species.name(self.a), species.name(self.b))
    }
}

impl Part for SpeciesPair {
    fn section(&self) -> String {
        format!("species_{}_{}", self.a, self.b)
    }
}
