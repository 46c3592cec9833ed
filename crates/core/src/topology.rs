//! What is bonded to what in a molecule: its sites, its bonds, and the equations that they share.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::sparse::Pattern;

/// The most sites of a molecule.
pub const MOST_SITES: usize = 64;
/// The most bonds of a chain.
pub(crate) const MOST_BONDS: usize = MOST_SITES - 1;

/// A bond between two sites of a molecule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bond {
    /// The sites i and j that it joins, from 0; d = x_j − x_i.
    pub sites: [usize; 2],
    /// Its length r, σ.
    pub length: f64,
}

impl Bond {
    /// d = x_j − x_i, from the positions of the sites of its molecule.
    #[inline]
    #[must_use]
    pub fn vector(&self, sites: &[DVec3]) -> DVec3 {
        sites[self.sites[1]] - sites[self.sites[0]]
    }
}

/// Two bonds that share a site: A_cd = ±(d_c·d_d)/m_shared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// The bonds c < d.
    pub bonds: [usize; 2],
    /// The site that they share.
    pub site: usize,
    /// +1 where both bonds leave the site or both enter it, else −1.
    pub sign: f64,
}

/// Why bonds make no molecule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TopologyError {
    /// Bonds join sites that the molecule does not have; sites count from 1.
    #[error("bond {bond} joins sites {} and {}, and the molecule has sites 1 to {sites}", .joined[0], .joined[1])]
    NoSuchSite {
        /// Number of the bond, from 1.
        bond: usize,
        /// The sites that it joins, from 1.
        joined: [usize; 2],
        /// Sites of the molecule.
        sites: usize,
    },
    /// A bond joins a site to itself.
    #[error("bond {bond} joins site {site} to itself")]
    ToItself {
        /// Number of the bond, from 1.
        bond: usize,
        /// The site, from 1.
        site: usize,
    },
    /// Two bonds join the same sites.
    #[error("bonds {first} and {second} join the same two sites")]
    Twice {
        /// Number of one bond, from 1.
        first: usize,
        /// Number of the other.
        second: usize,
    },
    /// A site that no bonds lead to from the first.
    #[error("no bonds lead from site 1 to site {site}: the molecule falls apart")]
    Apart {
        /// The site, from 1.
        site: usize,
    },
}

/// The bonds of each molecule of a fluid.
#[derive(Debug)]
pub struct Topology {
    sites: usize,
    bonds: Vec<Bond>,
    is_chain: bool,
    couplings: Vec<Coupling>,
    /// How A is eliminated, where neither a tridiagonal nor a small one.
    pattern: Option<Pattern>,
}

impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.sites == other.sites && self.bonds == other.bonds
    }
}

/// As many bonds are solved for by formulas written by hand, whatever they join.
pub const MOST_BONDS_BY_HAND: usize = 3;

impl Topology {
    /// A chain of `sites` sites whose bonds join consecutive ones.
    #[must_use]
    pub fn chain(sites: usize, length: f64) -> Self {
        let bonds = (1..sites).map(|k| Bond { sites: [k - 1, k], length });
        Self::of(sites, bonds.collect())
    }

    /// `sites` sites and their bonds.
    ///
    /// # Errors
    /// [`TopologyError`] where a bond joins what it cannot, or the molecule falls apart.
    pub fn new(sites: usize, bonds: Vec<Bond>) -> Result<Self, TopologyError> {
        for (c, bond) in bonds.iter().enumerate() {
            let [i, j] = bond.sites;
            if i >= sites || j >= sites || sites > MOST_SITES {
                return Err(TopologyError::NoSuchSite {
                    bond: c + 1,
                    joined: [i.wrapping_add(1), j.wrapping_add(1)],
                    sites,
                });
            }
            if i == j {
                return Err(TopologyError::ToItself { bond: c + 1, site: i + 1 });
            }
            let same = |other: &Bond| other.sites == [i, j] || other.sites == [j, i];
            if let Some(first) = bonds[..c].iter().position(same) {
                return Err(TopologyError::Twice { first: first + 1, second: c + 1 });
            }
        }
        let made = Self::of(sites, bonds);
        let reached: BTreeSet<usize> = made.walk().map(|(_, to, _)| to).chain([0]).collect();
        match (0..sites).find(|site| !reached.contains(site)) {
            Some(site) => Err(TopologyError::Apart { site: site + 1 }),
            None => Ok(made),
        }
    }

    fn of(sites: usize, bonds: Vec<Bond>) -> Self {
        let is_chain = bonds.len() + 1 == sites
            && (bonds.iter().enumerate()).all(|(c, bond)| bond.sites == [c, c + 1]);
        let couplings = couplings(&bonds);
        let by_hand = is_chain || bonds.len() <= MOST_BONDS_BY_HAND;
        let pattern = (!by_hand).then(|| {
            let pairs: Vec<(usize, usize)> =
                couplings.iter().map(|c| (c.bonds[0], c.bonds[1])).collect();
            Pattern::new(bonds.len(), &pairs)
        });
        Self { sites, bonds, is_chain, couplings, pattern }
    }

    /// Sites of each molecule.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.sites
    }

    /// The bonds of each molecule.
    #[must_use]
    pub fn bonds(&self) -> &[Bond] {
        &self.bonds
    }

    /// Whether bond c joins sites c and c + 1, for each bond, and there are no others.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        self.is_chain
    }

    /// The pairs of bonds that share a site.
    #[must_use]
    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// The pairs of which bond `c` is one.
    pub fn couplings_of(&self, c: usize) -> impl Iterator<Item = &Coupling> {
        self.couplings.iter().filter(move |one| one.bonds.contains(&c))
    }

    /// How the equations of all bonds are eliminated; `None` for a chain, and for few bonds.
    pub(crate) fn pattern(&self) -> Option<&Pattern> {
        self.pattern.as_ref()
    }

    /// The steps of a walk from site 0 along bonds to each other site: from where, to where, and along which bond.
    pub fn walk(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let mut reached = BTreeSet::from([0]);
        std::iter::from_fn(move || {
            let step = self.bonds.iter().enumerate().find_map(|(c, bond)| {
                let [i, j] = bond.sites;
                match (reached.contains(&i), reached.contains(&j)) {
                    (true, false) => Some((i, j, c)),
                    (false, true) => Some((j, i, c)),
                    _ => None,
                }
            })?;
            reached.insert(step.1);
            Some(step)
        })
    }

    /// A bond that follows from the others where the sites of a molecule are at `positions`: its constraint has no force of its
    /// own. Four sites of a square with both diagonals have one, three sites on a line with three
    /// bonds have one.
    ///
    /// It is a pivot of A = G·M⁻¹·Gᵀ for directions u = d/|d| that vanishes, with unit masses and infinite ones of held sites. A
    /// bond between two held sites is such a bond too.
    #[must_use]
    pub fn redundant_bond(
        &self,
        positions: &[DVec3],
        is_held: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        /// Rounding of positions in a file leaves pivots near 10⁻⁷; bonds that meet at one degree leave 3·10⁻⁴.
        const SMALLEST_PIVOT: f64 = 1e-6;
        let n = self.bonds.len();
        let units: Vec<DVec3> =
            self.bonds.iter().map(|bond| bond.vector(positions).normalize_or_zero()).collect();
        let inverse_mass = |site: usize| if is_held(site) { 0.0 } else { 1.0 };
        let mut a = vec![0.0; n * n];
        for (c, bond) in self.bonds.iter().enumerate() {
            let both: f64 = bond.sites.into_iter().map(inverse_mass).sum();
            a[c * n + c] = both * units[c].length_squared();
        }
        for coupling in &self.couplings {
            let [c, d] = coupling.bonds;
            let value = coupling.sign * units[c].dot(units[d]) * inverse_mass(coupling.site);
            a[c * n + d] = value;
            a[d * n + c] = value;
        }
        for c in 0..n {
            let pivot = a[c * n + c];
            if pivot.is_nan() || pivot < SMALLEST_PIVOT {
                return Some(c);
            }
            for row in c + 1..n {
                let factor = a[row * n + c] / pivot;
                for column in c..n {
                    a[row * n + column] -= factor * a[c * n + column];
                }
            }
        }
        None
    }

    /// The largest eigenvalue λ of A for unit masses and bonds of unit length that all lie on one line, the stiffest form.
    ///
    /// Springs of stiffness k vibrate with ω² = k·λ at most.
    #[must_use]
    pub fn stiffest(&self) -> f64 {
        /// The power method on matrices of this kind has converged to 10⁻⁶ by then.
        const ROUNDS: usize = 3000;
        let mut x = vec![1.0; self.bonds.len()];
        let mut largest = 0.0;
        for _ in 0..ROUNDS {
            let mut y: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
            for coupling in &self.couplings {
                let [c, d] = coupling.bonds;
                y[c] += x[d];
                y[d] += x[c];
            }
            largest = y.iter().map(|y| y * y).sum::<f64>().sqrt();
            x = y.iter().map(|y| y / largest).collect();
        }
        largest
    }
}

fn couplings(bonds: &[Bond]) -> Vec<Coupling> {
    let mut found = Vec::new();
    for (d, second) in bonds.iter().enumerate() {
        for (c, first) in bonds[..d].iter().enumerate() {
            for (one, site) in first.sites.iter().enumerate() {
                if let Some(other) = second.sites.iter().position(|s| s == site) {
                    found.push(Coupling {
                        bonds: [c, d],
                        site: *site,
                        sign: if one == other { 1.0 } else { -1.0 },
                    });
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bonds(pairs: &[[usize; 2]]) -> Vec<Bond> {
        let bond = |sites: &[usize; 2]| Bond { sites: *sites, length: 1.0 };
        pairs.iter().map(bond).collect()
    }

    #[test]
    fn bonds_that_make_no_molecule_are_refused() {
        let refused = |sites, pairs: &[[usize; 2]]| {
            Topology::new(sites, bonds(pairs)).unwrap_err().to_string()
        };
        assert!(refused(3, &[[0, 1], [1, 3]]).contains("bond 2 joins sites 2 and 4"));
        assert!(refused(2, &[[1, 1]]).contains("site 2 to itself"));
        assert!(refused(2, &[[0, 1], [1, 0]]).contains("bonds 1 and 2 join the same two sites"));
        assert!(refused(4, &[[0, 1], [2, 3]]).contains("site 3"));
        assert!(refused(3, &[]).contains("site 2"));
    }

    #[test]
    fn bonds_that_follow_from_others_are_found() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let square = square.map(|[x, y]| DVec3::new(x, y, 0.0));
        let sides = [[0, 1], [1, 2], [2, 3], [3, 0]];
        let ring = Topology::new(4, bonds(&sides)).unwrap();
        let free = |_: usize| false;
        assert_eq!(ring.redundant_bond(&square, free), None);
        let one = [&sides[..], &[[0, 2]]].concat();
        let one = Topology::new(4, bonds(&one)).unwrap();
        assert_eq!(one.redundant_bond(&square, free), None);
        let both = [&sides[..], &[[0, 2], [1, 3]]].concat();
        let both = Topology::new(4, bonds(&both)).unwrap();
        assert_eq!(both.redundant_bond(&square, free), Some(5));
        let triangle = Topology::new(3, bonds(&[[0, 1], [1, 2], [2, 0]])).unwrap();
        let line = [0.0, 1.0, 2.0].map(|x| DVec3::new(x, 0.3 * x, 0.0));
        assert_eq!(triangle.redundant_bond(&line, free), Some(2));
        let chain = Topology::chain(3, 1.0);
        assert_eq!(chain.redundant_bond(&line, free), None);
        // A straight chain between two held ends has one bond too many, a bent one has not.
        let ends = |site: usize| site != 1;
        assert_eq!(chain.redundant_bond(&line, ends), Some(1));
        assert_eq!(chain.redundant_bond(&square, ends), None);
        assert_eq!(chain.redundant_bond(&square, |site| site < 2), Some(0));
    }

    #[test]
    fn a_chain_is_known_as_one_and_its_stiffest_vibration_too() {
        for sites in [2, 3, 10] {
            let chain = Topology::chain(sites, 1.0);
            assert!(chain.is_chain() && chain.couplings().len() == sites - 2);
            let half = 0.5 * std::f64::consts::PI / sites as f64;
            let law = 4.0 * half.cos().powi(2);
            assert!((chain.stiffest() / law - 1.0).abs() < 1e-6);
        }
        let branched = Topology::new(4, bonds(&[[0, 1], [0, 2], [3, 0]])).unwrap();
        assert!(!branched.is_chain());
        let signs: Vec<f64> = branched.couplings().iter().map(|c| c.sign).collect();
        assert_eq!(signs, [1.0, -1.0, -1.0]);
    }
}
