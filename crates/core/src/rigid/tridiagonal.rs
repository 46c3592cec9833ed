//! The equations of a chain: tridiagonal, one row per bond.

use crate::topology::MOST_BONDS;
use crate::{DVec3, Masses};

/// Numbers, one per bond of a chain.
type PerBond = [f64; MOST_BONDS];

/// A tridiagonal matrix, one row per bond of a chain, and its factors afterwards.
#[derive(Debug, Clone)]
pub struct Tridiagonal {
    /// Element `c` is A_c,c−1, and the factor of row c − 1 afterwards; the first has no meaning.
    below: PerBond,
    /// A_cc, and the pivots afterwards.
    diagonal: PerBond,
    /// Element `c` is A_c,c+1; the last has no meaning.
    above: PerBond,
}

impl Tridiagonal {
    /// All numbers zero.
    pub const ZERO: Self =
        Self { below: [0.0; MOST_BONDS], diagonal: [0.0; MOST_BONDS], above: [0.0; MOST_BONDS] };

    /// Writes A = G(`left`)·M⁻¹·G(`right`)ᵀ of a chain whose first site is particle `first`.
    pub fn set(&mut self, masses: &Masses, first: usize, left: &[DVec3], right: &[DVec3]) {
        let inverse = |site: usize| 1.0 / masses.of(first + site);
        for c in 0..left.len() {
            self.diagonal[c] = (inverse(c) + inverse(c + 1)) * left[c].dot(right[c]);
            if c > 0 {
                self.below[c] = -left[c].dot(right[c - 1]) * inverse(c);
                self.above[c - 1] = -left[c - 1].dot(right[c]) * inverse(c);
            }
        }
    }

    /// Adds a number to the first `n` elements of the diagonal.
    pub(super) fn add_to_diagonal(&mut self, n: usize, sigma: f64) {
        for element in &mut self.diagonal[..n] {
            *element += sigma;
        }
    }

    /// Factors the first `n` rows without pivoting.
    ///
    /// # Errors
    /// The row whose pivot is not positive.
    pub fn factor(&mut self, n: usize) -> Result<(), usize> {
        for c in 0..n {
            if c > 0 {
                self.below[c] /= self.diagonal[c - 1];
                self.diagonal[c] -= self.below[c] * self.above[c - 1];
            }
            // A pivot that is no number is not positive either.
            if self.diagonal[c].is_nan() || self.diagonal[c] <= 0.0 {
                return Err(c);
            }
        }
        Ok(())
    }

    /// Solves the factored equations in place; there are as many as `right` has numbers.
    pub fn solve(&self, right: &mut [f64]) {
        let n = right.len();
        for c in 1..n {
            right[c] -= self.below[c] * right[c - 1];
        }
        for c in (0..n).rev() {
            let beyond = if c + 1 < n { self.above[c] * right[c + 1] } else { 0.0 };
            right[c] = (right[c] - beyond) / self.diagonal[c];
        }
    }
}
