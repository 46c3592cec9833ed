//! Molecules: equal groups of sites with consecutive numbers, held together by bonds.
//!
//! ```text
//!   site      0     1     2  |  3     4     5  |  6 ...        chains of 3 sites
//!   bond         0     1     |     0     1     |
//!   molecule        0        |        1        |  2 ...
//! ```

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use crate::species::Masses;
use crate::tasks::for_each_item;
use crate::topology::{Bond, MOST_SITES, Topology};

/// Molecules per task: each molecule is a sum of its own, so that the number changes no bit.
pub const MOLECULES_PER_TASK: usize = 256;

/// What holds the bonds of molecules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bonds {
    /// Constraints |d| = r: each bond takes one degree of freedom away.
    Rigid,
    /// Springs, which are forces: no degree of freedom is lost.
    Springs,
    /// Springs that act by impulses inside a step, and are not among the forces of a state: no degree of freedom is lost.
    Impulses,
}

/// Equal molecules of `sites` consecutive particles each, held together by bonds.
#[derive(Debug, Clone, PartialEq)]
pub struct Molecules {
    /// What is bonded to what; `None` for atoms.
    topology: Option<Arc<Topology>>,
    bonds: Bonds,
}

impl Molecules {
    /// No bonds: each particle is a molecule of its own.
    pub const ATOMS: Self = Self { topology: None, bonds: Bonds::Springs };

    /// Molecules whose sites are bonded so.
    #[must_use]
    pub fn new(topology: Arc<Topology>, bonds: Bonds) -> Self {
        Self { topology: (topology.sites() > 1).then_some(topology), bonds }
    }

    /// Chains of `sites` sites with bonds of `bond_length` σ, each between two consecutive sites.
    ///
    /// # Panics
    /// Where there are no sites or more than [`MOST_SITES`]: that is a bug of the caller.
    #[must_use]
    pub fn chains(sites: usize, bond_length: f64, bonds: Bonds) -> Self {
        assert!((1..=MOST_SITES).contains(&sites), "1 to 64 sites");
        Self::new(Arc::new(Topology::chain(sites, bond_length)), bonds)
    }

    /// What is bonded to what in each molecule; `None` for atoms.
    #[must_use]
    pub fn topology(&self) -> Option<&Topology> {
        self.topology.as_deref()
    }

    /// Sites of each molecule.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.topology().map_or(1, Topology::sites)
    }

    /// The bonds of each molecule.
    #[must_use]
    pub fn bonds(&self) -> &[Bond] {
        self.topology().map_or(&[], Topology::bonds)
    }

    /// Whether each particle is a molecule of its own.
    #[must_use]
    pub fn are_atoms(&self) -> bool {
        self.topology.is_none()
    }

    /// The unit of energies that are divided by the number of molecules.
    #[must_use]
    pub fn energy_unit(&self) -> &'static str {
        if self.are_atoms() { "ε per particle" } else { "ε per molecule" }
    }

    /// Whether there are bonds and constraints hold them.
    #[must_use]
    pub fn are_rigid(&self) -> bool {
        !self.are_atoms() && self.bonds == Bonds::Rigid
    }

    /// Whether there are bonds whose forces are neither among the forces of a state nor follow from it.
    #[must_use]
    pub fn hide_forces(&self) -> bool {
        !self.are_atoms() && self.bonds == Bonds::Impulses
    }

    /// The pairs of particles that do not interact.
    #[must_use]
    pub fn exclusions(&self) -> Exclusions {
        let mut exclusions = Exclusions { sites: self.sites() as u32, partners: [0; MOST_SITES] };
        for bond in self.bonds() {
            let [i, j] = bond.sites;
            exclusions.partners[i] |= 1 << j;
            exclusions.partners[j] |= 1 << i;
        }
        exclusions
    }

    /// The sites of molecule `m`.
    #[must_use]
    pub fn sites_of(&self, m: usize) -> Range<usize> {
        m * self.sites()..(m + 1) * self.sites()
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

    /// The centre of mass of the molecule whose first site is particle `first`, from positions of its sites, σ. Held sites, whose
    /// mass is infinite, have it among them.
    #[must_use]
    pub fn center(&self, masses: &Masses, first: usize, sites: &[DVec3]) -> DVec3 {
        let held = || (0..sites.len()).filter(|k| masses.is_held(first + k));
        let n_held = held().count();
        if n_held > 0 {
            return held().map(|k| sites[k]).sum::<DVec3>() / n_held as f64;
        }
        let mass: f64 = (0..sites.len()).map(|k| masses.of(first + k)).sum();
        let weighted = sites.iter().enumerate();
        weighted.map(|(k, r)| masses.of(first + k) * *r).sum::<DVec3>() / mass
    }
}

/// Pairs that no pair force acts between: the two ends of a bond.
///
/// Lists leave them out when they are built. Nothing is subtracted afterwards: at a third of σ the pair energy is above
/// 10⁵ ε, and a difference of such numbers has few digits left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exclusions {
    /// Sites of each molecule; 1 where nothing is excluded.
    sites: u32,
    /// The sites that each site is bonded to, one bit each.
    partners: [u64; MOST_SITES],
}

impl Exclusions {
    /// Nothing is excluded.
    pub const NONE: Self = Self { sites: 1, partners: [0; MOST_SITES] };

    /// Whether nothing is excluded.
    #[inline]
    #[must_use]
    pub fn are_none(&self) -> bool {
        self.sites == 1
    }

    /// The particles that particle `i` does not interact with, ascending.
    #[inline]
    pub fn of(&self, i: u32) -> impl Iterator<Item = u32> + use<> {
        let site = i % self.sites;
        let first = i - site;
        let mut left = self.partners[site as usize];
        std::iter::from_fn(move || {
            let partner = (left != 0).then(|| left.trailing_zeros())?;
            left &= left - 1;
            Some(first + partner)
        })
    }

    /// Whether particles `i` and `j` do not interact.
    #[inline]
    #[must_use]
    pub fn exclude(&self, i: usize, j: usize) -> bool {
        let (low, apart) = (i.min(j), i.abs_diff(j));
        let sites = self.sites as usize;
        // Most pairs end here, without a division.
        if apart >= sites {
            return false;
        }
        let site = low % sites;
        site + apart < sites && self.partners[site] >> (site + apart) & 1 == 1
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

    #[test]
    fn the_ends_of_each_bond_of_a_ring_with_a_branch_exclude_each_other() {
        let pairs = [[0, 1], [1, 2], [2, 0], [3, 1]];
        let bonds = pairs.map(|sites| Bond { sites, length: 1.0 });
        let topology = Topology::new(4, bonds.to_vec()).unwrap();
        let exclusions = Molecules::new(Arc::new(topology), Bonds::Rigid).exclusions();
        for i in 0..12 {
            let wanted = |j: usize| {
                let both = [i % 4, j % 4];
                let joined = pairs.iter().any(|p| *p == both || *p == [both[1], both[0]]);
                i / 4 == j / 4 && joined
            };
            let partners: Vec<usize> = exclusions.of(i as u32).map(|j| j as usize).collect();
            assert_eq!(partners, (0..12).filter(|j| wanted(*j)).collect::<Vec<_>>());
            for j in 0..12 {
                assert_eq!(exclusions.exclude(i, j), wanted(j), "{i} and {j}");
            }
        }
    }
}
