//! Several ranks in one run. Each has the whole state; rank 0 writes and prints, and the others take the same steps beside it.
//!
//! Clocks and signals differ between ranks, and no rank may act by its own. After some steps all ranks therefore agree
//! whether to stop, and whether a checkpoint is due ([`agree`]). All else is computed alike from the same numbers.

use std::hash::{DefaultHasher, Hash, Hasher};

use lennard_core::{DVec3, State, Team};
use lennard_io::RanksRecord;

use crate::error::RanksError;
use crate::follower::Ending;
use crate::watchdog::LISTS_EVERY;
use crate::{EngineError, Simulation};

impl Simulation {
    /// Shares the run with the other ranks of a team, which have the same simulation. Every rank has to call it.
    ///
    /// Pair forces over lists are shared out. Any other search is done by each rank alone, with the same results.
    ///
    /// # Errors
    /// [`EngineError::Ranks`] where the ranks do not have the same simulation, or are more than can be kept busy.
    pub fn share(&mut self, team: &Team) -> Result<(), EngineError> {
        let same = |what, advice, hash: u64| match team.first_that_differs(&[hash]) {
            None => Ok(()),
            Some(rank) => Err(RanksError::Differs { rank, what, advice }),
        };
        let scene = (env!("CARGO_PKG_VERSION"), self.scene.resolved_toml());
        same("scene or version of the program", "", hash_of(&scene))?;
        let advice = "\n  one that all have: --isa avx2 or --isa portable";
        same("instruction set", advice, hash_of(&self.isa))?;
        same("start", "", hash_of_state(&self.state))?;
        self.shares_forces = self.forces.share(team).map_err(RanksError::from)?;
        self.team = Some(team.clone());
        Ok(())
    }

    /// What the ranks did, where there are several, in a run that took so many seconds.
    pub(crate) fn ranks_record(&self, seconds: f64) -> Option<RanksRecord> {
        let team = self.team.as_ref()?;
        let statistics = team.statistics();
        Some(RanksRecord {
            ranks: team.ranks() as u64,
            shared_forces: self.shares_forces,
            communication: statistics.seconds / seconds,
            halo: statistics.halo,
        })
    }

    /// Fails where a rank has another state than rank 0. It looks every [`LISTS_EVERY`] steps.
    fn compare_ranks(&self) -> Result<(), EngineError> {
        let step = self.state.step;
        match &self.team {
            Some(team) if step.is_multiple_of(LISTS_EVERY) => {
                let differs = team.first_that_differs(&[hash_of_state(&self.state)]);
                differs.map_or(Ok(()), |rank| Err(RanksError::Diverged { rank, step }.into()))
            }
            _ => Ok(()),
        }
    }
}

fn hash_of(value: &impl Hash) -> u64 {
    // Its keys are constants, so that it gives all ranks the same.
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// A number that another bit anywhere in positions or velocities changes.
fn hash_of_state(state: &State) -> u64 {
    let fold = |hash: u64, v: &DVec3| {
        let words = v.to_array().map(f64::to_bits);
        // An odd factor loses no bit, and the rotation brings high bits down.
        words.iter().fold(hash, |hash, word| {
            (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        })
    };
    let all = state.positions.iter().chain(&state.velocities);
    all.fold(state.step, fold)
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
pub(crate) fn agree(simulation: &Simulation, own: Decision) -> Result<Decision, EngineError> {
    let Some(team) = &simulation.team else {
        return Ok(own);
    };
    simulation.compare_ranks()?;
    let is = |ending| u64::from(own.stop == Some(ending));
    let mut words = [is(Ending::Stopped), is(Ending::OutOfTime), u64::from(own.checkpoint)];
    team.max(&mut words);
    let [stopped, out_of_time, checkpoint] = words.map(|word| word > 0);
    let stop =
        if stopped { Some(Ending::Stopped) } else { out_of_time.then_some(Ending::OutOfTime) };
    Ok(Decision { stop, checkpoint })
}
