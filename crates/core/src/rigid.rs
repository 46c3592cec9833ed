//! Rigid bonds at one instant: velocities without a part along the bonds, multipliers, and their virial.
//!
//! Notation: bond c joins sites i = c and j = c + 1 of a chain; d = x_j − x_i, w = v_j − v_i, κ = 1/m_i + 1/m_j.
//! The constraint is σ = ½(|d|² − r²) with the row G = (−d at i, +d at j). The force on j is λ·d, with λ in ε/σ².
//! The matrix A = G·M⁻¹·Gᵀ of a chain is tridiagonal: A_cc = κ_c·|d_c|², A_c,c+1 = −d_c·d_c+1/m_shared.

use std::ops::Add;

use crate::molecules::MOST_BONDS;
use crate::parallel::ordered_sum;
use crate::{DMat3, DVec3, Masses, State, System};

/// Numbers, one per bond of a chain.
pub type PerBond = [f64; MOST_BONDS];

/// A tridiagonal system of equations, one row per bond of a chain.
#[derive(Debug, Clone, Copy)]
pub struct Tridiagonal {
    /// Element `c` is A_c,c−1; the first has no meaning.
    pub below: PerBond,
    /// A_cc.
    pub diagonal: PerBond,
    /// Element `c` is A_c,c+1; the last has no meaning.
    pub above: PerBond,
    /// The right side, which [`Tridiagonal::solve`] replaces by the solution.
    pub right: PerBond,
}

impl Tridiagonal {
    /// All numbers zero.
    pub const ZERO: Self = Self {
        below: [0.0; MOST_BONDS],
        diagonal: [0.0; MOST_BONDS],
        above: [0.0; MOST_BONDS],
        right: [0.0; MOST_BONDS],
    };

    /// Writes A = G(`left`)·M⁻¹·G(`right`)ᵀ of a chain whose first site is particle `first`.
    pub fn set_matrix(&mut self, masses: &Masses, first: usize, left: &[DVec3], right: &[DVec3]) {
        let inverse = |site: usize| 1.0 / masses.of(first + site);
        for c in 0..left.len() {
            self.diagonal[c] = (inverse(c) + inverse(c + 1)) * left[c].dot(right[c]);
            if c > 0 {
                self.below[c] = -left[c].dot(right[c - 1]) * inverse(c);
                self.above[c - 1] = -left[c - 1].dot(right[c]) * inverse(c);
            }
        }
    }

    /// Solves the first `n` equations without pivoting; returns the equation whose pivot is not positive.
    ///
    /// # Errors
    /// The number of that equation.
    pub fn solve(&mut self, n: usize) -> Result<(), usize> {
        let Self {
            below,
            diagonal,
            above,
            right,
        } = self;
        for c in 0..n {
            if c > 0 {
                let factor = below[c] / diagonal[c - 1];
                diagonal[c] -= factor * above[c - 1];
                right[c] -= factor * right[c - 1];
            }
            // A pivot that is no number is not positive either.
            if diagonal[c].is_nan() || diagonal[c] <= 0.0 {
                return Err(c);
            }
        }
        for c in (0..n).rev() {
            let beyond = if c + 1 < n {
                above[c] * right[c + 1]
            } else {
                0.0
            };
            right[c] = (right[c] - beyond) / diagonal[c];
        }
        Ok(())
    }
}

/// Writes the bond vectors d of a chain and returns those that there are.
pub fn bond_vectors<'a>(sites: &[DVec3], to: &'a mut [DVec3; MOST_BONDS]) -> &'a [DVec3] {
    let bonds = sites.len() - 1;
    for (d, pair) in to.iter_mut().zip(sites.windows(2)) {
        *d = pair[1] - pair[0];
    }
    &to[..bonds]
}

/// Adds M⁻¹·Gᵀ·`multipliers` to one vector per site of a chain.
pub fn add_along_bonds(
    to: &mut [DVec3],
    masses: &Masses,
    first: usize,
    bonds: &[DVec3],
    multipliers: &[f64],
) {
    for (c, (d, multiplier)) in bonds.iter().zip(multipliers).enumerate() {
        let along = *multiplier * *d;
        to[c] -= along / masses.of(first + c);
        to[c + 1] += along / masses.of(first + c + 1);
    }
}

/// Takes the part along the bonds off velocities: v ← v − M⁻¹Gᵀ·A⁻¹·Gv, after which d·w = 0 for each bond.
///
/// It is the velocity stage of RATTLE (H. C. Andersen, J. Comput. Phys. 52, 24 (1983)), solved exactly for each molecule.
/// Nothing is done where bonds are not rigid.
pub fn project_velocities(system: &System, positions: &[DVec3], velocities: &mut [DVec3]) {
    let molecules = &system.molecules;
    if !molecules.are_rigid() {
        return;
    }
    molecules.for_each(molecules.sites(), velocities, |m, v| {
        let sites = molecules.sites_of(m);
        let (first, x) = (sites.start, &positions[sites]);
        if v.len() == 2 {
            project_bond(&system.masses, first, x, v);
        } else {
            project_chain(&system.masses, first, x, v);
        }
    });
}

fn project_bond(masses: &Masses, first: usize, x: &[DVec3], v: &mut [DVec3]) {
    let [i, j] = [1.0 / masses.of(first), 1.0 / masses.of(first + 1)];
    let d = x[1] - x[0];
    let along = d.dot(v[1] - v[0]) / ((i + j) * d.length_squared());
    v[0] += (along * i) * d;
    v[1] -= (along * j) * d;
}

fn project_chain(masses: &Masses, first: usize, x: &[DVec3], v: &mut [DVec3]) {
    let mut bonds = [DVec3::ZERO; MOST_BONDS];
    let bonds = bond_vectors(x, &mut bonds);
    let mut equations = Tridiagonal::ZERO;
    equations.set_matrix(masses, first, bonds, bonds);
    for (c, d) in bonds.iter().enumerate() {
        equations.right[c] = -d.dot(v[c + 1] - v[c]);
    }
    // The matrix is positive definite for any chain whose bonds have a length.
    if equations.solve(bonds.len()).is_ok() {
        add_along_bonds(v, masses, first, bonds, &equations.right);
    }
}

/// What the constraint forces of rigid bonds add up to at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintSums {
    /// The virial tensor Σ λ·d⊗d, ε.
    pub virial: DMat3,
    /// Σ |F + F_c|²/m over all sites, with the constraint forces F_c, ε²/(σ² m).
    pub squared_forces: f64,
    /// The largest | |d|/r − 1 |.
    pub largest_residual: f64,
}

impl ConstraintSums {
    /// The sums of no bonds.
    pub const NOTHING: Self = Self {
        virial: DMat3::ZERO,
        squared_forces: 0.0,
        largest_residual: 0.0,
    };
}

impl Add for ConstraintSums {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            virial: self.virial + other.virial,
            squared_forces: self.squared_forces + other.squared_forces,
            largest_residual: self.largest_residual.max(other.largest_residual),
        }
    }
}

impl std::iter::Sum for ConstraintSums {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::NOTHING, Add::add)
    }
}

/// The sums of the instantaneous constraint forces, which belong to positions, velocities and forces of the state:
/// A·λ = −(G·M⁻¹·F + |w|²).
///
/// The multipliers inside a step differ from these by terms of order h, with opposite signs in the two halves.
#[must_use]
pub fn constraint_sums(system: &System, state: &State) -> ConstraintSums {
    let molecules = &system.molecules;
    if !molecules.are_rigid() {
        return ConstraintSums::NOTHING;
    }
    ordered_sum(state.len() / molecules.sites(), |range| {
        range
            .map(|m| sums_of(system, state, molecules.sites_of(m)))
            .sum()
    })
}

fn sums_of(system: &System, state: &State, sites: std::ops::Range<usize>) -> ConstraintSums {
    let (masses, first) = (&system.masses, sites.start);
    let (x, v) = (
        &state.positions[sites.clone()],
        &state.velocities[sites.clone()],
    );
    let mut bonds = [DVec3::ZERO; MOST_BONDS];
    let bonds = bond_vectors(x, &mut bonds);
    let mut equations = Tridiagonal::ZERO;
    equations.set_matrix(masses, first, bonds, bonds);
    let mut total: [DVec3; MOST_BONDS + 1] = [DVec3::ZERO; MOST_BONDS + 1];
    let total = &mut total[..x.len()];
    for (k, f) in state.forces[sites].iter().enumerate() {
        total[k] = *f / masses.of(first + k);
    }
    for (c, d) in bonds.iter().enumerate() {
        let w = v[c + 1] - v[c];
        equations.right[c] = -(d.dot(total[c + 1] - total[c]) + w.length_squared());
    }
    if equations.solve(bonds.len()).is_err() {
        return ConstraintSums {
            squared_forces: f64::NAN,
            ..ConstraintSums::NOTHING
        };
    }
    add_along_bonds(total, masses, first, bonds, &equations.right);
    let mut sums = ConstraintSums::NOTHING;
    for (d, multiplier) in bonds.iter().zip(&equations.right) {
        let scaled = *multiplier * *d;
        sums.virial += DMat3::from_cols(scaled * d.x, scaled * d.y, scaled * d.z);
        let residual = (d.length() / system.molecules.bond_length() - 1.0).abs();
        sums.largest_residual = sums.largest_residual.max(residual);
    }
    sums.squared_forces = total
        .iter()
        .enumerate()
        .map(|(k, a)| masses.of(first + k) * a.length_squared())
        .sum();
    sums
}

/// Σ (r_i − R)·F_i over all sites, with R the centre of mass of each molecule, in ε: the virial of all forces inside
/// molecules, with the opposite sign. Zero for atoms.
///
/// The virial over pairs less this number is the molecular virial Σ R_ab·F_ab, which no bond contributes to.
#[must_use]
pub fn intramolecular_virial(system: &System, positions: &[DVec3], forces: &[DVec3]) -> f64 {
    let molecules = &system.molecules;
    if molecules.are_atoms() {
        return 0.0;
    }
    ordered_sum(positions.len() / molecules.sites(), |range| {
        range
            .map(|m| {
                let sites = molecules.sites_of(m);
                let x = &positions[sites.clone()];
                let center = molecules.center(&system.masses, sites.start, x);
                x.iter()
                    .zip(&forces[sites])
                    .map(|(r, f)| (*r - center).dot(*f))
                    .sum::<f64>()
            })
            .sum()
    })
}
