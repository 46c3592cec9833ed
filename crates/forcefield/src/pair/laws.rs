//! From a mixture and options to the truncated potentials of all pairs of species.

use lennard_core::MOST_SPECIES;

use super::{Form, Mixture, Model, Pair, PotentialOptions, SpeciesPair, TruncationOptions};
use crate::error::ForceFieldError;

/// The numbers of one pair of species, for u_ab(r) = ε·f(r/σ) with the f of a form in units of σ = σ_ab and ε = ε_ab.
#[derive(Clone, Copy, Debug)]
pub struct PairLaw {
    /// The cutoff r_cut, σ.
    pub r_cut: f64,
    /// σ_ab², σ².
    pub sigma2: f64,
    /// 1/σ_ab², σ⁻².
    pub inv_sigma2: f64,
    /// ε_ab, ε.
    pub epsilon: f64,
    /// ε_ab/σ_ab², ε/σ²: the unit of −U′/r and of U″.
    pub stiffness: f64,
    /// The form, at the cutoff r_cut/σ_ab.
    pub form: Form,
    /// U(r_cut), ε: what the conserved energy subtracts for each pair.
    pub energy_at_cutoff: f64,
}

impl PairLaw {
    /// No interaction.
    fn nothing(form: Form) -> Self {
        Self {
            r_cut: 0.0,
            sigma2: 1.0,
            inv_sigma2: 1.0,
            epsilon: 0.0,
            stiffness: 0.0,
            form,
            energy_at_cutoff: 0.0,
        }
    }

    /// The values of the pair at r² = `r2` σ² ≤ r_cut², ε.
    pub fn eval(&self, r2: f64) -> Pair<f64> {
        let pair = self.form.eval(r2 * self.inv_sigma2);
        Pair {
            energy: self.epsilon * pair.energy,
            force: self.stiffness * pair.force,
            curvature: self.stiffness * pair.curvature,
        }
    }
}

/// The truncated potentials of all pairs of species.
#[derive(Clone, Debug)]
pub struct Laws {
    /// The species of the particles.
    pub mixture: Mixture,
    /// The numbers of each pair of species.
    pub of_pairs: [[PairLaw; MOST_SPECIES]; MOST_SPECIES],
}

impl Laws {
    /// The potentials that options describe, for the pairs of a mixture.
    ///
    /// # Errors
    /// [`ForceFieldError`] where potential and truncation do not go together or are out of range, with the pair.
    pub fn new(
        potential: &PotentialOptions,
        truncation: &TruncationOptions,
        mixture: &Mixture,
    ) -> Result<Self, ForceFieldError> {
        let first = in_own_units(potential, truncation, mixture.pair(0, 0), [0; 2])?;
        let mut laws = Self {
            mixture: mixture.clone(),
            of_pairs: [[PairLaw::nothing(first.form); MOST_SPECIES]; MOST_SPECIES],
        };
        for a in 0..mixture.species() {
            for b in 0..mixture.species() {
                let pair = mixture.pair(a, b);
                let model = in_own_units(potential, truncation, pair, [a, b])?;
                let r_cut = model.r_cut * pair.sigma;
                // A product with the inverse of σ rounds. The cutoff of the scene stays what it is.
                let r_cut = if potential.own_end().is_some() { r_cut } else { pair.r_cut };
                let sigma2 = pair.sigma * pair.sigma;
                laws.of_pairs[a][b] = PairLaw {
                    r_cut,
                    sigma2,
                    inv_sigma2: 1.0 / sigma2,
                    epsilon: pair.epsilon,
                    stiffness: pair.epsilon / sigma2,
                    form: model.form,
                    energy_at_cutoff: pair.epsilon * model.energy_at_cutoff,
                };
            }
        }
        Ok(laws)
    }

    /// The cutoffs of all pairs of species, σ.
    pub fn cutoffs(&self) -> impl Iterator<Item = f64> {
        let species = self.mixture.species();
        self.of_pairs[..species].iter().flat_map(move |row| &row[..species]).map(|law| law.r_cut)
    }

    /// The law of two particles.
    #[inline(always)]
    pub fn between(&self, i: usize, j: usize) -> &PairLaw {
        let of_particle = self.mixture.of_particle();
        let [a, b] = [i, j].map(|i| usize::from(of_particle[i]));
        &self.of_pairs[a][b]
    }
}

/// The truncation of the one fluid that a mixture is where all its pairs have σ = ε = 1 and the same cutoff.
pub fn as_one_fluid(
    truncation: &TruncationOptions,
    mixture: &Mixture,
) -> Option<TruncationOptions> {
    let pair = mixture.alike()?;
    (*pair == SpeciesPair::unit(pair.r_cut)).then(|| truncation.at_cutoff(pair.r_cut))
}

/// The model of a pair in units of its own σ and ε.
fn in_own_units(
    potential: &PotentialOptions,
    truncation: &TruncationOptions,
    pair: &SpeciesPair,
    species: [usize; 2],
) -> Result<Model, ForceFieldError> {
    let own = truncation.at_cutoff(pair.r_cut / pair.sigma);
    Model::new(potential, &own)
        .map_err(|reason| ForceFieldError::OfPair { species, reason: Box::new(reason) })
}
