//! Bonds as the regularised, damped constraints of SPOOK.

use lennard_core::options::OptionError;
use lennard_core::rigid::{MOLECULES_PER_TASK, Tridiagonal, add_along_bonds, bond_vectors};
use lennard_core::tasks::for_each_item;
use lennard_core::{Bonds, DVec3, MOST_BONDS, Molecules, System};

use super::{BondHolder, BondMethod, BondSpec};
use crate::spook::Regularisation;

lennard_core::options! {
    /// Options of SPOOK's bonds.
    pub struct Options {
        /// Compliance ε, the inverse of a stiffness; 0 is rigid.
        compliance: f64 = 0.0, NotNegative, in "σ²/ε";
        /// Damping time τ over the time step; 2 is critical damping for rigid bonds.
        damping_steps: f64 = 2.0, NotNegative;
        /// Damping time τ, in place of a number of steps.
        damping_time: Option<f64> = None, else "`damping_steps`·`dt`", NotNegative, in "τ";
    }
}

impl Options {
    /// The damping time τ for a step.
    fn damping(&self, dt: f64) -> f64 {
        self.damping_time.unwrap_or(self.damping_steps * dt)
    }
}

impl BondMethod for Options {
    const SPEC: BondSpec = BondSpec {
        name: "spook",
        summary: "Regularised, damped constraints of SPOOK, solved exactly for each molecule; with the integrator `spook` alone.",
        equations: "g = |d| - r; S L = -(4/h) y g + y G v - G (v + h f/m), S = G M^-1 G^T + (4/h^2) eps y, y = 1/(1 + 4 tau/h); v' = v + h f/m + M^-1 G^T L",
        bonds: Bonds::Rigid,
        source: "Lacoursière, \"Ghosts and Machines: Regularized Variational Methods for Interactive Simulations of Multibodies with Dry Frictional Contacts\", PhD thesis, Umeå University (2007), the SPOOK stepper",
    };

    fn bonds(&self) -> Bonds {
        match self.compliance > 0.0 {
            true => Bonds::Springs,
            false => Bonds::Rigid,
        }
    }

    fn build(&self, _molecules: &Molecules) -> BondHolder {
        BondHolder::Spook(SpookBonds {
            options: self.clone(),
            rates: Vec::new(),
        })
    }

    /// Without compliance and damping the one-step map of a rigid bond is a Jordan block: |x_n| grows as 2n + 1.
    fn check_together(&self) -> Result<(), OptionError> {
        let undamped = self.damping_time.unwrap_or(self.damping_steps) == 0.0;
        if self.compliance == 0.0 && undamped {
            return Err(OptionError {
                key: "compliance",
                found: "0 without damping, which is unstable: errors grow with each step"
                    .to_owned(),
                allowed: "damping_steps of at least 0.5, or a compliance above 0".to_owned(),
            });
        }
        Ok(())
    }
}

/// The bonds of molecules for [`crate::spook::Spook`].
#[derive(Debug, Clone)]
pub struct SpookBonds {
    options: Options,
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
    /// Remembers G·v before a kick.
    pub(crate) fn before_kick(&mut self, system: &System, x: &[DVec3], v: &[DVec3]) {
        let molecules = &system.molecules;
        let (sites, bonds) = (molecules.sites(), molecules.bonds());
        self.rates.resize(system.n_molecules() * bonds, 0.0);
        let size = sites * MOLECULES_PER_TASK;
        let tasks = self
            .rates
            .chunks_mut(bonds * MOLECULES_PER_TASK)
            .zip(x.chunks(size).zip(v.chunks(size)));
        for_each_item(tasks, |(), _, (rates, (x, v))| {
            let chains = x.chunks_exact(sites).zip(v.chunks_exact(sites));
            for (rates, (x, v)) in rates.chunks_exact_mut(bonds).zip(chains) {
                let mut units = [DVec3::ZERO; MOST_BONDS];
                let units = directions(x, &mut units);
                for (c, rate) in rates.iter_mut().enumerate() {
                    *rate = units[c].dot(v[c + 1] - v[c]);
                }
            }
        });
    }

    /// Adds the impulses of the constraints to velocities that have had their kick.
    pub(crate) fn after_kick(&self, system: &System, x: &[DVec3], v: &mut [DVec3], dt: f64) {
        let (molecules, masses) = (&system.molecules, &system.masses);
        let (sites, bonds) = (molecules.sites(), molecules.bonds());
        let length = molecules.bond_length();
        let Regularisation { sigma, gamma } =
            Regularisation::new(self.options.compliance, self.options.damping(dt), dt);
        let size = sites * MOLECULES_PER_TASK;
        let tasks = v
            .chunks_mut(size)
            .zip(x.chunks(size))
            .zip(self.rates.chunks(bonds * MOLECULES_PER_TASK));
        for_each_item(tasks, |(), task, ((v, x), rates)| {
            let chains = v.chunks_exact_mut(sites).zip(x.chunks_exact(sites));
            for (m, ((v, x), rates)) in chains.zip(rates.chunks_exact(bonds)).enumerate() {
                let first = task * size + m * sites;
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
            }
        });
    }
}
