//! Molecules: equal chains of sites with consecutive numbers, held together by bonds.
//!
//! ```text
//!   site      0     1     2  |  3     4     5  |  6 ...        3 sites per molecule
//!   bond         0     1     |     0     1     |
//!   molecule        0        |        1        |  2 ...
//! ```

use std::ops::Range;

use glam::DVec3;

use crate::masses::Masses;
use crate::tasks::for_each_item;

/// The most sites of a molecule.
pub const MOST_SITES: usize = 64;
/// The most bonds of a molecule.
pub const MOST_BONDS: usize = MOST_SITES - 1;

/// Molecules per task: each molecule is a sum of its own, so that the number changes no bit.
pub const MOLECULES_PER_TASK: usize = 256;

/// What holds the bonds of molecules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bonds {
    /// Constraints |d| = r: each bond takes one degree of freedom away.
    Rigid,
    /// Springs, which are forces: no degree of freedom is lost.
    Springs,
}

/// Equal molecules: chains of `sites` sites, in which each bond joins two consecutive sites.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Molecules {
    sites: usize,
    /// Length r of each bond, σ.
    bond_length: f64,
    bonds: Bonds,
}

impl Molecules {
    /// No bonds: each particle is a molecule of its own.
    pub const ATOMS: Self = Self {
        sites: 1,
        bond_length: 0.0,
        bonds: Bonds::Springs,
    };

    /// Chains of `sites` sites with bonds of `bond_length` σ.
    ///
    /// # Panics
    /// Where there are no sites or more than [`MOST_SITES`]: that is a bug of the caller.
    #[must_use]
    pub fn chains(sites: usize, bond_length: f64, bonds: Bonds) -> Self {
        assert!((1..=MOST_SITES).contains(&sites), "1 to 64 sites");
        Self {
            sites,
            bond_length,
            bonds,
        }
    }

    /// Sites of each molecule.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.sites
    }

    /// Bonds of each molecule.
    #[must_use]
    pub fn bonds(&self) -> usize {
        self.sites - 1
    }

    /// Length r of each bond, σ.
    #[must_use]
    pub fn bond_length(&self) -> f64 {
        self.bond_length
    }

    /// Whether each particle is a molecule of its own.
    #[must_use]
    pub fn are_atoms(&self) -> bool {
        self.sites == 1
    }

    /// The unit of energies that are divided by the number of molecules.
    #[must_use]
    pub fn energy_unit(&self) -> &'static str {
        if self.are_atoms() {
            "ε per particle"
        } else {
            "ε per molecule"
        }
    }

    /// Whether there are bonds and constraints hold them.
    #[must_use]
    pub fn are_rigid(&self) -> bool {
        !self.are_atoms() && self.bonds == Bonds::Rigid
    }

    /// The pairs of particles that do not interact.
    #[must_use]
    pub fn exclusions(&self) -> Exclusions {
        Exclusions {
            sites: self.sites as u32,
        }
    }

    /// The sites of molecule `m`.
    #[must_use]
    pub fn sites_of(&self, m: usize) -> Range<usize> {
        m * self.sites..(m + 1) * self.sites
    }

    /// Runs `work(m, items of molecule m)` for each molecule, in tasks, where `items` has `per_molecule` items for each.
    pub fn for_each<T: Send>(
        &self,
        per_molecule: usize,
        items: &mut [T],
        work: impl Fn(usize, &mut [T]) + Sync,
    ) {
        let tasks = items.chunks_mut(per_molecule * MOLECULES_PER_TASK);
        for_each_item(tasks, |(), task, items| {
            for (m, own) in items.chunks_exact_mut(per_molecule).enumerate() {
                work(task * MOLECULES_PER_TASK + m, own);
            }
        });
    }

    /// The centre of mass of the molecule whose first site is particle `first`, from positions of its sites, σ.
    #[must_use]
    pub fn center(&self, masses: &Masses, first: usize, sites: &[DVec3]) -> DVec3 {
        let mass: f64 = (0..sites.len()).map(|k| masses.of(first + k)).sum();
        let weighted = sites.iter().enumerate();
        weighted
            .map(|(k, r)| masses.of(first + k) * *r)
            .sum::<DVec3>()
            / mass
    }
}

/// Pairs that no pair force acts between: the two ends of a bond.
///
/// Lists leave them out when they are built. Nothing is subtracted afterwards: at a third of σ the pair energy is above
/// 10⁵ ε, and a difference of such numbers has few digits left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exclusions {
    /// Sites of each chain; 1 where nothing is excluded.
    sites: u32,
}

impl Exclusions {
    /// Nothing is excluded.
    pub const NONE: Self = Self { sites: 1 };

    /// Whether nothing is excluded.
    #[inline]
    #[must_use]
    pub fn are_none(self) -> bool {
        self.sites == 1
    }

    /// The particles that particle `i` does not interact with, ascending.
    #[inline]
    pub fn of(self, i: u32) -> impl Iterator<Item = u32> {
        let site = i % self.sites;
        let before = (site > 0).then(|| i - 1);
        let after = (site + 1 < self.sites).then_some(i + 1);
        before.into_iter().chain(after)
    }

    /// Whether particles `i` and `j` do not interact.
    #[inline]
    #[must_use]
    pub fn exclude(self, i: usize, j: usize) -> bool {
        let (low, high) = (i.min(j), i.max(j));
        high - low == 1 && !high.is_multiple_of(self.sites as usize)
    }
}

impl Default for Exclusions {
    fn default() -> Self {
        Self::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_sites_of_one_molecule_exclude_each_other() {
        for sites in [1, 2, 3, 5] {
            let molecules = Molecules::chains(sites, 0.7, Bonds::Rigid);
            let exclusions = molecules.exclusions();
            let n = 4 * sites;
            for i in 0..n {
                let partners: Vec<u32> = exclusions.of(i as u32).collect();
                let wanted: Vec<u32> = (0..n)
                    .filter(|j| i.abs_diff(*j) == 1 && i / sites == j / sites)
                    .map(|j| j as u32)
                    .collect();
                assert_eq!(partners, wanted);
                for j in 0..n {
                    assert_eq!(exclusions.exclude(i, j), wanted.contains(&(j as u32)));
                }
            }
            assert_eq!(exclusions.are_none(), sites == 1);
        }
        assert_eq!(Exclusions::NONE.of(7).count(), 0);
    }
}
