//! The equations A·λ = r of the bonds of one molecule, for molecules of any shape.

use crate::sparse::Ldlt;
use crate::topology::{MOST_BONDS, MOST_BONDS_BY_HAND, Topology};
use crate::{DVec3, Masses};

/// The symmetric matrix A = G·M⁻¹·Gᵀ of one molecule with its factors; memory for all molecules of a topology is taken once.
///
/// A chain is tridiagonal, and up to three bonds are factored by formulas. All others are factored by sparse L·D·Lᵀ, whose
/// pattern was analysed when the topology was made.
#[derive(Debug)]
pub struct BondEquations {
    matrix: Matrix,
}

#[derive(Debug)]
enum Matrix {
    Chain(Box<Tridiagonal>),
    Few(Few),
    Sparse(Box<Ldlt>),
}

impl BondEquations {
    /// Room for the molecules of a topology.
    #[must_use]
    pub fn new(topology: &Topology) -> Self {
        let matrix = match topology.pattern() {
            _ if topology.is_chain() => Matrix::Chain(Box::new(Tridiagonal::ZERO)),
            None => Matrix::Few(Few::default()),
            Some(pattern) => Matrix::Sparse(Box::new(Ldlt::new(pattern))),
        };
        Self { matrix }
    }

    /// Writes A + `sigma` of the molecule whose first site is particle `first`, with bond vectors `bonds`, and factors it.
    ///
    /// # Errors
    /// The bond whose pivot is not positive: with `sigma` = 0 it follows from the others, or is not finite.
    ///
    /// # Panics
    /// Where the topology is another than the equations were made for: that is a bug of the caller.
    pub fn factor(
        &mut self,
        topology: &Topology,
        masses: &Masses,
        first: usize,
        bonds: &[DVec3],
        sigma: f64,
    ) -> Result<(), usize> {
        if let Matrix::Chain(matrix) = &mut self.matrix {
            matrix.set(masses, first, bonds, bonds);
            if sigma > 0.0 {
                matrix.add_to_diagonal(bonds.len(), sigma);
            }
            return matrix.factor(bonds.len());
        }
        let inverse = |site: usize| 1.0 / masses.of(first + site);
        let diagonal = topology.bonds().iter().zip(bonds).map(|(bond, d)| {
            let [i, j] = bond.sites;
            (inverse(i) + inverse(j)) * d.length_squared() + sigma
        });
        let couplings = topology.couplings();
        let beside = couplings.iter().map(|coupling| {
            let [c, d] = coupling.bonds;
            coupling.sign * bonds[c].dot(bonds[d]) * inverse(coupling.site)
        });
        match &mut self.matrix {
            Matrix::Chain(_) => unreachable!("chains were solved above"),
            Matrix::Few(matrix) => {
                *matrix = Few::default();
                for (c, element) in diagonal.enumerate() {
                    matrix.a[c][c] = element;
                }
                for (coupling, element) in couplings.iter().zip(beside) {
                    let [c, d] = coupling.bonds;
                    matrix.a[d][c] = element;
                }
                matrix.factor()
            }
            Matrix::Sparse(matrix) => {
                let pattern = topology.pattern().expect("it was made for this topology");
                for (c, element) in diagonal.enumerate() {
                    matrix.set_diagonal(pattern, c, element);
                }
                for (k, element) in beside.enumerate() {
                    matrix.set_coupling(pattern, k, element);
                }
                matrix.factor(pattern)
            }
        }
    }

    /// Solves the factored equations in place, for one number per bond.
    ///
    /// # Panics
    /// As [`BondEquations::factor`].
    pub fn solve(&mut self, topology: &Topology, right: &mut [f64]) {
        match &mut self.matrix {
            Matrix::Chain(matrix) => matrix.solve(right),
            Matrix::Few(matrix) => matrix.solve(right),
            Matrix::Sparse(matrix) => {
                let pattern = topology.pattern().expect("it was made for this topology");
                matrix.solve(pattern, right);
            }
        }
    }
}

/// A symmetric matrix of up to three unknowns; rows that are not used are rows of the unit matrix.
///
/// The lower triangle holds A, and L with the pivots afterwards.
#[derive(Debug, Clone)]
struct Few {
    a: [[f64; MOST_BONDS_BY_HAND]; MOST_BONDS_BY_HAND],
}

impl Default for Few {
    fn default() -> Self {
        Self { a: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }
}

impl Few {
    fn factor(&mut self) -> Result<(), usize> {
        let a = &mut self.a;
        let (b, c) = (a[1][0], a[2][0]);
        a[1][0] /= a[0][0];
        a[2][0] /= a[0][0];
        a[1][1] -= a[1][0] * b;
        a[2][1] = (a[2][1] - a[2][0] * b) / a[1][1];
        a[2][2] -= a[2][0] * c + a[2][1] * a[2][1] * a[1][1];
        match (0..3).find(|k| a[*k][*k].is_nan() || a[*k][*k] <= 0.0) {
            Some(k) => Err(k),
            None => Ok(()),
        }
    }

    fn solve(&self, right: &mut [f64]) {
        let a = &self.a;
        let mut x = [0.0; 3];
        x[..right.len()].copy_from_slice(right);
        x[1] -= a[1][0] * x[0];
        x[2] -= a[2][0] * x[0] + a[2][1] * x[1];
        x[2] /= a[2][2];
        x[1] = x[1] / a[1][1] - a[2][1] * x[2];
        x[0] = x[0] / a[0][0] - a[1][0] * x[1] - a[2][0] * x[2];
        right.copy_from_slice(&x[..right.len()]);
    }
}

// The equations of a chain: tridiagonal, one row per bond.

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

#[cfg(test)]
mod tests {
    use crate::topology::Bond;

    use super::*;

    fn topology(sites: usize, pairs: &[[usize; 2]]) -> Topology {
        let bond = |sites: &[usize; 2]| Bond { sites: *sites, length: 1.0 };
        Topology::new(sites, pairs.iter().map(bond).collect()).unwrap()
    }

    /// (A + σ)·x by the definition A = G·M⁻¹·Gᵀ, with the rows of G written out.
    fn product(topology: &Topology, m: &[f64], d: &[DVec3], sigma: f64, x: &[f64]) -> Vec<f64> {
        let mut on_sites = vec![DVec3::ZERO; m.len()];
        for ((bond, d), x) in topology.bonds().iter().zip(d).zip(x) {
            on_sites[bond.sites[0]] -= *x * *d;
            on_sites[bond.sites[1]] += *x * *d;
        }
        let bonds = topology.bonds().iter().zip(d).zip(x);
        bonds
            .map(|((bond, d), x)| {
                let [i, j] = bond.sites;
                d.dot(on_sites[j] / m[j] - on_sites[i] / m[i]) + sigma * x
            })
            .collect()
    }

    /// Every kind of matrix solves the equations of its molecule: chains, up to three bonds, and sparse ones.
    #[test]
    fn every_kind_of_matrix_solves_the_equations_that_it_stands_for() {
        let shapes: [(usize, &[[usize; 2]]); 7] = [
            (2, &[[0, 1]]),
            (5, &[[0, 1], [1, 2], [2, 3], [3, 4]]),
            (3, &[[1, 0], [1, 2]]),
            (3, &[[0, 1], [1, 2], [2, 0]]),
            (4, &[[0, 1], [0, 2], [3, 0]]),
            (6, &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]]),
            (7, &[[0, 1], [1, 2], [2, 0], [2, 3], [4, 3], [3, 5], [6, 5], [4, 6]]),
        ];
        for (sites, pairs) in shapes {
            let topology = topology(sites, pairs);
            let m: Vec<f64> = (0..sites).map(|i| 1.0 + 0.3 * i as f64).collect();
            let x: Vec<DVec3> = (0..sites)
                .map(|i| {
                    let t = i as f64;
                    DVec3::new((2.1 * t).sin(), (1.3 * t).cos(), 0.2 * t)
                })
                .collect();
            let d: Vec<DVec3> = topology.bonds().iter().map(|b| b.vector(&x)).collect();
            let masses = Masses::Each(m.clone());
            for sigma in [0.0, 0.7] {
                let mut equations = BondEquations::new(&topology);
                equations.factor(&topology, &masses, 0, &d, sigma).unwrap();
                let wanted: Vec<f64> = (0..d.len()).map(|c| 1.0 - 0.4 * c as f64).collect();
                let mut found = product(&topology, &m, &d, sigma, &wanted);
                equations.solve(&topology, &mut found);
                for (found, wanted) in found.iter().zip(&wanted) {
                    assert!((found - wanted).abs() < 1e-12, "{pairs:?}: {found}, {wanted}");
                }
            }
        }
    }
}
