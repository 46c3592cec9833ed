//! Several ranks in one run. Each keeps the particles of some consecutive numbers. Rank 0 writes and prints, and the others take the same
//! steps beside it.
//!
//! Clocks and signals differ between ranks, and no rank may act by its own. After some steps all ranks therefore agree
//! whether to stop, and whether a checkpoint is due ([`agree`]). All else is computed alike from the same sums.

use std::hash::{DefaultHasher, Hash, Hasher};

use lennard_core::{Array, Own, Persist, SpeedLimit, StateArchive, Team};
use lennard_io::RanksRecord;

use crate::error::RanksError;
use crate::failure::LARGEST_MOVE;
use crate::follower::Ending;
use crate::{EngineError, Simulation, build, watchdog};

/// The fewest particles that ranks share: below, a cut would lie nearer than the cutoff.
const FEWEST: usize = 4000;
/// The most: numbers of particles have 32 bits, and positions as many for each side of the box.
const MOST: usize = 1_000_000_000;

impl Simulation {
    /// Shares the run with the other ranks of a team, which have the same simulation. Every rank has to call it, and keeps some of
    /// the particles from then on.
    ///
    /// # Errors
    /// [`EngineError::Ranks`] where the ranks do not have the same simulation, or are more than can be kept busy;
    /// [`EngineError::Scene`] for what one process alone can run.
    pub fn share(&mut self, team: &Team) -> Result<(), EngineError> {
        self.can_be_shared(team)?;
        let mut archive = StateArchive::default();
        Persist::save(self, &mut archive.writer());
        let own = Own::of_rank(team, self.system.len());
        keep(&own, &mut archive);
        self.system = self.system.clone().keeping(own.clone());
        self.forces.keep(&own);
        let limit = SpeedLimit { every: watchdog::EVERY, largest: LARGEST_MOVE };
        let shares = self.forces.share(team, limit).map_err(RanksError::from)?;
        assert!(shares, "a scene for ranks has lists");
        self.observers = build::observers(&self.scene, self.start_cell, &self.system, &self.own)?;
        self.restore(&archive.reader()).expect("it was saved just now");
        Ok(())
    }

    /// Refuses ranks that have another simulation, and scenes that ranks do not run.
    fn can_be_shared(&self, team: &Team) -> Result<(), EngineError> {
        let same = |what, advice, hash: u64| match team.first_that_differs(&[hash]) {
            None => Ok(()),
            Some(rank) => Err(RanksError::Differs { rank, what, advice }),
        };
        let scene = (env!("CARGO_PKG_VERSION"), self.scene.resolved_toml());
        same("scene or version of the program", "", hash_of(&scene))?;
        let advice = "\n  one that all have: --isa avx2 or --isa portable";
        same("instruction set", advice, hash_of(&self.isa))?;
        let particles = self.system.len();
        if !(FEWEST..=MOST).contains(&particles) {
            return Err(RanksError::Particles { particles, fewest: FEWEST, most: MOST }.into());
        }
        Ok(self.scene.check_for_ranks()?)
    }

    /// What the ranks did, where there are several, in a run that took so many seconds.
    pub(crate) fn ranks_record(&self, seconds: f64) -> Option<RanksRecord> {
        let team = self.team()?;
        let statistics = team.statistics();
        Some(RanksRecord {
            ranks: team.ranks() as u64,
            communication: statistics.seconds / seconds,
            halo: statistics.halo,
        })
    }
}

fn hash_of(value: &impl Hash) -> u64 {
    // Its keys are constants, so that it gives all ranks the same.
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// Whether an array of a saved run has a vector for each particle.
pub(crate) fn is_of_particles(name: &str) -> bool {
    ["state/", "forces/", "method/"].iter().any(|section| name.starts_with(section))
}

/// Leaves the particles of others out of the arrays of a saved run.
fn keep(own: &Own, archive: &mut StateArchive) {
    for (name, array) in &mut archive.arrays {
        if let Array::Vec3(all) = array
            && is_of_particles(name)
            && !all.is_empty()
        {
            *all = all[own.numbers()].to_vec();
        }
    }
}

/// Makes the arrays of a saved run whole on rank 0.
pub(crate) fn collect(own: &Own, archive: &mut StateArchive) {
    for (name, array) in &mut archive.arrays {
        if let Array::Vec3(here) = array
            && is_of_particles(name)
        {
            *here = own.collect_vectors(here);
        }
    }
}

/// What rank 0 made or wrote. Where it failed, the other ranks fail too.
pub(crate) fn made<T>(own: &Own, made: Result<T, EngineError>) -> Result<T, EngineError> {
    let failed = own.team().is_some_and(|team| team.any(made.is_err()));
    match made {
        Ok(_) if failed => Err(RanksError::Stopped.into()),
        made => made,
    }
}

/// What a rank wishes after some steps, or all ranks together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// Whether and why to stop.
    pub stop: Option<Ending>,
    /// Whether the time between two checkpoints is over.
    pub checkpoint: bool,
}

/// What all ranks decide: a request to any rank stops all, and so does any clock. One process decides for itself.
pub(crate) fn agree(simulation: &Simulation, own: Decision) -> Decision {
    let Some(team) = simulation.team() else {
        return own;
    };
    let is = |ending| u64::from(own.stop == Some(ending));
    let mut words = [is(Ending::Stopped), is(Ending::OutOfTime), u64::from(own.checkpoint)];
    team.max(&mut words);
    let [stopped, out_of_time, checkpoint] = words.map(|word| word > 0);
    let stop =
        if stopped { Some(Ending::Stopped) } else { out_of_time.then_some(Ending::OutOfTime) };
    Decision { stop, checkpoint }
}
