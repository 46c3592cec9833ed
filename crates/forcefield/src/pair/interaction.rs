//! What two particles do to each other, as a loop over pairs of particles sums it.

use super::laws::Laws;
use super::{Pair, PairForm};

/// The interaction of particles: one truncated potential, or one for each pair of species.
pub trait Interaction: Copy + Send + Sync {
    /// The values of particles `i` and `j` at r² = `r2` σ², ε; none beyond the cutoff of a pair of species.
    ///
    /// The loop itself compares r² with the largest cutoff.
    fn between(&self, i: usize, j: usize, r2: f64) -> Option<Pair<f64>>;

    /// What the conserved energy subtracts for a pair, ε; 0 where it counts pairs instead.
    fn energy_at_cutoff(&self, i: usize, j: usize) -> f64;
}

/// One truncated potential for all pairs.
#[derive(Clone, Copy)]
pub struct OneSpecies<F>(pub F);

impl<F: PairForm> Interaction for OneSpecies<F> {
    #[inline(always)]
    fn between(&self, _i: usize, _j: usize, r2: f64) -> Option<Pair<f64>> {
        Some(self.0.eval_in_epsilon(r2))
    }

    #[inline(always)]
    fn energy_at_cutoff(&self, _i: usize, _j: usize) -> f64 {
        0.0
    }
}

/// One truncated potential for each pair of species.
#[derive(Clone, Copy)]
pub struct ManySpecies<'a, F> {
    /// The formula.
    pub form: F,
    /// The numbers of each pair.
    pub laws: &'a Laws,
}

impl<F: PairForm> Interaction for ManySpecies<'_, F> {
    #[inline(always)]
    fn between(&self, i: usize, j: usize, r2: f64) -> Option<Pair<f64>> {
        let law = self.laws.between(i, j);
        (r2 <= law.r_cut2).then(|| law.eval(&self.form, r2).in_epsilon(F::UNIT))
    }

    #[inline(always)]
    fn energy_at_cutoff(&self, i: usize, j: usize) -> f64 {
        self.laws.between(i, j).energy_at_cutoff
    }
}
