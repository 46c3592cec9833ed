//! What rigid ways share: the bonds before a drift, and the loop over molecules.

use std::sync::Mutex;

use lennard_core::tasks::for_each_item;
use lennard_core::{
    BondSolver, BondsSolved, DVec3, MOLECULES_PER_TASK, MOST_SITES, Masses, StepError, System,
};

/// One chain after a drift.
pub struct Chain<'a> {
    /// Masses of all particles.
    pub masses: &'a Masses,
    /// The particle that is its first site.
    pub first: usize,
    /// Length r of each bond, σ.
    pub length: f64,
    /// Bond vectors before the drift, σ.
    pub before: &'a [DVec3],
    /// Positions of the sites, σ.
    pub sites: &'a mut [DVec3],
    /// The corrections of the sites so far, σ. A difference of positions would lose digits far from the origin.
    pub moved: &'a mut [DVec3],
}

/// Why a chain has no solution.
pub enum ChainError {
    /// A bond turned too far: its number, and the part of it across its old direction, σ.
    Turned(usize, f64),
    /// Too many iterations: their number, the residual reached and the residual wanted.
    NotConverged(u32, f64, f64),
}

impl Chain<'_> {
    /// The largest | |d|/r − 1 |.
    pub fn residual(&self) -> f64 {
        let off = |pair: &[DVec3]| ((pair[1] - pair[0]).length() / self.length - 1.0).abs();
        // A residual that is no number must not look small.
        self.sites
            .windows(2)
            .map(off)
            .fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a })
    }

    /// Moves a site.
    pub fn displace(&mut self, site: usize, by: DVec3) {
        self.sites[site] += by;
        self.moved[site] += by;
    }

    /// The error for bond `c`, which has the vector `s` after the drift.
    pub fn turned(&self, c: usize, s: DVec3) -> ChainError {
        let along = self.before[c].normalize_or_zero();
        ChainError::Turned(c, (s - s.dot(along) * along).length())
    }
}

/// How one chain gets its bond lengths back.
pub trait ChainRule: Send + Sync {
    /// Brings the bonds of a chain back to their length; returns the iterations.
    ///
    /// # Errors
    /// [`ChainError`] where there is no solution.
    fn solve(&self, chain: &mut Chain<'_>) -> Result<u32, ChainError>;

    /// As [`BondSolver::has_velocity_stage`].
    fn has_velocity_stage(&self) -> bool {
        true
    }
}

/// A rule for all molecules, with their bond vectors before a drift.
#[derive(Debug, Clone)]
pub struct Chains<R> {
    rule: R,
    before: Vec<DVec3>,
}

impl<R: ChainRule> Chains<R> {
    /// The rule, before the first drift.
    pub fn new(rule: R) -> Self {
        Self {
            rule,
            before: Vec::new(),
        }
    }
}

impl<R: ChainRule> BondSolver for Chains<R> {
    fn before_drift(&mut self, system: &System, positions: &[DVec3]) {
        let molecules = &system.molecules;
        let bonds = molecules.bonds();
        self.before
            .resize(system.n_molecules() * bonds, DVec3::ZERO);
        molecules.for_each(bonds, &mut self.before, |m, before| {
            let sites = &positions[molecules.sites_of(m)];
            for (d, pair) in before.iter_mut().zip(sites.windows(2)) {
                *d = pair[1] - pair[0];
            }
        });
    }

    fn has_velocity_stage(&self) -> bool {
        self.rule.has_velocity_stage()
    }

    fn after_drift(
        &mut self,
        system: &System,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        h: f64,
    ) -> Result<BondsSolved, StepError> {
        let molecules = &system.molecules;
        let (sites, bonds) = (molecules.sites(), molecules.bonds());
        let total = Mutex::new((BondsSolved::default(), None::<(usize, ChainError)>));
        let size = sites * MOLECULES_PER_TASK;
        let tasks = positions
            .chunks_mut(size)
            .zip(velocities.chunks_mut(size))
            .zip(self.before.chunks(bonds * MOLECULES_PER_TASK));
        for_each_item(tasks, |(), task, ((positions, velocities), before)| {
            let mut solved = BondsSolved::default();
            let mut failed = None;
            let chains = positions
                .chunks_exact_mut(sites)
                .zip(velocities.chunks_exact_mut(sites))
                .zip(before.chunks_exact(bonds));
            for (m, ((x, v), before)) in chains.enumerate() {
                let m = task * MOLECULES_PER_TASK + m;
                let mut moved = [DVec3::ZERO; MOST_SITES];
                let mut chain = Chain {
                    masses: &system.masses,
                    first: m * sites,
                    length: molecules.bond_length(),
                    before,
                    sites: x,
                    moved: &mut moved[..sites],
                };
                match self.rule.solve(&mut chain) {
                    Ok(iterations) => {
                        solved.iterations = solved.iterations.max(iterations);
                        solved.residual = solved.residual.max(chain.residual());
                        for (v, moved) in v.iter_mut().zip(&moved) {
                            *v += *moved / h;
                        }
                    }
                    Err(e) => {
                        failed = failed.or(Some((m, e)));
                    }
                }
            }
            let mut total = total.lock().expect("no thread panics while it holds this");
            total.0.iterations = total.0.iterations.max(solved.iterations);
            total.0.residual = total.0.residual.max(solved.residual);
            // The molecule with the lowest number, whichever thread is first.
            if let Some((m, e)) = failed
                && total.1.as_ref().is_none_or(|(first, _)| m < *first)
            {
                total.1 = Some((m, e));
            }
        });
        let (solved, failed) = total
            .into_inner()
            .expect("no thread panicked while it held this");
        match failed {
            None => Ok(solved),
            Some((m, ChainError::Turned(bond, found))) => Err(StepError::BondTurned {
                molecule: m + 1,
                bond: bond + 1,
                found,
                length: molecules.bond_length(),
            }),
            Some((m, ChainError::NotConverged(iterations, residual, wanted))) => {
                Err(StepError::BondsNotConverged {
                    molecule: m + 1,
                    iterations,
                    residual,
                    wanted,
                })
            }
        }
    }
}
