//! The direct solution: closed form for one bond, Newton's method for a chain.

use lennard_core::rigid::{Tridiagonal, add_along_bonds, bond_vectors};
use lennard_core::{Bonds, DVec3, MOST_BONDS, MOST_SITES, Molecules};

use super::chains::{Chain, ChainError, ChainRule, Chains};
use super::{BondHolder, BondMethod, BondSpec};

lennard_core::options! {
    /// Options of the direct solution.
    pub struct Options {
        /// Largest | |d|/r − 1 | after a drift, for chains; the closed form of a single bond is exact.
        tolerance: f64 = 1e-10, Between(4e-15, 1e-2);
    }
}

/// Newton's method converges in two to four iterations, or not at all.
const MOST_ITERATIONS: u32 = 50;

impl BondMethod for Options {
    const SPEC: BondSpec = BondSpec {
        name: "direct",
        summary: "Rigid bonds by the exact solution for each molecule: closed form for one bond, Newton's method for a chain.",
        equations: "x = x~ + M^-1 G_n^T L with |d| = r for each bond; one bond: eta = -c/(b + sqrt(b^2 - a c)), a = |d_n|^2, b = s.d_n, c = |s|^2 - r^2; then v += dx/h, and v - M^-1 G^T A^-1 G v after each kick",
        bonds: Bonds::Rigid,
        source: "Andersen, \"Rattle: a velocity version of the Shake algorithm\", J. Comput. Phys. 52, 24 (1983)",
    };

    fn build(&self, _molecules: &Molecules) -> BondHolder {
        let rule = Direct {
            tolerance: self.tolerance,
        };
        BondHolder::Rigid(Box::new(Chains::new(rule)))
    }
}

/// The direct solution, with corrections along the bonds before the drift, which makes the method time-reversible.
#[derive(Debug, Clone)]
struct Direct {
    tolerance: f64,
}

impl ChainRule for Direct {
    fn solve(&self, chain: &mut Chain<'_>) -> Result<u32, ChainError> {
        if chain.before.len() == 1 {
            one_bond(chain)
        } else {
            newton(chain, self.tolerance)
        }
    }
}

/// The closed form for one bond; the sum in the denominator has no cancellation.
fn one_bond(chain: &mut Chain<'_>) -> Result<u32, ChainError> {
    let d = chain.before[0];
    let s = chain.sites[1] - chain.sites[0];
    let (a, b) = (d.length_squared(), s.dot(d));
    let c = s.length_squared() - chain.length * chain.length;
    let root2 = b * b - a * c;
    // Negated, so that numbers that are not finite fail too.
    if !(b > 0.0 && root2 >= 0.0) {
        return Err(chain.turned(0, s));
    }
    let eta = -c / (b + root2.sqrt());
    let [i, j] = [
        1.0 / chain.masses.of(chain.first),
        1.0 / chain.masses.of(chain.first + 1),
    ];
    let share = eta / (i + j);
    chain.displace(0, -(share * i) * d);
    chain.displace(1, (share * j) * d);
    Ok(1)
}

/// Newton's method on ½(|d|² − r²) = 0 for all bonds of a chain; rows of G at the iterate, columns before the drift.
fn newton(chain: &mut Chain<'_>, tolerance: f64) -> Result<u32, ChainError> {
    let mut vectors = [DVec3::ZERO; MOST_BONDS];
    let mut equations = Tridiagonal::ZERO;
    let length2 = chain.length * chain.length;
    for iteration in 0..=MOST_ITERATIONS {
        if chain.residual() <= tolerance {
            return Ok(iteration);
        }
        let bonds = bond_vectors(chain.sites, &mut vectors);
        equations.set_matrix(chain.masses, chain.first, bonds, chain.before);
        for (c, s) in bonds.iter().enumerate() {
            equations.right[c] = -0.5 * (s.length_squared() - length2);
        }
        if let Err(c) = equations.solve(bonds.len()) {
            return Err(chain.turned(c, bonds[c]));
        }
        let multipliers = equations.right;
        let mut by = [DVec3::ZERO; MOST_SITES];
        add_along_bonds(
            &mut by,
            chain.masses,
            chain.first,
            chain.before,
            &multipliers,
        );
        for (site, by) in by.iter().enumerate().take(chain.sites.len()) {
            chain.displace(site, *by);
        }
    }
    Err(ChainError::NotConverged(
        MOST_ITERATIONS,
        chain.residual(),
        tolerance,
    ))
}
