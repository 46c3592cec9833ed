//! Several ranks in one run. Each keeps the particles of some consecutive numbers. Rank 0 writes and prints, and the others take the same
//! steps beside it.
//!
//! Clocks and signals differ between ranks, and no rank may act by its own. After some steps all ranks therefore agree
//! whether to stop, and whether a checkpoint is due ([`agree`]). All else is computed alike from the same sums.

use std::hash::{DefaultHasher, Hash, Hasher};

use lennard_core::{Backend, Own, PeriodicBox, SpeedLimit, Team};
use lennard_io::RanksRecord;
use lennard_scene::Scene;

use crate::error::RanksError;
use crate::failure::LARGEST_MOVE;
use crate::follower::Ending;
use crate::{EngineError, Simulation, watchdog};

/// The fewest particles that ranks share: below, a cut would lie nearer than the cutoff.
const FEWEST: usize = 4000;
/// The most: numbers of particles have 32 bits, and positions as many for each side of the box.
const MOST: usize = 1_000_000_000;

/// Refuses ranks that have another scene, and scenes that ranks do not run.
pub(crate) fn can_share(scene: &Scene, team: &Team) -> Result<(), EngineError> {
    let what = (env!("CARGO_PKG_VERSION"), scene.resolved_toml());
    same(team, "scene or version of the program", "", &what)?;
    Ok(scene.check_for_ranks()?)
}

/// Refuses ranks that have another instruction set.
pub(crate) fn same_isa(team: &Team, isa: &str) -> Result<(), RanksError> {
    let advice = "\n  one that all have: --isa avx2 or --isa portable";
    same(team, "instruction set", advice, &isa)
}

fn same(
    team: &Team,
    what: &'static str,
    advice: &'static str,
    value: &impl Hash,
) -> Result<(), RanksError> {
    let differs = team.first_that_differs(&[hash_of(value)]);
    differs.map_or(Ok(()), |rank| Err(RanksError::Differs { rank, what, advice }))
}

/// The particles, of `n`, that this rank keeps.
pub(crate) fn can_keep(team: &Team, particles: usize) -> Result<Own, RanksError> {
    match (FEWEST..=MOST).contains(&particles) {
        true => Ok(Own::of_rank(team, particles)),
        false => Err(RanksError::Particles { particles, fewest: FEWEST, most: MOST }),
    }
}

/// Shares the forces of a scene that ranks run.
pub(crate) fn share(
    forces: &mut dyn Backend,
    team: &Team,
    cell: &PeriodicBox,
) -> Result<(), RanksError> {
    let limit = SpeedLimit { every: watchdog::EVERY, largest: LARGEST_MOVE };
    let shares = forces.share(team, cell, limit)?;
    assert!(shares, "a scene for ranks has lists");
    Ok(())
}

impl Simulation {
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

/// What this rank found. Where another one failed, this one fails too.
pub(crate) fn alike<T>(
    team: Option<&Team>,
    found: Result<T, EngineError>,
) -> Result<T, EngineError> {
    let failed = team.is_some_and(|team| team.any(found.is_err()));
    match found {
        Ok(_) if failed => Err(RanksError::Elsewhere.into()),
        found => found,
    }
}

/// [`alike`], of what rank 0 made or wrote.
pub(crate) fn made<T>(own: &Own, made: Result<T, EngineError>) -> Result<T, EngineError> {
    alike(own.team(), made)
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
