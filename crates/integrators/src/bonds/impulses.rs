//! The impulses that SPOOK gives to the sites of molecules.

use lennard_core::rigid::{Tridiagonal, add_along_bonds, bond_vectors};
use lennard_core::{DVec3, MOST_BONDS, System};

use crate::regularisation::Regularisation;

/// The damping of constraints.
#[derive(Debug, Clone, Copy)]
pub enum Damping {
    /// A time τ.
    Time(f64),
    /// A number of time steps.
    Steps(f64),
}

/// The bonds of molecules, for the method that solves for them in its step.
#[derive(Debug, Clone)]
pub struct SpookBonds {
    compliance: f64,
    damping: Damping,
    /// G·v before the kick, one number per bond.
    rates: Vec<f64>,
}

/// Writes the directions u = d/|d| of the bonds of a chain and returns those that there are.
fn directions<'a>(sites: &[DVec3], to: &'a mut [DVec3; MOST_BONDS]) -> &'a [DVec3] {
    let bonds = bond_vectors(sites, to).len();
    for d in &mut to[..bonds] {
        *d = d.normalize();
    }
    &to[..bonds]
}

impl SpookBonds {
    /// Bonds with a compliance in σ²/ε and a damping.
    pub(super) fn new(compliance: f64, damping: Damping) -> Self {
        Self {
            compliance,
            damping,
            rates: Vec::new(),
        }
    }

    /// Remembers G·v before a kick.
    pub(crate) fn before_kick(&mut self, system: &System, x: &[DVec3], v: &[DVec3]) {
        let molecules = &system.molecules;
        let bonds = molecules.bonds();
        self.rates.resize(system.n_molecules() * bonds, 0.0);
        molecules.for_each(bonds, &mut self.rates, |m, rates| {
            let (x, v) = (&x[molecules.sites_of(m)], &v[molecules.sites_of(m)]);
            let mut units = [DVec3::ZERO; MOST_BONDS];
            let units = directions(x, &mut units);
            for (c, rate) in rates.iter_mut().enumerate() {
                *rate = units[c].dot(v[c + 1] - v[c]);
            }
        });
    }

    /// Adds the impulses of the constraints to velocities that have had their kick.
    pub(crate) fn after_kick(&self, system: &System, x: &[DVec3], v: &mut [DVec3], dt: f64) {
        let (molecules, masses) = (&system.molecules, &system.masses);
        let (bonds, length) = (molecules.bonds(), molecules.bond_length());
        let time = match self.damping {
            Damping::Time(time) => time,
            Damping::Steps(steps) => steps * dt,
        };
        let Regularisation { sigma, gamma } = Regularisation::new(self.compliance, time, dt);
        molecules.for_each(molecules.sites(), v, |m, v| {
            let first = molecules.sites_of(m).start;
            let (x, rates) = (&x[molecules.sites_of(m)], &self.rates[m * bonds..]);
            let mut units = [DVec3::ZERO; MOST_BONDS];
            let units = directions(x, &mut units);
            let mut equations = Tridiagonal::ZERO;
            equations.set_matrix(masses, first, units, units);
            for (c, u) in units.iter().enumerate() {
                equations.diagonal[c] += sigma;
                let g = (x[c + 1] - x[c]).length() - length;
                equations.right[c] = gamma * (rates[c] - 4.0 / dt * g) - u.dot(v[c + 1] - v[c]);
            }
            // S is positive definite for any chain: its rows are independent.
            if equations.solve(bonds).is_ok() {
                add_along_bonds(v, masses, first, units, &equations.right);
            }
        });
    }
}
