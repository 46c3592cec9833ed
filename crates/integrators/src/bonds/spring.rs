//! Stiff springs: bonds as forces, with dashpots beside them, or inside the drift, where the other forces stay kicks.
//!
//! A spring pulls along the unit vector u of its bond, with one unknown tension. The matrix Û has these vectors as rows, and
//! K = k·ÛᵀÛ. The equations of implicit rules have A = Û·M⁻¹·Ûᵀ with a number added to the diagonal, as rigid bonds and SPOOK have it.

use lennard_core::exact::exact_sum;
use lennard_core::rigid::{add_along_bonds, bond_vectors, equations_of};
use lennard_core::{
    Bond, BondSolver, Bonds, BoundDrift, Configuration, DMat3, DVec3, Drifted, Energetics,
    ForceError, ForceProperties, ForceTerm, Masses, Molecules, Part, StepError, System, Topology,
    Want, moves,
};

use super::molecule::{EachMolecule, MoleculeRule, MovedMolecule, NoSolution, Space, over_tasks};
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

/// Dashpots −c·u·(u·w) along the bonds, with the unit vector u of a bond and w = v_j − v_i. They act half before a drift and half after it.
///
/// With κ = 1/m_i + 1/m_j, the speed u·w along one bond decays by e^{−c·κ·h/2} in each half: the decay is exact. Bonds that share
/// a site follow each other, forward before the drift and backward after it, so that a step is symmetric. A step of one
/// linear spring has the determinant g² = e^{−c·κ·h} and the trace 1 + g² − g·(ωh)². It is stable for (ωh)² < 2·(g + 1/g), which no
/// damping makes less than 4.
#[derive(Debug, Clone)]
struct Dashpots {
    /// Damping c, ε·τ/σ².
    damping: f64,
}

impl Dashpots {
    /// Lets the dashpot of one bond act for a time h on a molecule whose first site is particle `first`; returns the kinetic energy put in.
    fn act(
        &self,
        bond: &Bond,
        masses: &Masses,
        first: usize,
        x: &[DVec3],
        v: &mut [DVec3],
        h: f64,
    ) -> f64 {
        let [i, j] = bond.sites;
        let [of_i, of_j] = [i, j].map(|site| 1.0 / masses.of(first + site));
        let kappa = of_i + of_j;
        // Between two held sites nothing moves.
        if kappa == 0.0 {
            return 0.0;
        }
        let unit = bond.vector(x).normalize();
        let speed = unit.dot(v[j] - v[i]);
        let exponent = -self.damping * kappa * h;
        let impulse = (speed * exponent.exp_m1() / kappa) * unit;
        v[i] -= of_i * impulse;
        v[j] += of_j * impulse;
        0.5 * speed * speed * (2.0 * exponent).exp_m1() / kappa
    }
}

impl BondSolver for Dashpots {
    fn has_velocity_stage(&self) -> bool {
        false
    }

    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError> {
        let masses = &system.masses;
        over_tasks(system, moving, |_, topology, task, outcome| {
            let (sites, h) = (topology.sites(), task.drift.h);
            for (m, x, v) in task.kicked(masses, sites) {
                let first = m * sites;
                let mut heat = 0.0;
                for bond in topology.bonds() {
                    heat += self.act(bond, masses, first, x, v, 0.5 * h);
                }
                moves::drift(x, v, h);
                for bond in topology.bonds().iter().rev() {
                    heat += self.act(bond, masses, first, x, v, 0.5 * h);
                }
                outcome.solved(Drifted::with_heat(heat));
            }
        })
    }
}

/// A spring with a dashpot beside it, f = −k·(|d| − r) − c·d|d|/dt along the bond.
#[derive(Debug, Clone)]
struct DampedSpring {
    /// Stiffness k, ε/σ².
    stiffness: f64,
    /// Damping c, ε·τ/σ².
    damping: f64,
}

/// The implicit midpoint rule for springs: x′ = x + h·(v + v′)/2, v′ = v + h·f((x + x′)/2)/m.
///
/// It is symmetric and keeps linear and angular momentum, and the energy of a linear spring. A vibration of ω turns by
/// 2·atan(ωh/2) in a step. The dashpot has the mean rate ū·(d′ − d)/h of the step, and takes c·(ū·(d′ − d))²/h.
#[derive(Debug, Clone)]
struct Midpoint(DampedSpring);

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
struct LinearlyImplicit(DampedSpring);

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
