//! An exact sum whose parts are computed where their terms are: by any thread, while they are in registers or in a cache.

use std::sync::{Mutex, PoisonError};

use super::window::{MOST_TERMS, Window};
use super::{BLOCK, ExactSum, ExactSums};
use crate::Team;

/// Parts whose slices fill no more than one sum of slices.
const PARTS: usize = MOST_TERMS as usize / BLOCK;

/// The slices of the terms of one part, or zeros where they went elsewhere.
#[derive(Debug, Clone, Copy, Default)]
pub struct PartSum([f64; 2]);

/// An exact sum of parts. Its value has the bits of [`super::exact_sum`] over all terms.
///
/// All parts share one window, which the sum before has left. Terms that it does not hold go to a sum that parts take in turns.
#[derive(Debug, Default)]
pub struct SumOfParts {
    window: Window,
    others: Mutex<ExactSum>,
}

impl SumOfParts {
    /// The most terms of a part.
    pub const MOST_TERMS: usize = BLOCK;

    /// Forgets parts that no value was asked for.
    pub fn begin(&mut self) {
        *self.others.get_mut().unwrap_or_else(PoisonError::into_inner) = ExactSum::default();
    }

    /// Sums the terms of a part.
    ///
    /// # Panics
    /// Where there are more than [`SumOfParts::MOST_TERMS`]: that is a bug of the caller.
    #[must_use]
    pub fn part(&self, terms: &[f64]) -> PartSum {
        assert!(terms.len() <= BLOCK, "few terms in a part");
        PartSum(self.window.sums(terms).unwrap_or_else(|| {
            self.others.lock().unwrap_or_else(PoisonError::into_inner).add_block(terms);
            [0.0; 2]
        }))
    }

    /// The sum of all parts since the last value, rounded once; with a team over the parts of all ranks.
    #[must_use]
    pub fn value(&mut self, parts: &[PartSum], team: Option<&Team>) -> f64 {
        let others = self.others.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut sum = std::mem::take(others);
        if sum.window.limit > self.window.limit {
            self.window = sum.window;
        }
        for parts in parts.chunks(PARTS) {
            sum.empty_slices();
            for PartSum([high, low]) in parts {
                sum.slices[0] += high;
                sum.slices[1] += low;
            }
        }
        let sums = ExactSums { sums: [sum], ..ExactSums::default() };
        let [value] = sums.over(team).values();
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::total;
    use super::*;

    #[test]
    fn parts_have_the_sum_of_all_terms_wherever_the_window_lies() {
        let mut sum = SumOfParts::default();
        let mut spilled = Vec::new();
        for (round, scale) in [1.0, 1.0, 1e3, 1e-3, 1e-30, f64::MAX / 1e6].into_iter().enumerate() {
            // More terms of one sign than one sum of slices holds.
            let n = 60_000 - 17 * round;
            let term = |k: usize| scale * (1.5 + ((k + 31 * round) as f64 * 12.9898).sin());
            let mut terms: Vec<f64> = (0..n).map(term).collect();
            // A term far below the others has a rest below the slices.
            terms[round] *= scale * 1e-12;
            let parts: Vec<PartSum> = terms.chunks(BLOCK).map(|part| sum.part(part)).collect();
            spilled.push(parts.iter().filter(|part| part.0 == [0.0; 2]).count());
            let value = sum.value(&parts, None);
            assert_eq!(value.to_bits(), total(&terms).to_bits(), "{round}");
        }
        // All parts of the first round find no window, and one part of the second does not fit.
        assert_eq!(spilled[..2], [938, 1], "{spilled:?}");
        let parts = [sum.part(&[1.0, f64::NAN]), sum.part(&[1.0])];
        assert!(sum.value(&parts, None).is_nan());
        let _ = sum.part(&[f64::INFINITY]);
        sum.begin();
        let parts = [sum.part(&[1.0, 2.0])];
        assert_eq!(sum.value(&parts, None), 3.0);
    }
}
