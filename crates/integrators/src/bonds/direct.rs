//! The direct solution: Newton's method for the bonds of each molecule.

use lennard_core::options::OptionError;
use lennard_core::rigid::{Tridiagonal, add_along_bonds, bond_vectors, equations_of};
use lennard_core::{Bond, Bonds, DVec3, Drifted, Molecules, Topology};

use super::chains::Chains;
use super::molecule::{EachMolecule, MoleculeRule, MovedMolecule, NoSolution, Space};
use super::{BondHolder, BondMethod, BondSpec};

lennard_core::options! {
    /// Options of the direct solution.
    pub struct Options {
        /// Largest | |d|/r − 1 | after a drift; a single bond is solved to rounding.
        tolerance: f64 = 1e-10, Between(4e-15, 1e-2);
        /// Most bonds of a chain that are solved for at once: longer chains are cut, and the parts relaxed one after another; 0 cuts nothing.
        max_group: u32 = 0, Whole(0, 63), in "bonds";
    }
}

/// The smallest tolerance that lengths of bonds reach.
const ROUNDING: f64 = 4e-15;
/// Newton's method with the matrix of the start converges in up to ten iterations, or not at all.
const MOST_ITERATIONS: u32 = 50;
/// Parts of a chain converge as pq/((p + 1)(q + 1)): two halves of a chain of 64 sites in some 10³ sweeps.
const MOST_SWEEPS: u32 = 100_000;

/// What this way declares about itself.
pub const SPEC: BondSpec = BondSpec {
    name: "direct",
    summary: "Rigid bonds by the exact solution for each molecule: Newton's method for bonds, chains, rings and branches.",
    equations: "x = x~ + M^-1 G_n^T L with |d| = r for each bond; then v += dx/h, and v - M^-1 G^T A^-1 G v after each kick",
    bonds: Bonds::Rigid,
    integrator: None,
    source: "Andersen, \"Rattle: a velocity version of the Shake algorithm\", J. Comput. Phys. 52, 24 (1983)",
};

impl BondMethod for Options {
    fn build(&self, molecules: &Molecules) -> BondHolder {
        let Some(topology) = molecules.topology() else {
            return BondHolder::Drift(Box::new(Chains { tolerance: self.tolerance }));
        };
        let bonds = topology.bonds();
        // A third iteration costs a single bond little, and leaves rounding alone.
        let tolerance = if bonds.len() == 1 { ROUNDING } else { self.tolerance };
        let most = self.max_group as usize;
        if most > 0 && most < bonds.len() && topology.is_chain() {
            let parts = bonds.chunks(most).map(part).collect();
            return BondHolder::Drift(Box::new(EachMolecule(Cut { tolerance, parts })));
        }
        if topology.is_chain() {
            return BondHolder::Drift(Box::new(Chains { tolerance }));
        }
        BondHolder::Drift(Box::new(EachMolecule(Direct { tolerance })))
    }

    fn check_for(&self, topology: &Topology) -> Result<(), OptionError> {
        if self.max_group > 0 && !topology.is_chain() {
            return Err(OptionError {
                key: "max_group",
                found: format!("{} with molecules that are no chains", self.max_group),
                allowed: "0: molecules other than chains are solved whole".to_owned(),
            });
        }
        Ok(())
    }
}

/// Some consecutive bonds of a chain as a chain of their own.
fn part(bonds: &[Bond]) -> Topology {
    let bonds =
        bonds.iter().enumerate().map(|(c, bond)| Bond { sites: [c, c + 1], length: bond.length });
    let bonds: Vec<Bond> = bonds.collect();
    Topology::new(bonds.len() + 1, bonds).expect("a part of a chain is a chain")
}

/// One step of Newton's method on ½(|d|² − r²) = 0 for a part of a chain; rows of G at the iterate, columns before the drift.
fn newton_step(chain: &mut MovedMolecule<'_>, space: &mut Space) -> Result<(), NoSolution> {
    let topology = chain.topology;
    bond_vectors(topology, chain.sites, &mut space.bonds);
    let matrix = space.tridiagonal.get_or_insert_with(|| Box::new(Tridiagonal::ZERO));
    matrix.set(chain.masses, chain.first, &space.bonds, chain.before);
    off_by(topology, &space.bonds, &mut space.right);
    if let Err(c) = matrix.factor(space.bonds.len()) {
        return Err(chain.turned(c, space.bonds[c]));
    }
    matrix.solve(&mut space.right);
    displace_along(chain, &mut space.by, &space.right);
    Ok(())
}

/// −½(|d|² − r²) of each bond.
fn off_by(topology: &Topology, bonds: &[DVec3], to: &mut Vec<f64>) {
    to.clear();
    let all = topology.bonds().iter().zip(bonds);
    to.extend(all.map(|(bond, s)| -0.5 * (s.length_squared() - bond.length * bond.length)));
}

/// Moves the sites by M⁻¹·G_nᵀ·`multipliers`.
fn displace_along(molecule: &mut MovedMolecule<'_>, by: &mut Vec<DVec3>, multipliers: &[f64]) {
    by.clear();
    by.resize(molecule.sites.len(), DVec3::ZERO);
    let (topology, masses, first) = (molecule.topology, molecule.masses, molecule.first);
    add_along_bonds(by, topology, masses, first, molecule.before, multipliers);
    for (site, by) in by.iter().enumerate() {
        molecule.displace(site, *by);
    }
}

/// Newton's method for molecules that are no chains, with the matrix A = G·M⁻¹·Gᵀ of the bonds before the drift: it is symmetric and
/// factored once. The error falls by a factor of the order of h at each iteration.
///
/// Corrections along the bonds before the drift make the method time-reversible.
#[derive(Debug)]
struct Direct {
    tolerance: f64,
}

impl MoleculeRule for Direct {
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        space: &mut Space,
    ) -> Result<Drifted, NoSolution> {
        let (topology, masses, first) = (molecule.topology, molecule.masses, molecule.first);
        let equations = equations_of(&mut space.equations, topology);
        if let Err(c) = equations.factor(topology, masses, first, molecule.before, 0.0) {
            let s = topology.bonds()[c].vector(molecule.sites);
            return Err(molecule.turned(c, s));
        }
        let solved = molecule.until(self.tolerance, MOST_ITERATIONS, |molecule| {
            bond_vectors(topology, molecule.sites, &mut space.bonds);
            off_by(topology, &space.bonds, &mut space.right);
            let equations = equations_of(&mut space.equations, topology);
            equations.solve(topology, &mut space.right);
            displace_along(molecule, &mut space.by, &space.right);
            Ok(())
        });
        // Either a bond turned so far that its equation has no root, or the iterations went astray.
        solved.map_err(|error| {
            let bonds = topology.bonds().iter().map(|bond| bond.vector(molecule.sites));
            let mut turned = bonds.zip(molecule.before).enumerate();
            match turned.find(|(_, (s, before))| s.dot(**before) <= 0.0) {
                Some((c, (s, _))) => molecule.turned(c, s),
                None => error,
            }
        })
    }
}

/// A chain that is cut into parts: one step of Newton's method for each part in turn, again and again.
///
/// Two parts of p and q bonds of a straight chain of equal bonds converge by pq/((p + 1)(q + 1)) a sweep.
#[derive(Debug)]
struct Cut {
    tolerance: f64,
    parts: Vec<Topology>,
}

impl MoleculeRule for Cut {
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        space: &mut Space,
    ) -> Result<Drifted, NoSolution> {
        molecule.until(self.tolerance, MOST_SWEEPS, |molecule| {
            let mut at = 0;
            for part in &self.parts {
                let bonds = part.bonds().len();
                let mut own = MovedMolecule {
                    topology: part,
                    masses: molecule.masses,
                    first: molecule.first + at,
                    before: &molecule.before[at..at + bonds],
                    sites: &mut molecule.sites[at..=at + bonds],
                    moved: &mut molecule.moved[at..=at + bonds],
                    h: molecule.h,
                };
                newton_step(&mut own, space).map_err(|e| match e {
                    NoSolution::Turned(c, found) => NoSolution::Turned(at + c, found),
                    other => other,
                })?;
                at += bonds;
            }
            Ok(())
        })
    }
}
