//! Stiff springs inside the drift, molecule by molecule: the other forces stay kicks.
//!
//! A spring pulls along the unit vector u of its bond, with one unknown tension. The matrix Û has these vectors as rows, and
//! K = k·ÛᵀÛ. The equations have A = Û·M⁻¹·Ûᵀ with a number added to the diagonal, as rigid bonds and SPOOK have it.

use lennard_core::rigid::{add_along_bonds, bond_vectors, equations_of};
use lennard_core::{DVec3, Drifted, Topology};

use super::molecule::{MoleculeRule, MovedMolecule, NoSolution, Space};

/// A spring with a dashpot beside it, f = −k·(|d| − r) − c·d|d|/dt along the bond.
#[derive(Debug, Clone)]
pub struct DampedSpring {
    /// Stiffness k, ε/σ².
    pub stiffness: f64,
    /// Damping c, ε·τ/σ².
    pub damping: f64,
}

/// The implicit midpoint rule for springs: x′ = x + h·(v + v′)/2, v′ = v + h·f((x + x′)/2)/m.
///
/// It is symmetric and keeps linear and angular momentum, and the energy of a linear spring. A vibration of ω turns by
/// 2·atan(ωh/2) in a step. The dashpot has the mean rate ū·(d′ − d)/h of the step, and takes c·(ū·(d′ − d))²/h.
#[derive(Debug, Clone)]
pub struct Midpoint(pub DampedSpring);

/// Displacements that change by less than this share of a bond are found.
const TOLERANCE: f64 = 1e-13;
/// Directions of bonds converge by a factor of h²·tension/(m·r) an iteration, the rest as Newton's method.
const MOST_ITERATIONS: u32 = 100;

impl MoleculeRule for Midpoint {
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        space: &mut Space,
    ) -> Result<Drifted, NoSolution> {
        let (topology, masses, first) = (molecule.topology, molecule.masses, molecule.first);
        let (h, k) = (molecule.h, self.0.stiffness);
        // Both the strain at the middle and the mean rate grow with d′: as one spring of k + 2c/h.
        let (rate, both) = (self.0.damping / h, k + 2.0 * self.0.damping / h);
        let bonds = topology.bonds();
        // Tensions, as forces on the sites at the ends of the bonds.
        space.multipliers.clear();
        space.multipliers.resize(bonds.len(), 0.0);
        let mut change = f64::INFINITY;
        for iterations in 1..=MOST_ITERATIONS {
            bond_vectors(topology, molecule.sites, &mut space.bonds);
            space.right.clear();
            for (c, bond) in bonds.iter().enumerate() {
                let grown = space.bonds[c] - molecule.before[c];
                let middle = 0.5 * (molecule.before[c] + space.bonds[c]);
                let length = middle.length();
                space.bonds[c] = middle / length;
                let tension = space.multipliers[c] + k * (length - bond.length);
                let damped = rate * space.bonds[c].dot(grown);
                space.right.push(-(tension + damped) / both);
            }
            let equations = equations_of(&mut space.equations, topology);
            let sigma = 4.0 / (both * h * h);
            if let Err(c) = equations.factor(topology, masses, first, &space.bonds, sigma) {
                return Err(molecule.turned(c, space.bonds[c]));
            }
            equations.solve(topology, &mut space.right);
            for (tension, change) in space.multipliers.iter_mut().zip(&space.right) {
                *tension += 4.0 / (h * h) * change;
            }
            // The displacements that these tensions give: ½h²·M⁻¹·Ûᵀ·λ.
            space.by.clear();
            space.by.resize(molecule.sites.len(), DVec3::ZERO);
            let (by, units) = (&mut space.by, &space.bonds);
            add_along_bonds(by, topology, masses, first, units, &space.multipliers);
            change = 0.0;
            for site in 0..molecule.sites.len() {
                let by = 0.5 * h * h * space.by[site] - molecule.moved[site];
                change = f64::max(change, by.length() / bonds[0].length);
                molecule.displace(site, by);
            }
            if change <= TOLERANCE {
                return Ok(Drifted {
                    iterations,
                    residual: change,
                    heat: self.heat(molecule, space),
                });
            }
        }
        Err(NoSolution::NotConverged(MOST_ITERATIONS, change, TOLERANCE))
    }

    fn has_velocity_stage(&self) -> bool {
        false
    }

    /// The site moves by the mean of the velocities before and after.
    fn velocity_factor(&self) -> f64 {
        2.0
    }
}

impl Midpoint {
    /// The work of the dashpots in the step, which is not positive, ε.
    fn heat(&self, molecule: &MovedMolecule<'_>, space: &mut Space) -> f64 {
        if self.0.damping == 0.0 {
            return 0.0;
        }
        bond_vectors(molecule.topology, molecule.sites, &mut space.bonds);
        let both = molecule.before.iter().zip(&space.bonds);
        let squares = both.map(|(before, after)| {
            let unit = (*before + *after).normalize();
            unit.dot(*after - *before).powi(2)
        });
        -self.0.damping / molecule.h * squares.sum::<f64>()
    }
}

/// One step of Newton's method for the implicit Euler rule (Baraff and Witkin 1998): (M + hC + h²K)·Δv = h·(f − C·v − h·K·v), K = k·ÛᵀÛ,
/// C = c·ÛᵀÛ.
///
/// The part of ∂f/∂x that turns a spring under tension is left out, since the matrix may lose definiteness with it. The amplitude of a
/// vibration falls by 1/√(1 + (ωh)²) in a step: the rule damps, also slow motion along the bonds. What it takes is counted as heat.
#[derive(Debug, Clone)]
pub struct LinearlyImplicit(pub DampedSpring);

impl MoleculeRule for LinearlyImplicit {
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        space: &mut Space,
    ) -> Result<Drifted, NoSolution> {
        let (topology, masses, first) = (molecule.topology, molecule.masses, molecule.first);
        let (h, k) = (molecule.h, self.0.stiffness);
        // The dashpot pulls to the length before the drift, as a second spring of c/h.
        let rate = self.0.damping / h;
        let both = k + rate;
        bond_vectors(topology, molecule.sites, &mut space.bonds);
        space.right.clear();
        for (c, bond) in topology.bonds().iter().enumerate() {
            let before = molecule.before[c].length();
            let unit = molecule.before[c] / before;
            let drawn_to = bond.length + rate / both * (before - bond.length);
            space.right.push(drawn_to - unit.dot(space.bonds[c]));
            space.bonds[c] = unit;
        }
        let equations = equations_of(&mut space.equations, topology);
        let sigma = 1.0 / (both * h * h);
        if let Err(c) = equations.factor(topology, masses, first, &space.bonds, sigma) {
            return Err(molecule.turned(c, space.bonds[c]));
        }
        equations.solve(topology, &mut space.right);
        space.by.clear();
        space.by.resize(molecule.sites.len(), DVec3::ZERO);
        let by = &mut space.by;
        add_along_bonds(by, topology, masses, first, &space.bonds, &space.right);
        for site in 0..molecule.sites.len() {
            let by = space.by[site];
            molecule.displace(site, by);
        }
        Ok(Drifted { iterations: 1, ..Drifted::default() })
    }

    /// The rule damps on purpose: what it takes is heat.
    fn damped_energy(&self, topology: &Topology, bonds: &[DVec3]) -> Option<f64> {
        let strains = topology.bonds().iter().zip(bonds);
        let squares = strains.map(|(bond, d)| (d.length() - bond.length).powi(2));
        Some(0.5 * self.0.stiffness * squares.sum::<f64>())
    }

    fn has_velocity_stage(&self) -> bool {
        false
    }
}
