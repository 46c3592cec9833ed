//! Several ranks in one run. Each keeps the particles of some consecutive numbers. Rank 0 writes and prints, and the others take the same
//! steps beside it.
//!
//! Clocks and signals differ between ranks, and no rank may act by its own. After some steps all ranks therefore agree
//! whether to stop, and whether a checkpoint is due ([`agree`]). All else is computed alike from the same sums.

use lennard_io::RanksRecord;

use crate::Simulation;
use crate::follower::Ending;

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
