//! Several species of particles: the parameters of each pair of species, and the species of each particle.

use std::sync::Arc;

use lennard_core::MOST_SPECIES;

use crate::error::ForceFieldError;

/// The parameters of a pair of species: u_ab(r) = ε_ab·f(r/σ_ab) for r ≤ r_cut,ab, with the f of the potential.
///
/// Everything is in the units of the scene, σ and ε.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeciesPair {
    /// σ_ab, σ.
    pub sigma: f64,
    /// ε_ab, ε; 0 where the two species do not see each other.
    pub epsilon: f64,
    /// The cutoff r_cut,ab, σ. It replaces `truncation.r_cut`, and a switch keeps its share of it.
    pub r_cut: f64,
}

impl SpeciesPair {
    /// The pair that a fluid of one species has: σ = ε = 1.
    #[must_use]
    pub fn unit(r_cut: f64) -> Self {
        Self { sigma: 1.0, epsilon: 1.0, r_cut }
    }

    /// The parameter that no pair can have, by name and value.
    fn refused(&self) -> Option<(&'static str, f64)> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.sigma) {
            return Some(("sigma", self.sigma));
        }
        if !(self.epsilon.is_finite() && self.epsilon >= 0.0) {
            return Some(("epsilon", self.epsilon));
        }
        (!positive(self.r_cut)).then_some(("r_cut", self.r_cut))
    }
}

/// Several species of particles. A copy costs nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// Row by row; the table is symmetric.
    pairs: Arc<[SpeciesPair]>,
    of_particle: Arc<[u8]>,
    counts: Arc<[usize]>,
}

impl Mixture {
    /// A mixture of `species` species, numbered from 0, with the parameters `pair(a, b)` for each pair a ≤ b.
    ///
    /// `of_particle` has the species of each particle.
    ///
    /// # Errors
    /// [`ForceFieldError`] where there are too many species, a parameter is out of range, or a particle has no such species.
    pub fn new(
        species: usize,
        pair: impl Fn(usize, usize) -> SpeciesPair,
        of_particle: impl Into<Arc<[u8]>>,
    ) -> Result<Self, ForceFieldError> {
        if !(1..=MOST_SPECIES).contains(&species) {
            return Err(ForceFieldError::NumberOfSpecies(species));
        }
        let of_particle = of_particle.into();
        let mut counts = vec![0; species];
        for (particle, of) in of_particle.iter().enumerate() {
            match counts.get_mut(usize::from(*of)) {
                Some(count) => *count += 1,
                None => {
                    return Err(ForceFieldError::NoSuchSpecies {
                        particle,
                        found: usize::from(*of),
                        species,
                    });
                }
            }
        }
        let all = (0..species * species).map(|k| [k / species, k % species]);
        let pairs: Arc<[SpeciesPair]> = all.map(|[a, b]| pair(a.min(b), a.max(b))).collect();
        for (k, pair) in pairs.iter().enumerate() {
            if let Some((key, found)) = pair.refused() {
                return Err(ForceFieldError::BadSpeciesPair {
                    species: [k / species, k % species],
                    key,
                    found,
                });
            }
        }
        Ok(Self { pairs, of_particle, counts: counts.into() })
    }

    /// Number of species.
    #[must_use]
    pub fn species(&self) -> usize {
        self.counts.len()
    }

    /// The parameters of a pair of species.
    #[must_use]
    pub fn pair(&self, a: usize, b: usize) -> &SpeciesPair {
        &self.pairs[a * self.species() + b]
    }

    /// The species of each particle.
    #[must_use]
    pub fn of_particle(&self) -> &Arc<[u8]> {
        &self.of_particle
    }

    /// Number of particles of each species.
    #[must_use]
    pub fn counts(&self) -> &[usize] {
        &self.counts
    }

    /// Number of particles.
    #[must_use]
    pub fn n_atoms(&self) -> usize {
        self.of_particle.len()
    }

    /// Each ordered pair of species, with the number N_a·N_b of ordered pairs of particles in a homogeneous fluid.
    pub(crate) fn ordered_pairs(&self) -> impl Iterator<Item = (f64, &SpeciesPair)> {
        let n = self.species();
        let counts = move |k: usize| [k / n, k % n].map(|a| self.counts[a] as f64);
        self.pairs.iter().enumerate().map(move |(k, pair)| {
            let [n_a, n_b] = counts(k);
            (n_a * n_b, pair)
        })
    }

    /// The one pair of parameters, where all pairs of species are alike.
    pub(crate) fn alike(&self) -> Option<&SpeciesPair> {
        let first = &self.pairs[0];
        self.pairs.iter().all(|pair| pair == first).then_some(first)
    }
}
