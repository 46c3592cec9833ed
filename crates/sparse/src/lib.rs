//! Sparse symmetric positive definite systems A·x = b, of which many have one pattern.
//!
//! The pattern is analysed once: an order of elimination with little fill (approximate minimum degree), and the places of
//! the elements of L. Each matrix of that pattern is then factored as A = L·D·Lᵀ without a search and without memory.
//! The work is done by the library faer, which this crate alone knows.

use std::fmt;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::prelude::Reborrow;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::simplicial::{
    SimplicialLdltRef, SymbolicSimplicialCholesky, factorize_simplicial_numeric_ldlt,
    factorize_simplicial_numeric_ldlt_scratch, factorize_simplicial_symbolic_cholesky,
    factorize_simplicial_symbolic_cholesky_scratch, prefactorize_symbolic_cholesky,
    prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};

/// Where the elements of a symmetric matrix are that may differ from zero, and how it is eliminated.
pub struct Pattern {
    /// The upper triangle in the order of elimination.
    upper: SymbolicSparseColMat<usize>,
    symbolic: SymbolicSimplicialCholesky<usize>,
    /// The unknown that is eliminated at each place.
    unknown_at: Vec<usize>,
    /// The slot of each diagonal element, and then of each coupling, among the values of `upper`.
    slots: Vec<usize>,
}

impl fmt::Debug for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pattern")
            .field("unknowns", &self.unknown_at.len())
            .field("order", &self.unknown_at)
            .finish_non_exhaustive()
    }
}

/// A stack of scratch memory: faer takes all that it needs from there.
fn memory(of: StackReq) -> MemBuffer {
    MemBuffer::new(of)
}

impl Pattern {
    /// Analyses a matrix of `n` unknowns whose elements off the diagonal are at `couplings`, each pair once, in any order.
    ///
    /// # Panics
    /// Where a coupling names an unknown that there is not, or twice the same: that is a bug of the caller.
    #[must_use]
    pub fn new(n: usize, couplings: &[(usize, usize)]) -> Self {
        let in_order: Vec<usize> = (0..n).collect();
        let (plain, _) = upper_triangle(n, couplings, &in_order);
        let (mut order, mut place_of) = (vec![0; n], vec![0; n]);
        let mut scratch = memory(amd::order_scratch::<usize>(n, n + couplings.len()));
        amd::order(
            &mut order,
            &mut place_of,
            plain.rb(),
            amd::Control::default(),
            MemStack::new(&mut scratch),
        )
        .expect("a pattern of this size fits into memory");
        let (upper, slots) = upper_triangle(n, couplings, &place_of);
        let symbolic = analyse(&upper, n);
        Self { upper, symbolic, unknown_at: order, slots }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknown_at.len()
    }
}

/// The upper triangle of the pattern with unknowns at their places, and the slot of each diagonal element and coupling.
fn upper_triangle(
    n: usize,
    couplings: &[(usize, usize)],
    place_of: &[usize],
) -> (SymbolicSparseColMat<usize>, Vec<usize>) {
    let on_diagonal = (0..n).map(|i| (place_of[i], place_of[i]));
    let beside = couplings.iter().map(|(i, j)| {
        assert!(i != j, "a coupling joins two unknowns");
        let (a, b) = (place_of[*i], place_of[*j]);
        (a.min(b), a.max(b))
    });
    let elements: Vec<(usize, usize)> = on_diagonal.chain(beside).collect();
    let mut sorted: Vec<usize> = (0..elements.len()).collect();
    sorted.sort_by_key(|k| (elements[*k].1, elements[*k].0));
    let mut slots = vec![0; elements.len()];
    let mut starts = vec![0; n + 1];
    for (slot, k) in sorted.iter().enumerate() {
        slots[*k] = slot;
        starts[elements[*k].1 + 1] += 1;
    }
    for column in 0..n {
        starts[column + 1] += starts[column];
    }
    let rows = sorted.iter().map(|k| elements[*k].0).collect();
    let upper = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
    (upper, slots)
}

fn analyse(upper: &SymbolicSparseColMat<usize>, n: usize) -> SymbolicSimplicialCholesky<usize> {
    let elements = upper.row_idx().len();
    let mut scratch = memory(StackReq::any_of(&[
        prefactorize_symbolic_cholesky_scratch::<usize>(n, elements),
        factorize_simplicial_symbolic_cholesky_scratch::<usize>(n),
    ]));
    let stack = MemStack::new(&mut scratch);
    let (mut tree, mut counts) = (vec![0_isize; n], vec![0; n]);
    let tree = prefactorize_symbolic_cholesky(&mut tree, &mut counts, upper.rb(), stack);
    factorize_simplicial_symbolic_cholesky(upper.rb(), tree, &counts, stack)
        .expect("a pattern of this size fits into memory")
}

/// One matrix of a pattern with its factors; memory for all that it does is taken once.
pub struct Ldlt {
    values: Vec<f64>,
    factors: Vec<f64>,
    right: Vec<f64>,
    scratch: MemBuffer,
}

impl fmt::Debug for Ldlt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ldlt").field("values", &self.values).finish_non_exhaustive()
    }
}

impl Ldlt {
    /// Room for matrices of a pattern.
    #[must_use]
    pub fn new(pattern: &Pattern) -> Self {
        let n = pattern.unknowns();
        Self {
            values: vec![0.0; pattern.slots.len()],
            factors: vec![0.0; pattern.symbolic.len_val()],
            right: vec![0.0; n],
            scratch: memory(StackReq::any_of(&[
                factorize_simplicial_numeric_ldlt_scratch::<usize, f64>(n),
                pattern.symbolic.solve_in_place_scratch::<f64>(1),
            ])),
        }
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
        let matrix = SparseColMatRef::new(pattern.upper.rb(), &self.values);
        let done = factorize_simplicial_numeric_ldlt(
            &mut self.factors,
            matrix,
            LdltRegularization::default(),
            &pattern.symbolic,
            MemStack::new(&mut self.scratch),
        );
        let starts = &pattern.symbolic.col_ptr()[..pattern.unknowns()];
        // A pivot that is no number is not positive either; a factorisation that ended early left the old pivots behind.
        let bad = starts.iter().position(|at| {
            let pivot = self.factors[*at];
            pivot.is_nan() || pivot <= 0.0
        });
        match (bad, done) {
            (Some(place), _) => Err(pattern.unknown_at[place]),
            (None, Err(_)) => Err(pattern.unknown_at[0]),
            (None, Ok(_)) => Ok(()),
        }
    }

    /// Solves A·x = `right` in place with the factors.
    ///
    /// # Panics
    /// Where `right` has another length than the matrix: that is a bug of the caller.
    pub fn solve(&mut self, pattern: &Pattern, right: &mut [f64]) {
        for (own, unknown) in self.right.iter_mut().zip(&pattern.unknown_at) {
            *own = right[*unknown];
        }
        let n = pattern.unknowns();
        SimplicialLdltRef::new(&pattern.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.right, n, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        for (own, unknown) in self.right.iter().zip(&pattern.unknown_at) {
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
