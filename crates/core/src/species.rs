//! Species: what the particles of a mixture share, the species of each particle, and masses.

use std::ops::Range;
use std::sync::Arc;

/// The most species of a system: as many as one register of AVX-512 holds doubles.
pub const MOST_SPECIES: usize = 8;

/// What all particles of one species share.
#[derive(Debug, Clone, PartialEq)]
pub struct Species {
    /// Name in scenes and results.
    pub name: String,
    /// Mass m of each particle, in the mass unit of the scene.
    pub mass: f64,
    /// Symbol of the chemical element that stands for the species in files.
    pub element: String,
}

impl Species {
    /// The one species of a system that names none: unit mass.
    #[must_use]
    pub fn unnamed() -> Self {
        Self { name: "A".to_owned(), mass: 1.0, element: "Ar".to_owned() }
    }
}

/// The species of a system, numbered from 0, and the species of each particle. A copy costs nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeciesTable {
    species: Arc<[Species]>,
    /// One for each particle that this process keeps; empty where there is one species.
    of_particle: Arc<[u8]>,
    /// How many particles this process keeps.
    kept: usize,
    counts: Arc<[usize]>,
}

impl SpeciesTable {
    /// `n` particles of one species.
    #[must_use]
    pub fn one(species: Species, n: usize) -> Self {
        Self {
            species: Arc::new([species]),
            of_particle: Arc::new([]),
            kept: n,
            counts: Arc::new([n]),
        }
    }

    /// Several species; `of_particle` has the number of the species of each particle.
    ///
    /// # Panics Where there is no species, where there are more than [`MOST_SPECIES`], or where a particle has an
    /// unknown species. That is a bug of the caller.
    #[must_use]
    pub fn new(species: impl Into<Arc<[Species]>>, of_particle: &[u8]) -> Self {
        let species = species.into();
        assert!((1..=MOST_SPECIES).contains(&species.len()), "1 to {MOST_SPECIES} species");
        let mut counts = vec![0; species.len()];
        for a in of_particle {
            counts[usize::from(*a)] += 1;
        }
        Self {
            of_particle: match species.len() {
                1 => Arc::new([]),
                _ => of_particle.into(),
            },
            species,
            kept: of_particle.len(),
            counts: counts.into(),
        }
    }

    /// The same species with the particles of some numbers alone; the counts are still of all particles.
    #[must_use]
    pub fn keeping(&self, numbers: Range<usize>) -> Self {
        let of_particle = self.of_particle.get(numbers.clone()).unwrap_or_default();
        Self { of_particle: of_particle.into(), kept: numbers.len(), ..self.clone() }
    }

    /// Number of species.
    #[must_use]
    pub fn n_species(&self) -> usize {
        self.species.len()
    }

    /// Number of particles that this process keeps.
    #[must_use]
    pub fn n_kept(&self) -> usize {
        self.kept
    }

    /// Number of particles, on all ranks.
    #[must_use]
    pub fn n_particles(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Whether there are several species.
    #[must_use]
    pub fn is_mixture(&self) -> bool {
        self.species.len() > 1
    }

    /// All species.
    #[must_use]
    pub fn all(&self) -> &[Species] {
        &self.species
    }

    /// Species `a`.
    #[must_use]
    pub fn species(&self, a: usize) -> &Species {
        &self.species[a]
    }

    /// The name of species `a`.
    #[must_use]
    pub fn name(&self, a: usize) -> &str {
        &self.species[a].name
    }

    /// The number of the species with this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.species.iter().position(|s| s.name == name)
    }

    /// The species of particle `i`.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> usize {
        self.of_particle.get(i).map_or(0, |a| usize::from(*a))
    }

    /// The species of each particle, `[N]`; `None` where there is one species.
    #[must_use]
    pub fn of_particles(&self) -> Option<&[u8]> {
        self.is_mixture().then_some(&self.of_particle)
    }

    /// The number N_a of particles of each species.
    #[must_use]
    pub fn counts(&self) -> &[usize] {
        &self.counts
    }

    /// The number N_a of particles of species `a`.
    #[must_use]
    pub fn count(&self, a: usize) -> usize {
        self.counts[a]
    }

    /// The mole fraction x_a = N_a/N of species `a`.
    #[must_use]
    pub fn fraction(&self, a: usize) -> f64 {
        self.count(a) as f64 / self.n_particles() as f64
    }

    /// The particles of species `a` that this process keeps, ascending.
    pub fn particles(&self, a: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.kept).filter(move |i| self.of(*i) == a)
    }

    /// The mean mass Σ x_a·m_a.
    #[must_use]
    pub fn mean_mass(&self) -> f64 {
        let total: f64 =
            (0..self.n_species()).map(|a| self.count(a) as f64 * self.species[a].mass).sum();
        total / self.n_particles() as f64
    }
}

// The masses of particles.

/// The masses of the particles. A held particle, which never moves, has an infinite mass.
#[derive(Debug, Clone, PartialEq)]
pub enum Masses {
    /// All particles have this mass.
    Uniform(f64),
    /// One mass for each particle that this process keeps.
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
        let masses = (0..table.kept).map(|i| table.species(table.of(i)).mass);
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

    /// Whether particle `i` is held: its mass is infinite, so that no force moves it.
    #[inline]
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        self.of(i).is_infinite()
    }

    /// The mass of particle `i` in sums of energy, momentum and weight: 0 for a held particle, which has none of them.
    #[inline]
    #[must_use]
    pub fn moving(&self, i: usize) -> f64 {
        match self {
            Self::Uniform(m) => *m,
            Self::Each(m) if m[i].is_infinite() => 0.0,
            Self::Each(m) => m[i],
        }
    }

    /// The reduced mass m_i·m_j/(m_i + m_j) of two particles, of which one at most is held.
    #[must_use]
    pub fn reduced(&self, i: usize, j: usize) -> f64 {
        (self.of(i).recip() + self.of(j).recip()).recip()
    }

    /// The number of held particles.
    #[must_use]
    pub fn n_held(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Each(m) => m.iter().filter(|m| m.is_infinite()).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, mass: f64) -> Species {
        Species { name: name.to_owned(), mass, ..Species::unnamed() }
    }

    #[test]
    fn counts_fractions_and_particles_follow_from_the_species_of_each_particle() {
        let table = SpeciesTable::new([named("A", 1.0), named("B", 4.0)], &[0, 1, 0, 0]);
        assert!(table.is_mixture());
        assert_eq!((table.n_species(), table.n_particles()), (2, 4));
        assert_eq!(table.counts(), [3, 1]);
        assert_eq!(table.fraction(1), 0.25);
        assert_eq!(table.mean_mass(), 1.75);
        assert_eq!(table.particles(0).collect::<Vec<_>>(), [0, 2, 3]);
        assert_eq!(table.particles(1).collect::<Vec<_>>(), [1]);
        assert_eq!(table.find("B"), Some(1));
        assert_eq!(table.find("C"), None);
        assert_eq!((table.of(1), table.name(table.of(2))), (1, "A"));
        assert_eq!(table.of_particles(), Some(&[0, 1, 0, 0][..]));
    }

    #[test]
    fn one_species_stores_nothing_for_each_particle() {
        let named_so = SpeciesTable::new([named("A", 2.0)], &[0; 5]);
        assert_eq!(named_so, SpeciesTable::one(named("A", 2.0), 5));
        assert!(!named_so.is_mixture());
        assert_eq!(named_so.of_particles(), None);
        assert_eq!((named_so.of(3), named_so.counts()), (0, &[5][..]));
        assert_eq!(named_so.particles(0).count(), 5);
    }
}
