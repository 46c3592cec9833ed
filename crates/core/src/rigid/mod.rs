//! Rigid bonds at one instant: velocities without a part along the bonds, multipliers, and their virial.
//!
//! Notation: bond c joins sites i and j; d = x_j − x_i, w = v_j − v_i, κ = 1/m_i + 1/m_j.
//! The constraint is σ = ½(|d|² − r²) with the row G = (−d at i, +d at j). The force on j is λ·d, with λ in ε/σ².
//! The matrix A = G·M⁻¹·Gᵀ has A_cc = κ_c·|d_c|² and A_cd = ±d_c·d_d/m_shared for bonds that share a site: + where both
//! leave it or both enter it.

mod chains;
mod equations;

pub use chains::InverseMasses;
pub use equations::{BondEquations, Tridiagonal};

use std::ops::Range;

use chains::Project;

use crate::exact::{exact_sum, exact_sums};
use crate::lanes::in_lanes;
use crate::molecules::MOLECULES_PER_TASK;
use crate::moves::kick;
use crate::tasks::for_each_item;
use crate::topology::Topology;
use crate::{DMat3, DVec3, Masses, State, System};

/// Writes the bond vectors d of a molecule with its sites at `sites`.
pub fn bond_vectors(topology: &Topology, sites: &[DVec3], to: &mut Vec<DVec3>) {
    to.clear();
    to.extend(topology.bonds().iter().map(|bond| bond.vector(sites)));
}

/// Adds M⁻¹·Gᵀ·`multipliers` to one vector per site of a molecule.
pub fn add_along_bonds(
    to: &mut [DVec3],
    topology: &Topology,
    masses: &Masses,
    first: usize,
    bonds: &[DVec3],
    multipliers: &[f64],
) {
    let all = topology.bonds().iter().zip(bonds).zip(multipliers);
    for ((bond, d), multiplier) in all {
        let [i, j] = bond.sites;
        let along = *multiplier * *d;
        to[i] -= along / masses.of(first + i);
        to[j] += along / masses.of(first + j);
    }
}

/// Memory for the equations of one molecule after another.
#[derive(Debug, Default)]
struct Workspace {
    equations: Option<BondEquations>,
    bonds: Vec<DVec3>,
    right: Vec<f64>,
    /// Accelerations of the sites.
    total: Vec<DVec3>,
}

/// Takes the part along the bonds off velocities: v ← v − M⁻¹Gᵀ·A⁻¹·Gv, after which d·w = 0 for each bond.
///
/// It is the velocity stage of RATTLE (H. C. Andersen, J. Comput. Phys. 52, 24 (1983)), solved exactly for each molecule.
/// Nothing is done where bonds are not rigid.
pub fn project_velocities(system: &System, positions: &[DVec3], velocities: &mut [DVec3]) {
    on_rigid_molecules(system, positions, velocities, |_, _| {});
}

/// The kick v ← v + (h/m)·F and then [`project_velocities`], in one pass over memory.
pub fn kick_and_project(
    system: &System,
    positions: &[DVec3],
    velocities: &mut [DVec3],
    forces: &[DVec3],
    h: f64,
) {
    on_rigid_molecules(system, positions, velocities, |first, v| {
        kick(&system.masses, first, v, &forces[first..], h);
    });
}

/// Changes the velocities of each rigid molecule by `before(first site, velocities)`, and then takes the part along the bonds off.
fn on_rigid_molecules(
    system: &System,
    positions: &[DVec3],
    velocities: &mut [DVec3],
    before: impl Fn(usize, &mut [DVec3]) + Sync,
) {
    let molecules = &system.molecules;
    let Some(topology) = molecules.topology().filter(|_| molecules.are_rigid()) else {
        return;
    };
    let sites = topology.sites();
    let size = sites * MOLECULES_PER_TASK;
    let tasks = velocities.chunks_mut(size).zip(positions.chunks(size));
    for_each_item(tasks, |space: &mut Workspace, task, (v, x)| {
        let (masses, first) = (&system.masses, task * size);
        if topology.is_chain() {
            return in_lanes(Project { before: &before, sites, masses, first, x, v });
        }
        before(first, v);
        let both = v.chunks_exact_mut(sites).zip(x.chunks_exact(sites));
        for (m, (v, x)) in both.enumerate() {
            space.project(topology, masses, first + m * sites, x, v);
        }
    });
}

impl Workspace {
    fn project(
        &mut self,
        topology: &Topology,
        masses: &Masses,
        first: usize,
        x: &[DVec3],
        v: &mut [DVec3],
    ) {
        bond_vectors(topology, x, &mut self.bonds);
        let equations = equations_of(&mut self.equations, topology);
        let factored = equations.factor(topology, masses, first, &self.bonds, 0.0);
        // The start refuses bonds that follow from others: the matrix of all others is positive definite.
        if factored.is_err() {
            return;
        }
        self.right.clear();
        let all = topology.bonds().iter().zip(&self.bonds);
        self.right.extend(all.map(|(bond, d)| {
            let [i, j] = bond.sites;
            -d.dot(v[j] - v[i])
        }));
        equations.solve(topology, &mut self.right);
        add_along_bonds(v, topology, masses, first, &self.bonds, &self.right);
    }
}

/// The equations of a topology, made at the first use.
pub fn equations_of<'a>(
    held: &'a mut Option<BondEquations>,
    topology: &Topology,
) -> &'a mut BondEquations {
    held.get_or_insert_with(|| BondEquations::new(topology))
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
    pub const NOTHING: Self =
        Self { virial: DMat3::ZERO, squared_forces: 0.0, largest_residual: 0.0 };
}

/// The sums of the instantaneous constraint forces, which belong to positions, velocities and forces of the state:
/// A·λ = −(G·M⁻¹·F + |w|²).
///
/// The multipliers inside a step differ from these by terms of order h, with opposite signs in the two halves.
#[must_use]
pub fn constraint_sums(system: &System, state: &State) -> ConstraintSums {
    let molecules = &system.molecules;
    let Some(topology) = molecules.topology().filter(|_| molecules.are_rigid()) else {
        return ConstraintSums::NOTHING;
    };
    let (sums, residuals) = exact_sums(system.n_molecules(), |range, sums| {
        let (mut space, mut largest) = (Workspace::default(), 0.0_f64);
        for m in range {
            let found = space.sums(topology, system, state, molecules.sites_of(m));
            let mut terms = [found.squared_forces; 10];
            terms[1..].copy_from_slice(&found.virial.to_cols_array());
            sums.add(terms);
            largest = largest.max(found.largest_residual);
        }
        largest
    });
    let [squared_forces, virial @ ..] = sums.values();
    ConstraintSums {
        virial: DMat3::from_cols_array(&virial),
        squared_forces,
        largest_residual: residuals.into_iter().fold(0.0, f64::max),
    }
}

impl Workspace {
    fn sums(
        &mut self,
        topology: &Topology,
        system: &System,
        state: &State,
        sites: Range<usize>,
    ) -> ConstraintSums {
        let (masses, first) = (&system.masses, sites.start);
        let v = &state.velocities[sites.clone()];
        bond_vectors(topology, &state.positions[sites.clone()], &mut self.bonds);
        self.total.clear();
        let forces = state.forces[sites].iter().enumerate();
        self.total.extend(forces.map(|(k, f)| *f / masses.of(first + k)));
        self.right.clear();
        let total = &self.total;
        let all = topology.bonds().iter().zip(&self.bonds);
        self.right.extend(all.map(|(bond, d)| {
            let [i, j] = bond.sites;
            -(d.dot(total[j] - total[i]) + (v[j] - v[i]).length_squared())
        }));
        let equations = equations_of(&mut self.equations, topology);
        let factored = equations.factor(topology, masses, first, &self.bonds, 0.0);
        if factored.is_err() {
            return ConstraintSums { squared_forces: f64::NAN, ..ConstraintSums::NOTHING };
        }
        equations.solve(topology, &mut self.right);
        add_along_bonds(&mut self.total, topology, masses, first, &self.bonds, &self.right);
        let mut sums = ConstraintSums::NOTHING;
        let all = topology.bonds().iter().zip(&self.bonds);
        for ((bond, d), multiplier) in all.zip(&self.right) {
            let scaled = *multiplier * *d;
            sums.virial += DMat3::from_cols(scaled * d.x, scaled * d.y, scaled * d.z);
            let residual = (d.length() / bond.length - 1.0).abs();
            sums.largest_residual = sums.largest_residual.max(residual);
        }
        let total = self.total.iter().enumerate();
        sums.squared_forces =
            total.map(|(k, a)| masses.moving(first + k) * a.length_squared()).sum();
        sums
    }
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
    exact_sum(positions.len() / molecules.sites(), |m| {
        let sites = molecules.sites_of(m);
        let x = &positions[sites.clone()];
        let center = molecules.center(&system.masses, sites.start, x);
        let both = x.iter().zip(&forces[sites]);
        both.map(|(r, f)| (*r - center).dot(*f)).sum::<f64>()
    })
}
