//! Blocks of steps, each from the same state.

use std::time::{Duration, Instant};

use lennard_core::{Configuration, Momentum, PeriodicBox, State, System, Want};
use lennard_engine::{
    Action, Beginning, EngineError, Operation, Simulation, StopAt, Trigger, prepare_from,
};
use lennard_forcefield::measure;
use lennard_scene::Scene;

use super::variants::Variant;
use super::{BenchError, BenchOptions};
use crate::Progress;
use crate::jobs::pool;

/// Steps before the clock starts: the list is built, memory is touched, caches are warm.
pub(super) const SETTLING: u64 = 5;
/// Steps from the scene's start to the state that is measured, at least: a lattice melts in so many.
const WARM_STEPS: u64 = 300;
/// The same for a quick look, where a half-molten crystal is good enough.
const WARM_STEPS_QUICK: u64 = 100;
/// How long that may take.
const WARM_FOR: Duration = Duration::from_secs(5);
/// How long a block should take on the fastest variant.
const BLOCK: Duration = Duration::from_millis(100);
const BLOCK_QUICK: Duration = Duration::from_millis(25);
/// Steps of a block, whatever they take: several lives of a list.
const FEWEST_STEPS: u64 = 20;
/// Longer blocks of a tiny system say nothing more.
const MOST_STEPS: u64 = 20_000;

/// The state that every block starts from.
pub(super) struct Start {
    pub(super) cell: PeriodicBox,
    pub(super) state: State,
    /// Steps of a block.
    pub(super) steps: u64,
    /// Pairs within the cutoff for each particle, each counted once.
    pub(super) pairs_per_atom: f64,
}

impl Start {
    /// Runs the first variant from the scene's start until it is warm.
    pub(super) fn warmed(
        variants: &[Variant],
        options: &BenchOptions,
        progress: &mut dyn Progress,
    ) -> Result<Self, BenchError> {
        progress.update("warming up", 0.0);
        let (steps, block) = if options.quick {
            (WARM_STEPS_QUICK, BLOCK_QUICK)
        } else {
            (WARM_STEPS, BLOCK)
        };
        let first = &variants[0];
        let most = variants.iter().map(|v| v.threads).max().unwrap_or(1);
        let pool = pool(most)?;
        let mut simulation = lennard_engine::prepare(first.scene.clone())?;
        let step = pool.install(|| -> Result<f64, EngineError> {
            let end = Instant::now() + WARM_FOR;
            let mut done = 0;
            while done < steps && Instant::now() < end {
                take(&mut simulation, SETTLING)?;
                done += SETTLING;
            }
            let clock = Instant::now();
            take(&mut simulation, FEWEST_STEPS)?;
            Ok(clock.elapsed().as_secs_f64() / FEWEST_STEPS as f64)
        })?;
        let state = simulation.state.clone();
        let cell = simulation.state.cell;
        let (_, mut forces) = lennard_engine::forces(&first.scene, cell, state.len())?;
        let pairs =
            measure::work(&mut forces, Configuration::at_rest(&cell, &state.positions))?.pairs;
        Ok(Self {
            cell,
            steps: ((block.as_secs_f64() / step) as u64).clamp(FEWEST_STEPS, MOST_STEPS),
            pairs_per_atom: pairs as f64 / state.len() as f64,
            state,
        })
    }

    /// Box and positions.
    pub(super) fn configuration(&self) -> Configuration<'_> {
        Configuration::at_rest(&self.cell, &self.state.positions)
    }

    pub(super) fn temperature(&self) -> f64 {
        System::atoms(self.state.len()).temperature(&self.state.velocities, Momentum::Conserved)
    }

    /// A simulation of a scene from this state, its list built and its memory touched.
    pub(super) fn simulation(&self, scene: &Scene) -> Result<Simulation, EngineError> {
        let beginning = Beginning {
            cell: self.cell,
            positions: self.state.positions.clone(),
            velocities: Some(self.state.velocities.clone()),
            relax: false,
        };
        let mut simulation = prepare_from(scene.clone(), beginning)?;
        take(&mut simulation, SETTLING)?;
        Ok(simulation)
    }
}

/// Takes some steps.
pub(super) fn take(simulation: &mut Simulation, steps: u64) -> Result<(), EngineError> {
    take_wanting(simulation, steps, Want::NOTHING)
}

/// Takes some steps and wants the same of each.
pub(super) fn take_wanting(
    simulation: &mut Simulation,
    steps: u64,
    want: Want,
) -> Result<(), EngineError> {
    let end = simulation.state.step + steps;
    let wanted =
        (!want.is_nothing()).then(|| Operation::new(Action::Call, Trigger::Always).wanting(want));
    let schedule = wanted.into_iter().collect();
    simulation
        .run(&mut StopAt::following(schedule, end))
        .map(drop)
}
