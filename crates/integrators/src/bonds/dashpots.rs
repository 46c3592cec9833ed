//! Dashpots beside springs that are forces: what they take of velocities before and after a drift.

use lennard_core::moves;
use lennard_core::{Bond, BondSolver, BoundDrift, DVec3, Drifted, Masses, StepError, System};

use super::molecule::over_tasks;

/// Dashpots −c·u·(u·w) along the bonds, with the unit vector u of a bond and w = v_j − v_i. They act half before a drift and half after it.
///
/// With κ = 1/m_i + 1/m_j, the speed u·w along one bond decays by e^{−c·κ·h/2} in each half: the decay is exact. Bonds that share
/// a site follow each other, forward before the drift and backward after it, so that a step is symmetric. A step of one
/// linear spring has the determinant g² = e^{−c·κ·h} and the trace 1 + g² − g·(ωh)². It is stable for (ωh)² < 2·(g + 1/g), which no
/// damping makes less than 4.
#[derive(Debug, Clone)]
pub struct Dashpots {
    /// Damping c, ε·τ/σ².
    pub damping: f64,
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
            let (sites, kick, h) = (topology.sites(), task.kick, task.h);
            for (m, (x, v, f)) in task.molecules(sites) {
                let first = m * sites;
                if let Some(kick) = kick {
                    moves::kick(masses, first, v, f, kick);
                }
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
