//! The masses of particles.

use glam::DVec3;

use crate::Team;
use crate::exact::{exact_sum_of, exact_sum_over};
use crate::species::SpeciesTable;

/// The masses of the particles. A held particle, which never moves, has an infinite mass.
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

    /// The kinetic energy ½ m v² of particle `i`, ε.
    #[inline]
    #[must_use]
    pub fn kinetic_energy_of(&self, i: usize, velocity: DVec3) -> f64 {
        0.5 * self.moving(i) * velocity.length_squared()
    }

    /// The kinetic energy K = Σ ½ m v² in ε, an exact total.
    #[must_use]
    pub fn kinetic_energy(&self, velocities: &[DVec3]) -> f64 {
        self.kinetic_energy_over(None, velocities)
    }

    /// As [`Masses::kinetic_energy`], where all masses are equal and each rank of a team has some of the velocities.
    #[must_use]
    pub fn kinetic_energy_over(&self, team: Option<&Team>, velocities: &[DVec3]) -> f64 {
        match self {
            Self::Uniform(m) => exact_sum_of(team, velocities, |v| 0.5 * m * v.length_squared()),
            Self::Each(_) => {
                exact_sum_over(team, velocities.len(), |i| self.kinetic_energy_of(i, velocities[i]))
            }
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
