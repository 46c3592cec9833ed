//! Stiff springs: bonds as forces.

use lennard_core::exact::exact_sum;
use lennard_core::{
    Bond, BondSolver, Bonds, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties,
    ForceTerm, Molecules, Part, Want,
};

use super::dashpots::Dashpots;
use super::implicit_springs::{DampedSpring, LinearlyImplicit, Midpoint};
use super::molecule::EachMolecule;
use super::{BondHolder, BondMethod, BondSpec};

lennard_core::choices! {
    /// How springs are integrated.
    pub enum Scheme {
        /// As all other forces are, by kicks.
        #[default]
        Explicit = "explicit",
        /// In the drift, by the implicit midpoint rule: stable at any step along a line, and for Ω·ω·h² < 4 where the bond turns with Ω.
        Midpoint = "midpoint",
        /// In the drift, by one step of Newton's method for the implicit Euler rule: stable at any step, and damped.
        LinearlyImplicit = "linearly-implicit",
    }
}

lennard_core::options! {
    /// Options of springs.
    pub struct Options {
        /// Stiffness k of each bond.
        stiffness: f64 = 4000.0, Between(1e-9, 1e12), in "ε/σ²";
        /// Damping c of the dashpot beside each spring, which takes −c times the rate of the length. What it takes is counted as heat; a bath gives no
        /// noise for it.
        damping: f64 = 0.0, Between(0.0, 1e9), in "ε·τ/σ²";
        /// How springs are integrated: by kicks, or inside the drift, where vibrations do not limit the step, but are slowed (midpoint) or damped.
        scheme: Scheme = Scheme::Explicit, Names(Scheme::names);
    }
}

/// What this way declares about itself.
pub const SPEC: BondSpec = BondSpec {
    name: "spring",
    summary: "Bonds as stiff springs, which take no degree of freedom away: a force, or implicit inside the drift.",
    equations: "U = k/2 (|d| - r)^2, f = -k (|d| - r) - c d|d|/dt; omega = sqrt(k (1/m_i + 1/m_j)); explicit: h below 2/omega, u.w exp(-c (1/m_i + 1/m_j) h/2) before and after the drift; midpoint: x' = x + h (v + v')/2, v' = v + h f((x + x')/2)/m; linearly implicit: (M + h C + h^2 K) dv = h (f - C v - h K v), K = k u u^T, C = c u u^T",
    bonds: Bonds::Springs,
    integrator: None,
    source: "Allen and Tildesley, \"Computer Simulation of Liquids\", 2nd ed. (2017), section 1.3.3",
};

impl BondMethod for Options {
    fn bonds(&self) -> Bonds {
        match self.is_force() {
            true => Bonds::Springs,
            false => Bonds::Impulses,
        }
    }

    fn build(&self, molecules: &Molecules) -> BondHolder {
        let term = Box::new(Springs {
            stiffness: self.stiffness,
            molecules: molecules.clone(),
            pushes: self.scheme == Scheme::Explicit,
        });
        let spring = DampedSpring { stiffness: self.stiffness, damping: self.damping };
        let solver: Box<dyn BondSolver> = match self.scheme {
            Scheme::Explicit if self.is_force() => return BondHolder::Spring(term),
            Scheme::Explicit => Box::new(Dashpots { damping: self.damping }),
            Scheme::Midpoint => Box::new(EachMolecule(Midpoint(spring))),
            Scheme::LinearlyImplicit => Box::new(EachMolecule(LinearlyImplicit(spring))),
        };
        BondHolder::InDrift(solver, term)
    }

    fn frequency(&self) -> f64 {
        match self.scheme {
            Scheme::Explicit => (2.0 * self.stiffness).sqrt(),
            Scheme::Midpoint | Scheme::LinearlyImplicit => 0.0,
        }
    }

    fn damps_vibrations(&self) -> bool {
        self.damping > 0.0 || self.scheme == Scheme::LinearlyImplicit
    }
}

impl Options {
    /// Whether the bonds are forces alone, and nothing acts in the drift.
    fn is_force(&self) -> bool {
        self.scheme == Scheme::Explicit && self.damping == 0.0
    }
}

/// Springs U = ½k(|d| − r)² along the bonds of molecules, with the force −k(|d| − r)·d/|d| on the site at the end of d.
#[derive(Debug, Clone)]
pub struct Springs {
    stiffness: f64,
    molecules: Molecules,
    /// Whether the springs are forces; else they act in the drift, and this term knows their energy alone.
    pushes: bool,
}

lennard_core::remembers_nothing!(Springs { stiffness, molecules, pushes });

/// Totals over bonds.
#[derive(Clone, Copy)]
struct Sums {
    energy: f64,
    virial: DMat3,
    laplacian: f64,
}

impl Sums {
    const NOTHING: Self = Self { energy: 0.0, virial: DMat3::ZERO, laplacian: 0.0 };
}

impl Springs {
    /// Springs whose energy is known alone, since they act elsewhere.
    pub(super) fn of_energy(stiffness: f64, molecules: &Molecules) -> Self {
        Self { stiffness, molecules: molecules.clone(), pushes: false }
    }

    /// The force on the site at the end of a bond with the vector d, and its energy.
    fn bond(&self, bond: &Bond, d: DVec3) -> (DVec3, f64) {
        let length = d.length();
        let strain = length - bond.length;
        let force = (-self.stiffness * strain / length) * d;
        (force, 0.5 * self.stiffness * strain * strain)
    }

    fn add_forces(&self, positions: &[DVec3], forces: &mut [DVec3]) {
        let molecules = &self.molecules;
        molecules.for_each(molecules.sites(), forces, |m, forces| {
            let sites = &positions[molecules.sites_of(m)];
            for bond in molecules.bonds() {
                let (f, _) = self.bond(bond, bond.vector(sites));
                forces[bond.sites[0]] -= f;
                forces[bond.sites[1]] += f;
            }
        });
    }

    fn totals(&self, positions: &[DVec3]) -> Sums {
        let n = positions.len() / self.molecules.sites();
        let [energy, laplacian, virial @ ..] = exact_sum(n, |m| {
            let sites = &positions[self.molecules.sites_of(m)];
            let (mut energy, mut laplacian, mut virial) = (0.0, 0.0, DMat3::ZERO);
            for bond in self.molecules.bonds() {
                let d = bond.vector(sites);
                let (f, of_bond) = self.bond(bond, d);
                energy += of_bond;
                virial += DMat3::from_cols(f * d.x, f * d.y, f * d.z);
                // ∇²U = U″ + 2U′/|d| at each of the two ends.
                let slope = 1.0 - bond.length / d.length();
                laplacian += 2.0 * self.stiffness * (1.0 + 2.0 * slope);
            }
            let mut terms = [energy; 11];
            terms[1] = laplacian;
            terms[2..].copy_from_slice(&virial.to_cols_array());
            terms
        });
        Sums { energy, virial: DMat3::from_cols_array(&virial), laplacian }
    }
}

impl ForceTerm for Springs {
    lennard_core::evaluate_by_adding!();

    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        // Springs are the fastest motion: they belong to the near part.
        let sums = if part == Part::Far {
            Sums::NOTHING
        } else {
            if self.pushes {
                self.add_forces(at.positions, forces);
            }
            if want.is_nothing() { Sums::NOTHING } else { self.totals(at.positions) }
        };
        let sums = match self.pushes {
            true => sums,
            false => Sums { energy: sums.energy, ..Sums::NOTHING },
        };
        Ok(Energetics::of(want, sums.energy, sums.virial, sums.laplacian))
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let site = particle % self.molecules.sites();
        let sites = &at.positions[particle - site..particle - site + self.molecules.sites()];
        let mut force = DVec3::ZERO;
        for bond in self.molecules.bonds().iter().filter(|_| self.pushes) {
            let [i, j] = bond.sites;
            if site == i {
                force -= self.bond(bond, bond.vector(sites)).0;
            } else if site == j {
                force += self.bond(bond, bond.vector(sites)).0;
            }
        }
        force
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: true, ..ForceProperties::default() }
    }
}
