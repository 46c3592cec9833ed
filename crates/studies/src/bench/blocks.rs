//! Blocks of steps, each from the same state.

use std::time::{Duration, Instant};

use lennard_core::stopwatch::{Spread, in_turn, timed};
use lennard_core::{Momentum, Want};
use lennard_engine::{ENDLESS, EngineError, Simulation, take};
use lennard_forcefield::measure;
use lennard_scene::Scene;

use super::{BenchError, BenchOptions};
use crate::Progress;
use crate::jobs::pool;
use crate::lab::{Start, to_temperature};

/// Steps before the clock starts: the list is built, memory is touched, caches are warm.
pub(super) const SETTLING: u64 = 5;
/// Least number of steps from the scene's start to the state that is measured: a lattice melts in these.
const WARM_STEPS: u64 = 300;
/// The same for a quick look, where a half-molten crystal is good enough.
const WARM_STEPS_QUICK: u64 = 100;
/// How long that may take.
const WARM_FOR: Duration = Duration::from_secs(5);
/// How long a block should take with the warm-up's settings, s.
const BLOCK: f64 = 0.1;
const BLOCK_QUICK: f64 = 0.025;
/// Fewest steps of a block: several lives of a list.
const FEWEST_STEPS: u64 = 20;
/// Longer blocks of a tiny system say nothing more.
const MOST_STEPS: u64 = 20_000;

/// The state that every block starts from.
pub(super) struct Blocks {
    pub(super) start: Start,
    /// Steps of a block.
    pub(super) steps: u64,
    /// Pairs within the cutoff for each particle, each counted once.
    pub(super) pairs_per_atom: f64,
}

impl Blocks {
    /// Runs a scene on `threads` threads from its start until it is warm. Where the scene of the user has a bath, the state has the
    /// temperature of its measured stage. Without one a lattice melts at constant energy and cools, as it does in a run.
    pub(super) fn warmed(
        scene: &Scene,
        threads: usize,
        options: &BenchOptions,
        progress: &mut dyn Progress,
    ) -> Result<Self, BenchError> {
        progress.update("warming up", 0.0);
        let (steps, block) =
            if options.quick { (WARM_STEPS_QUICK, BLOCK_QUICK) } else { (WARM_STEPS, BLOCK) };
        let mut warming = scene.clone();
        let asked = options.subject.load(&options.overrides)?;
        if asked.stages.iter().any(|stage| stage.thermostat.is_some()) {
            warming.stages = vec![to_temperature(scene, ENDLESS)];
        }
        let mut simulation = lennard_engine::prepare(warming)?;
        let seconds = pool(threads)?.install(|| -> Result<f64, EngineError> {
            let end = Instant::now() + WARM_FOR;
            while simulation.state.step < steps && Instant::now() < end {
                take(&mut simulation, SETTLING, Want::NOTHING)?;
            }
            let (seconds, taken) = timed(|| take(&mut simulation, FEWEST_STEPS, Want::NOTHING));
            taken?;
            Ok(seconds / FEWEST_STEPS as f64)
        })?;
        let start = Start::from(simulation);
        let pairs = measure::work(&mut start.forces(scene)?, start.configuration())?.pairs;
        Ok(Self {
            steps: ((block / seconds) as u64).clamp(FEWEST_STEPS, MOST_STEPS),
            pairs_per_atom: pairs as f64 / start.len() as f64,
            start,
        })
    }

    /// Temperature of the state, ε/k_B.
    pub(super) fn temperature(&self) -> f64 {
        let system = self.start.system();
        system.temperature(&self.start.velocities, Momentum::Conserved)
    }

    /// A simulation of a scene from this state; its list is built and its memory is touched.
    pub(super) fn simulation(&self, scene: &Scene) -> Result<Simulation, EngineError> {
        let mut simulation = self.start.simulation(scene.clone())?;
        take(&mut simulation, SETTLING, Want::NOTHING)?;
        Ok(simulation)
    }

    /// Nanoseconds per particle and step in a second of a block.
    pub(super) fn ns_per_second(&self) -> f64 {
        1e9 / (self.start.len() as f64 * self.steps as f64)
    }
}

/// Measures a block of each item in each round, in shuffled turns: all blocks of each item.
pub(super) fn in_turns<T>(
    labels: &[String],
    options: &BenchOptions,
    progress: &mut dyn Progress,
    mut block: impl FnMut(usize) -> Result<T, BenchError>,
) -> Result<Vec<Vec<T>>, BenchError> {
    let mut blocks: Vec<Vec<T>> = labels.iter().map(|_| Vec::new()).collect();
    // The order is no secret and no physics: any fixed seed will do.
    in_turn(labels.len(), options.repeats, 1, |turn| {
        progress.update(&labels[turn.item], turn.done);
        blocks[turn.item].push(block(turn.item)?);
        Ok::<(), BenchError>(())
    })?;
    Ok(blocks)
}

/// What is read of a block, in words.
pub(super) fn clock_name(is_of_processor: bool) -> &'static str {
    match is_of_processor {
        true => "processor time",
        false => "wall clock",
    }
}

/// The spread of repeated blocks.
///
/// # Panics
/// Where there are no values: nothing is measured less than once.
pub(super) fn spread(values: impl IntoIterator<Item = f64>) -> Spread {
    Spread::of(values).expect("measured at least once")
}
