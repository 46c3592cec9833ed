//! How unevenly the weights of trial particles are spread.

use crate::Table;
use lennard_core::persist;

/// Logarithms of the smallest and of the largest weight that are told apart.
const LOWEST: f64 = -40.0;
const HIGHEST: f64 = 60.0;
/// Bins of equal width between them.
const BINS: usize = 1000;

/// The weights e^{−ΔU/T} of all trial particles, in bins of their logarithm.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    counts: Box<[u64]>,
    sums: Box<[f64]>,
    squares: f64,
}

impl Weights {
    pub(super) fn new() -> Self {
        Self { counts: [0; BINS].into(), sums: [0.0; BINS].into(), squares: 0.0 }
    }

    /// Counts a weight by its logarithm and its value.
    pub(super) fn add(&mut self, log_weight: f64, weight: f64) {
        let per_bin = BINS as f64 / (HIGHEST - LOWEST);
        // A cast takes −∞ to the first bin.
        let bin = ((log_weight - LOWEST) * per_bin) as usize;
        let bin = bin.min(BINS - 1);
        self.counts[bin] += 1;
        self.sums[bin] += weight;
        self.squares += weight * weight;
    }

    /// Number of trial particles.
    pub(super) fn insertions(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The share of the sum of all weights that the heaviest 1 % of the trial particles give.
    pub(super) fn share_of_best(&self) -> f64 {
        let mut left = 0.01 * self.insertions() as f64;
        let mut sum = 0.0;
        for (count, weight) in self.counts.iter().zip(&self.sums).rev() {
            if *count == 0 {
                continue;
            }
            let taken = left.min(*count as f64);
            sum += weight * taken / *count as f64;
            left -= taken;
            if left <= 0.0 {
                break;
            }
        }
        sum / self.sums.iter().sum::<f64>()
    }

    /// How many trial particles of equal weight would have the same relative error, (Σw)²/Σw² (L. Kish, Survey Sampling,
    /// 1965): few where the sum is carried by few.
    pub(super) fn carriers(&self) -> f64 {
        let sum: f64 = self.sums.iter().sum();
        if sum == 0.0 {
            return 0.0;
        }
        sum * sum / self.squares
    }

    /// The shares of trial particles and of the sum in each bin that has any.
    pub(super) fn table(&self, suffix: &str) -> Table {
        let width = (HIGHEST - LOWEST) / BINS as f64;
        let (all, sum) = (self.insertions() as f64, self.sums.iter().sum::<f64>());
        let filled: Vec<usize> = (0..BINS).filter(|k| self.counts[*k] > 0).collect();
        let column = |of: &dyn Fn(usize) -> f64| filled.iter().map(|k| of(*k)).collect();
        Table::new(
            format!("insertions{suffix}"),
            "trial particles by ln w = −ΔU/T in the middle of a bin, and what they give to the sum of w; the first bin \
             has all that are lighter",
        )
        .with("ln_weight", "", column(&|k| LOWEST + (k as f64 + 0.5) * width))
        .with("insertions", "", column(&|k| self.counts[k] as f64 / all))
        .with("sum", "", column(&|k| self.sums[k] / sum))
    }
}

persist!(Weights { counts, sums, squares });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_weights_are_carried_by_all_and_one_giant_by_one() {
        let mut weights = Weights::new();
        for _ in 0..1000 {
            weights.add(0.0, 1.0);
        }
        assert!((weights.share_of_best() - 0.01).abs() < 1e-12);
        assert!((weights.carriers() - 1000.0).abs() < 1e-9);
        weights.add(30.0, 1e13);
        assert!((weights.share_of_best() - 1.0).abs() < 1e-6);
        assert!((weights.carriers() - 1.0).abs() < 1e-6);
        weights.add(f64::NEG_INFINITY, 0.0);
        assert_eq!(weights.insertions(), 1002);
        assert_eq!(weights.table("").rows(), 3);
    }
}
