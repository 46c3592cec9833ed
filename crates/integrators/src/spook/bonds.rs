//! The impulses that SPOOK gives to the sites of molecules.

use lennard_core::rigid::{BondEquations, add_along_bonds, bond_vectors, equations_of};
use lennard_core::tasks::map_items;
use lennard_core::{DVec3, MOLECULES_PER_TASK, Masses, System, Topology};

use super::{Contact, Damping, Regularisation};

/// The bonds of molecules, for the method that solves for them in its step.
#[derive(Debug, Clone)]
pub struct SpookBonds {
    compliance: f64,
    damping: Damping,
    /// Gauss–Seidel sweeps; 0 solves directly.
    sweeps: u32,
    /// G·v before the kick, one number per bond.
    rates: Vec<f64>,
}

/// Memory of one thread for one molecule after another.
#[derive(Default)]
struct Space {
    units: Vec<DVec3>,
    right: Vec<f64>,
    multipliers: Vec<f64>,
    equations: Option<BondEquations>,
}

/// Writes the directions u = d/|d| of the bonds of a molecule.
fn directions(topology: &Topology, sites: &[DVec3], to: &mut Vec<DVec3>) {
    bond_vectors(topology, sites, to);
    for d in to {
        *d = d.normalize();
    }
}

impl SpookBonds {
    /// Bonds with a compliance in σ²/ε and a damping, solved directly or by a number of sweeps.
    pub(crate) fn new(compliance: f64, damping: Damping, sweeps: u32) -> Self {
        Self { compliance, damping, sweeps, rates: Vec::new() }
    }

    /// The bonds as rows of a problem with contacts: from the first site to the second, with the gap |d| − r.
    pub fn rows(system: &System, x: &[DVec3], to: &mut Vec<Contact>) {
        let molecules = &system.molecules;
        to.clear();
        for m in 0..system.n_molecules() {
            let sites = molecules.sites_of(m);
            let first = sites.start;
            to.extend(molecules.bonds().iter().map(|bond| {
                let d = bond.vector(&x[sites.clone()]);
                let [i, j] = bond.sites.map(|site| first + site);
                Contact {
                    first: Some(i),
                    second: j,
                    normal: d.normalize(),
                    gap: d.length() - bond.length,
                }
            }));
        }
    }

    /// The regularisation of the bonds for a step h.
    #[must_use]
    pub fn regularised(&self, dt: f64) -> Regularisation {
        self.damping.regularised(self.compliance, dt)
    }

    /// Remembers G·v before a kick.
    pub(crate) fn before_kick(&mut self, system: &System, x: &[DVec3], v: &[DVec3]) {
        let molecules = &system.molecules;
        let Some(topology) = molecules.topology() else {
            return;
        };
        let bonds = topology.bonds();
        self.rates.resize(system.n_molecules() * bonds.len(), 0.0);
        molecules.for_each(bonds.len(), &mut self.rates, |m, rates| {
            let (x, v) = (&x[molecules.sites_of(m)], &v[molecules.sites_of(m)]);
            for (bond, rate) in bonds.iter().zip(rates) {
                let [i, j] = bond.sites;
                *rate = bond.vector(x).normalize().dot(v[j] - v[i]);
            }
        });
    }

    /// Adds the impulses of the constraints to velocities that have had their kick; returns the energy put in, 0 or less, ε.
    ///
    /// A bond with a compliance is a spring of 1/ε with a dashpot of τ/ε, whose force −(τ/ε)·u·w′ does its work over h·u·w′.
    pub(crate) fn after_kick(&self, system: &System, x: &[DVec3], v: &mut [DVec3], dt: f64) -> f64 {
        let (molecules, masses) = (&system.molecules, &system.masses);
        let Some(topology) = molecules.topology() else {
            return 0.0;
        };
        let bonds = topology.bonds();
        let regular = self.regularised(dt);
        let sites = topology.sites();
        let dashpot = match self.compliance > 0.0 {
            true => 0.25 * dt * (1.0 / regular.gamma - 1.0) / self.compliance,
            false => 0.0,
        };
        let tasks = v.chunks_mut(sites * MOLECULES_PER_TASK);
        let heats = map_items(tasks, |space: &mut Space, task, velocities| {
            let mut heat = 0.0;
            for (m, v) in velocities.chunks_exact_mut(sites).enumerate() {
                let m = task * MOLECULES_PER_TASK + m;
                let first = m * sites;
                let (x, rates) = (&x[first..first + sites], &self.rates[m * bonds.len()..]);
                directions(topology, x, &mut space.units);
                space.right.clear();
                for ((bond, u), rate) in bonds.iter().zip(&space.units).zip(rates) {
                    let [i, j] = bond.sites;
                    let g = bond.vector(x).length() - bond.length;
                    let wanted = regular.gamma * (*rate - 4.0 / dt * g);
                    space.right.push(wanted - u.dot(v[j] - v[i]));
                }
                let units = &space.units;
                if self.sweeps > 0 {
                    space.multipliers.clear();
                    space.multipliers.resize(bonds.len(), 0.0);
                    let (right, multipliers) = (&space.right, &mut space.multipliers);
                    let sigma = regular.sigma;
                    for _ in 0..self.sweeps {
                        sweep(topology, masses, first, units, sigma, right, multipliers);
                    }
                    add_along_bonds(v, topology, masses, first, units, multipliers);
                } else {
                    let equations = equations_of(&mut space.equations, topology);
                    // S is positive definite: bonds that follow from others are refused where Σ is zero.
                    let factored = equations.factor(topology, masses, first, units, regular.sigma);
                    if factored.is_ok() {
                        equations.solve(topology, &mut space.right);
                        add_along_bonds(v, topology, masses, first, units, &space.right);
                    }
                }
                if dashpot > 0.0 {
                    for (bond, u) in bonds.iter().zip(units) {
                        heat -= dt * dashpot * u.dot(bond.vector(v)).powi(2);
                    }
                }
            }
            heat
        });
        // In their order, so that the sum has the same bits on any number of threads.
        heats.into_iter().sum()
    }
}

/// One Gauss–Seidel sweep over S·λ = `right`, with S = G·M⁻¹·Gᵀ + `sigma` and unit vectors along the bonds.
fn sweep(
    topology: &Topology,
    masses: &Masses,
    first: usize,
    units: &[DVec3],
    sigma: f64,
    right: &[f64],
    multipliers: &mut [f64],
) {
    let inverse = |site: usize| 1.0 / masses.of(first + site);
    for (c, bond) in topology.bonds().iter().enumerate() {
        let [i, j] = bond.sites;
        let mut left = right[c];
        for coupling in topology.couplings_of(c) {
            let other = coupling.bonds[usize::from(coupling.bonds[0] == c)];
            let element = coupling.sign * units[c].dot(units[other]) * inverse(coupling.site);
            left -= element * multipliers[other];
        }
        multipliers[c] = left / (inverse(i) + inverse(j) + sigma);
    }
}
