//! What all ways share that act on one molecule after another: the kick and the drift, and the loop over molecules.

use lennard_core::moves;
use lennard_core::rigid::{self, BondEquations};
use lennard_core::tasks::map_items;
use lennard_core::{
    BondSolver, BoundDrift, DVec3, Drifted, MOLECULES_PER_TASK, Masses, StepError, System, Topology,
};

/// One molecule after a drift.
pub struct MovedMolecule<'a> {
    /// Its bonds.
    pub topology: &'a Topology,
    /// Masses of all particles.
    pub masses: &'a Masses,
    /// The particle that is its first site.
    pub first: usize,
    /// Bond vectors before the drift, σ.
    pub before: &'a [DVec3],
    /// Positions of the sites, σ.
    pub sites: &'a mut [DVec3],
    /// The corrections of the sites so far, σ. A difference of positions would lose digits far from the origin.
    pub moved: &'a mut [DVec3],
    /// The time of the drift, τ.
    pub h: f64,
}

/// Why a molecule has no solution.
pub enum NoSolution {
    /// A bond turned too far: its number, and the part of it across its old direction, σ.
    Turned(usize, f64),
    /// Too many iterations: their number, the residual reached and the residual wanted.
    NotConverged(u32, f64, f64),
}

impl NoSolution {
    /// The error for bond `c`, which has the vector `d` before the drift and `s` after it.
    pub fn turned(c: usize, d: DVec3, s: DVec3) -> Self {
        let along = d.normalize_or_zero();
        Self::Turned(c, (s - s.dot(along) * along).length())
    }
}

impl MovedMolecule<'_> {
    /// The largest | |d|/r − 1 |.
    pub fn residual(&self) -> f64 {
        let bonds = self.topology.bonds().iter();
        // A residual that is no number must not look small.
        bonds
            .map(|bond| (bond.vector(self.sites).length() / bond.length - 1.0).abs())
            .fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a })
    }

    /// Repeats a step until all bonds have their length within a tolerance, `most` times at most.
    ///
    /// # Errors
    /// [`NoSolution`] where a step has none, or the steps end early.
    pub fn until(
        &mut self,
        tolerance: f64,
        most: u32,
        mut step: impl FnMut(&mut Self) -> Result<(), NoSolution>,
    ) -> Result<Drifted, NoSolution> {
        for iterations in 0..=most {
            let residual = self.residual();
            if residual <= tolerance {
                return Ok(Drifted { iterations, residual, ..Drifted::default() });
            }
            step(self)?;
        }
        Err(NoSolution::NotConverged(most, self.residual(), tolerance))
    }

    /// Moves a site.
    pub fn displace(&mut self, site: usize, by: DVec3) {
        self.sites[site] += by;
        self.moved[site] += by;
    }

    /// The error for bond `c`, which has the vector `s` after the drift.
    pub fn turned(&self, c: usize, s: DVec3) -> NoSolution {
        NoSolution::turned(c, self.before[c], s)
    }
}

/// Memory of one thread for one molecule after another.
#[derive(Debug, Default)]
pub struct Space {
    before: Vec<DVec3>,
    moved: Vec<DVec3>,
    /// Bond vectors of an iterate.
    pub bonds: Vec<DVec3>,
    /// One number per bond.
    pub right: Vec<f64>,
    /// One number per bond.
    pub multipliers: Vec<f64>,
    /// One vector per site.
    pub by: Vec<DVec3>,
    /// The symmetric equations of a molecule.
    pub equations: Option<BondEquations>,
    /// The equations of Newton's method for a chain, which are not symmetric.
    pub tridiagonal: Option<Box<rigid::Tridiagonal>>,
}

/// How one molecule gets its bonds back.
pub trait MoleculeRule: Send + Sync {
    /// Brings the bonds of a molecule to where they belong; returns what it took.
    ///
    /// # Errors
    /// [`NoSolution`] where there is none.
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        space: &mut Space,
    ) -> Result<Drifted, NoSolution>;

    /// As [`BondSolver::has_velocity_stage`].
    fn has_velocity_stage(&self) -> bool {
        true
    }

    /// The energy of the bonds of a molecule with these vectors, for a way that damps; `None` for others.
    ///
    /// What the drift changes of it and of the kinetic energy counts as heat.
    fn damped_energy(&self, topology: &Topology, bonds: &[DVec3]) -> Option<f64> {
        let _ = (topology, bonds);
        None
    }

    /// How many times the displacement over h the velocity changes by.
    fn velocity_factor(&self) -> f64 {
        1.0
    }
}

/// A rule for all molecules.
#[derive(Debug, Clone)]
pub struct EachMolecule<R>(pub R);

/// What the molecules of some tasks took, and the first that failed.
#[derive(Default)]
pub struct Outcome {
    solved: Drifted,
    failed: Option<(usize, NoSolution)>,
}

impl Outcome {
    /// Counts a molecule that was solved.
    #[inline]
    pub fn solved(&mut self, solved: Drifted) {
        self.solved.iterations = self.solved.iterations.max(solved.iterations);
        self.solved.residual = self.solved.residual.max(solved.residual);
        self.solved.heat += solved.heat;
    }

    /// Counts a molecule that has no solution; the one with the lowest number stays, whichever thread is first.
    pub fn failed(&mut self, molecule: usize, why: NoSolution) {
        if self.failed.as_ref().is_none_or(|(m, _)| molecule < *m) {
            self.failed = Some((molecule, why));
        }
    }

    fn join(&mut self, other: Self) {
        self.solved(other.solved);
        if let Some((molecule, why)) = other.failed {
            self.failed(molecule, why);
        }
    }

    /// What all molecules took, or why the first that failed did.
    ///
    /// # Errors
    /// [`StepError`] where a molecule has no solution.
    pub fn finish(self, topology: &Topology) -> Result<Drifted, StepError> {
        match self.failed {
            None => Ok(self.solved),
            Some((m, NoSolution::Turned(bond, found))) => Err(StepError::BondTurned {
                molecule: m + 1,
                bond: bond + 1,
                found,
                length: topology.bonds()[bond].length,
            }),
            Some((m, NoSolution::NotConverged(iterations, residual, wanted))) => {
                Err(StepError::BondsNotConverged { molecule: m + 1, iterations, residual, wanted })
            }
        }
    }
}

/// One task of molecules under way.
pub struct TaskOf<'a> {
    /// The number of its first molecule.
    pub first_molecule: usize,
    /// The drift of its sites.
    pub drift: BoundDrift<'a>,
}

impl<'a> TaskOf<'a> {
    /// Its molecules of `sites` sites after their kick, each with its number: positions and velocities.
    pub fn kicked(
        self,
        masses: &'a Masses,
        sites: usize,
    ) -> impl Iterator<Item = (usize, &'a mut [DVec3], &'a mut [DVec3])> {
        let BoundDrift { positions, velocities, forces, kick, .. } = self.drift;
        let of_each = (positions.chunks_exact_mut(sites))
            .zip(velocities.chunks_exact_mut(sites))
            .zip(forces.chunks_exact(sites));
        (self.first_molecule..).zip(of_each).map(move |(m, ((x, v), f))| {
            if let Some(kick) = kick {
                moves::kick(masses, m * sites, v, f, kick);
            }
            (m, x, v)
        })
    }
}

/// Runs `work` on all molecules, in tasks, and joins the outcomes.
pub fn over_tasks(
    system: &System,
    moving: BoundDrift<'_>,
    work: impl Fn(&mut Space, &Topology, TaskOf<'_>, &mut Outcome) + Sync,
) -> Result<Drifted, StepError> {
    let Some(topology) = system.molecules.topology() else {
        return Ok(Drifted::default());
    };
    let size = topology.sites() * MOLECULES_PER_TASK;
    let (kick, h) = (moving.kick, moving.h);
    let tasks = moving
        .positions
        .chunks_mut(size)
        .zip(moving.velocities.chunks_mut(size))
        .zip(moving.forces.chunks(size));
    let outcomes =
        map_items(tasks, |space: &mut Space, task, ((positions, velocities), forces)| {
            let mut outcome = Outcome::default();
            let drift = BoundDrift { positions, velocities, forces, kick, h };
            let task = TaskOf { first_molecule: task * MOLECULES_PER_TASK, drift };
            work(space, topology, task, &mut outcome);
            outcome
        });
    // In their order, so that sums have the same bits on any number of threads.
    let mut total = Outcome::default();
    outcomes.into_iter().for_each(|outcome| total.join(outcome));
    total.finish(topology)
}

fn kinetic_energy(masses: &Masses, first: usize, v: &[DVec3]) -> f64 {
    let sites = v.iter().enumerate();
    sites.map(|(k, v)| 0.5 * masses.moving(first + k) * v.length_squared()).sum()
}

impl<R: MoleculeRule> BondSolver for EachMolecule<R> {
    fn has_velocity_stage(&self) -> bool {
        self.0.has_velocity_stage()
    }

    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError> {
        let (rule, masses) = (&self.0, &system.masses);
        over_tasks(system, moving, |space, topology, task, outcome| {
            let (sites, h) = (topology.sites(), task.drift.h);
            for (m, x, v) in task.kicked(masses, sites) {
                let first = m * sites;
                let (mut before, mut moved) =
                    (std::mem::take(&mut space.before), std::mem::take(&mut space.moved));
                rigid::bond_vectors(topology, x, &mut before);
                moved.clear();
                moved.resize(sites, DVec3::ZERO);
                let energy_before = rule
                    .damped_energy(topology, &before)
                    .map(|energy| energy + kinetic_energy(masses, first, v));
                moves::drift(x, v, h);
                let mut molecule = MovedMolecule {
                    topology,
                    masses,
                    first,
                    before: &before,
                    sites: x,
                    moved: &mut moved,
                    h,
                };
                match rule.solve(&mut molecule, space) {
                    Ok(mut solved) => {
                        let rate = rule.velocity_factor() / h;
                        for (v, moved) in v.iter_mut().zip(&moved) {
                            *v += rate * *moved;
                        }
                        if let Some(energy_before) = energy_before {
                            rigid::bond_vectors(topology, x, &mut space.bonds);
                            let energy = rule.damped_energy(topology, &space.bonds);
                            let energy = energy.unwrap_or(0.0) + kinetic_energy(masses, first, v);
                            solved.heat = energy - energy_before;
                        }
                        outcome.solved(solved);
                    }
                    Err(why) => outcome.failed(m, why),
                }
                (space.before, space.moved) = (before, moved);
            }
        })
    }
}
