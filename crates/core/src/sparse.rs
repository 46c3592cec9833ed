//! Sparse symmetric positive definite systems A·x = b, of which many have one pattern: A = L·D·Lᵀ.
//!
//! The pattern is analysed once. It gives an order of elimination with little fill, the elements of L below the diagonal,
//! and the element that each product of two elements changes. A matrix of that pattern is then factored without a search
//! and without memory. Molecules have at most some dozens of unknowns, which a library for large matrices does not serve better.

use std::collections::BTreeSet;
use std::ops::Range;

/// Where the elements of a symmetric matrix are that may differ from zero, and how it is eliminated.
#[derive(Debug)]
pub struct Pattern {
    /// The unknown that is eliminated at each place.
    unknown_at: Vec<usize>,
    /// The first element of each column of L below the diagonal; the last entry is the end of the last column.
    starts: Vec<usize>,
    /// The row of each element of L, by column and ascending.
    rows: Vec<usize>,
    /// The value that each diagonal element, and then each coupling, has among the values of a matrix.
    slots: Vec<usize>,
    /// The value that changes with each product of two elements of a column, in the order of [`Ldlt::factor`].
    targets: Vec<usize>,
}

impl Pattern {
    /// Analyses a matrix of `n` unknowns whose elements off the diagonal are at `couplings`, each pair once, in any order.
    ///
    /// The unknown with the fewest couplings is eliminated first (minimum degree), the first of equals.
    ///
    /// # Panics
    /// Where a coupling names an unknown that there is not, or twice the same: that is a bug of the caller.
    #[must_use]
    pub fn new(n: usize, couplings: &[(usize, usize)]) -> Self {
        let mut coupled = vec![BTreeSet::new(); n];
        for (i, j) in couplings {
            assert!(i != j, "a coupling joins two unknowns");
            assert!(coupled[*i].insert(*j) && coupled[*j].insert(*i), "a coupling stands once");
        }
        let (mut unknown_at, mut place_of) = (Vec::with_capacity(n), vec![None; n]);
        let mut columns = Vec::with_capacity(n);
        for place in 0..n {
            let left = (0..n).filter(|i| place_of[*i].is_none());
            let next = left.min_by_key(|i| coupled[*i].len()).expect("a place for each unknown");
            let column = std::mem::take(&mut coupled[next]);
            for i in &column {
                coupled[*i].remove(&next);
                coupled[*i].extend(column.iter().filter(|j| *j != i));
            }
            place_of[next] = Some(place);
            unknown_at.push(next);
            columns.push(column);
        }
        let place_of: Vec<usize> = place_of.into_iter().flatten().collect();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in columns {
            let mut places: Vec<usize> = column.into_iter().map(|i| place_of[i]).collect();
            places.sort_unstable();
            rows.extend(places);
            starts.push(rows.len());
        }
        let mut pattern = Self { unknown_at, starts, rows, slots: Vec::new(), targets: Vec::new() };
        let diagonal = place_of.iter().copied();
        let beside = couplings.iter().map(|(i, j)| pattern.value(place_of[*i], place_of[*j]));
        pattern.slots = diagonal.chain(beside).collect();
        pattern.targets = (0..n).flat_map(|place| pattern.targets_of(place)).collect();
        pattern
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknown_at.len()
    }

    /// The elements of a column of L, as numbers of elements.
    fn column(&self, place: usize) -> Range<usize> {
        self.starts[place]..self.starts[place + 1]
    }

    /// The value of the element in the rows and columns of two places: values of the diagonal come first.
    fn value(&self, a: usize, b: usize) -> usize {
        if a == b {
            return a;
        }
        let element = self.column(a.min(b)).find(|element| self.rows[*element] == a.max(b));
        self.unknowns() + element.expect("an element of the pattern, or fill")
    }

    fn targets_of(&self, place: usize) -> Vec<usize> {
        let column = self.column(place);
        let pairs = column.clone().flat_map(|b| (b..column.end).map(move |a| (a, b)));
        pairs.map(|(a, b)| self.value(self.rows[a], self.rows[b])).collect()
    }
}

/// One matrix of a pattern with its factors; memory for all that it does is taken once.
#[derive(Debug)]
pub struct Ldlt {
    /// The diagonal of A, and then its elements below; zero where elimination fills.
    values: Vec<f64>,
    /// D, and then L, in the same order.
    factors: Vec<f64>,
    right: Vec<f64>,
}

impl Ldlt {
    /// Room for matrices of a pattern.
    #[must_use]
    pub fn new(pattern: &Pattern) -> Self {
        let n = pattern.unknowns();
        let values = vec![0.0; n + pattern.rows.len()];
        Self { factors: values.clone(), values, right: vec![0.0; n] }
    }

    /// Writes the element of the diagonal of unknown `i`.
    #[inline]
    pub fn set_diagonal(&mut self, pattern: &Pattern, i: usize, value: f64) {
        self.values[pattern.slots[i]] = value;
    }

    /// Writes the element of coupling `k`, in the order in which the pattern was given them.
    #[inline]
    pub fn set_coupling(&mut self, pattern: &Pattern, k: usize, value: f64) {
        self.values[pattern.slots[pattern.unknowns() + k]] = value;
    }

    /// Factors the matrix.
    ///
    /// # Errors
    /// The unknown whose pivot is not positive: the matrix is not positive definite.
    pub fn factor(&mut self, pattern: &Pattern) -> Result<(), usize> {
        let n = pattern.unknowns();
        self.factors.copy_from_slice(&self.values);
        let mut targets = pattern.targets.iter();
        for place in 0..n {
            let pivot = self.factors[place];
            // NaN is not positive.
            if !matches!(pivot.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)) {
                return Err(pattern.unknown_at[place]);
            }
            let column = pattern.column(place);
            for b in column.clone() {
                let scaled = self.factors[n + b] / pivot;
                for (a, target) in (b..column.end).zip(&mut targets) {
                    self.factors[*target] -= self.factors[n + a] * scaled;
                }
                self.factors[n + b] = scaled;
            }
        }
        Ok(())
    }

    /// Solves A·x = `right` in place with the factors.
    ///
    /// # Panics
    /// Where `right` has another length than the matrix: that is a bug of the caller.
    pub fn solve(&mut self, pattern: &Pattern, right: &mut [f64]) {
        let (n, x) = (pattern.unknowns(), &mut self.right);
        for (own, unknown) in x.iter_mut().zip(&pattern.unknown_at) {
            *own = right[*unknown];
        }
        for place in 0..n {
            for element in pattern.column(place) {
                x[pattern.rows[element]] -= self.factors[n + element] * x[place];
            }
        }
        for place in (0..n).rev() {
            x[place] /= self.factors[place];
            for element in pattern.column(place) {
                x[place] -= self.factors[n + element] * x[pattern.rows[element]];
            }
        }
        for (own, unknown) in x.iter().zip(&pattern.unknown_at) {
            right[*unknown] = *own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A·x by hand.
    fn product(
        diagonal: &[f64],
        couplings: &[(usize, usize)],
        values: &[f64],
        x: &[f64],
    ) -> Vec<f64> {
        let mut y: Vec<f64> = diagonal.iter().zip(x).map(|(a, x)| a * x).collect();
        for ((i, j), a) in couplings.iter().zip(values) {
            y[*i] += a * x[*j];
            y[*j] += a * x[*i];
        }
        y
    }

    #[test]
    fn a_ring_with_a_branch_is_solved_to_round_off_again_and_again() {
        let couplings = [(0, 1), (2, 1), (2, 3), (3, 4), (0, 4), (5, 2), (5, 3)];
        let pattern = Pattern::new(6, &couplings);
        let mut ldlt = Ldlt::new(&pattern);
        for round in 0..3 {
            let diagonal: Vec<f64> = (0..6).map(|i| 3.0 + f64::from(i + round)).collect();
            let values: Vec<f64> = (0..7).map(|k| 0.7 - 0.3 * f64::from(k)).collect();
            for (i, a) in diagonal.iter().enumerate() {
                ldlt.set_diagonal(&pattern, i, *a);
            }
            for (k, a) in values.iter().enumerate() {
                ldlt.set_coupling(&pattern, k, *a);
            }
            ldlt.factor(&pattern).unwrap();
            let wanted: Vec<f64> = (0..6).map(|i| f64::from(i) - 2.5).collect();
            let mut x = product(&diagonal, &couplings, &values, &wanted);
            ldlt.solve(&pattern, &mut x);
            for (x, wanted) in x.iter().zip(&wanted) {
                assert!((x - wanted).abs() < 1e-13, "{x} and {wanted}");
            }
        }
    }

    #[test]
    fn a_tree_is_eliminated_without_fill_and_a_ring_with_little() {
        let branched = [(0, 1), (1, 2), (1, 3), (3, 4), (4, 5)];
        assert_eq!(Pattern::new(6, &branched).rows.len(), 5);
        let ring: Vec<(usize, usize)> = (0..8).map(|i| (i, (i + 1) % 8)).collect();
        assert_eq!(Pattern::new(8, &ring).rows.len(), 13);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let pattern = Pattern::new(3, &[(0, 1), (1, 2), (0, 2)]);
        let mut ldlt = Ldlt::new(&pattern);
        for i in 0..3 {
            ldlt.set_diagonal(&pattern, i, 1.0);
            ldlt.set_coupling(&pattern, i, 2.0);
        }
        assert!(ldlt.factor(&pattern).is_err());
        ldlt.set_diagonal(&pattern, 1, f64::NAN);
        assert!(ldlt.factor(&pattern).is_err());
    }
}
