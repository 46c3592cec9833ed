//! The rows of a benchmark, each a scene with settings of its own on some threads, and how they are timed.

use lennard_core::Want;
use lennard_engine::stopwatch::{Spread, Stopwatch, in_turn};
use lennard_engine::take;
use lennard_forcefield::ForcePlan;
use lennard_scene::Scene;

use super::types::BenchError;
use crate::Progress;
use crate::jobs::pool;
use crate::lab::Start;

/// One row of a benchmark.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    /// What progress calls it.
    pub(super) name: String,
    /// The scene with these settings and nothing to observe, write or couple to.
    pub(super) scene: Scene,
    /// What the forces really run.
    pub(super) plan: ForcePlan,
    pub(super) threads: usize,
}

/// What every row starts from, and for how long.
pub(super) struct Blocks<'a> {
    pub(super) start: &'a Start,
    /// Steps of a block.
    pub(super) steps: u64,
    /// Blocks of each row.
    pub(super) repeats: usize,
}

/// One block of one row.
pub(super) struct Block {
    /// Seconds on the wall, and on the processor of the calling thread.
    pub(super) seconds: f64,
    pub(super) on_processor: f64,
    /// Seconds of list building, and the lists that were built.
    pub(super) neighbor: f64,
    pub(super) builds: u64,
    pub(super) bytes: u64,
}

impl Blocks<'_> {
    /// Times a block of each row in each round, in shuffled turns: all blocks of each row, with what `more` measures beside each.
    pub(super) fn measure<T: Send>(
        &self,
        variants: &[Variant],
        progress: &mut dyn Progress,
        more: impl Fn(&Variant) -> Result<T, BenchError> + Sync,
    ) -> Result<Vec<Vec<(Block, T)>>, BenchError> {
        let pools = variants.iter().map(|v| pool(v.threads));
        let pools = pools.collect::<Result<Vec<_>, _>>()?;
        let mut blocks: Vec<Vec<(Block, T)>> = variants.iter().map(|_| Vec::new()).collect();
        // The order is no secret and no physics: any fixed seed will do.
        in_turn(variants.len(), self.repeats, 1, |turn| {
            let variant = &variants[turn.item];
            progress.update(&variant.name, turn.done);
            let found = pools[turn.item]
                .install(|| Ok::<_, BenchError>((self.block(&variant.scene)?, more(variant)?)))?;
            blocks[turn.item].push(found);
            Ok::<(), BenchError>(())
        })?;
        Ok(blocks)
    }

    fn block(&self, scene: &Scene) -> Result<Block, BenchError> {
        let mut simulation = self.start.settled(scene.clone())?;
        let before = simulation.forces.statistics();
        let watch = Stopwatch::start();
        take(&mut simulation, self.steps, Want::NOTHING)?;
        let (seconds, on_processor) = (watch.wall(), watch.on_processor());
        let after = simulation.forces.statistics();
        Ok(Block {
            seconds,
            on_processor,
            neighbor: after.neighbor_seconds - before.neighbor_seconds,
            builds: after.builds - before.builds,
            bytes: after.bytes,
        })
    }

    /// Nanoseconds per particle and step in a second of a block.
    pub(super) fn ns_per_second(&self) -> f64 {
        1e9 / (self.start.len() as f64 * self.steps as f64)
    }
}

/// The spread of repeated blocks.
///
/// # Panics
/// Where there are no values: nothing is measured less than once.
pub(super) fn spread(values: impl IntoIterator<Item = f64>) -> Spread {
    Spread::of(values).expect("measured at least once")
}
