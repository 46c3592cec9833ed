//! Who follows a run from outside, and runs with everything off.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use lennard_core::Want;
use lennard_scene::{Scene, Stage};

use crate::EngineError;
use crate::instant::Moment;
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::simulation::Simulation;

/// Follows a run from outside: writes files, shows progress, stops it.
pub trait Follower {
    /// What is due for this follower, and when. It is called after these steps; in between, several steps are taken at once.
    fn schedule(&self) -> &Schedule;

    /// Whether it has to be called after the next step, whatever the schedule says.
    fn is_waiting(&self) -> bool {
        false
    }

    /// Called after steps with the simulation as it is, and tells whether the run goes on; an error ends it.
    ///
    /// # Errors
    /// Whatever keeps the run from going on (a full disk).
    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError>;
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// All stages are done.
    Finished,
    /// It was asked to stop, and has written a checkpoint.
    Stopped,
    /// Its time was up, and it has written a checkpoint.
    OutOfTime,
}

/// Follows nothing.
pub struct Unfollowed;

impl Follower for Unfollowed {
    fn schedule(&self) -> &Schedule {
        static NOTHING: Schedule = Schedule::empty();
        &NOTHING
    }

    fn after_step(&mut self, _simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        Ok(ControlFlow::Continue(()))
    }
}

/// Stops a run at a step, and otherwise follows a schedule without doing anything.
pub struct StopAt {
    step: u64,
    schedule: Schedule,
}

impl StopAt {
    /// Stops at this step.
    #[must_use]
    pub fn new(step: u64) -> Self {
        Self::following(Schedule::empty(), step)
    }

    /// Stops at this step; until then, steps are taken at once as this schedule allows.
    #[must_use]
    pub fn following(schedule: Schedule, step: u64) -> Self {
        let schedule = schedule.with(Operation::new(Action::Call, Trigger::At(step)));
        Self { step, schedule }
    }
}

impl Follower for StopAt {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        Ok(if simulation.state.step >= self.step {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    }
}

/// Told how far a run is, time and again.
pub trait Progress: Send {
    /// `done` of `total` steps, in the stage of this name.
    fn update(&mut self, stage: &str, done: u64, total: u64);

    /// The fluid at a step that writes a row of `thermo.csv`, before [`Self::update`] tells the step. The numbers are taken
    /// where they are asked for.
    fn at_row(&mut self, _fluid: &dyn Fn() -> Moment) {}
}

impl Progress for () {
    fn update(&mut self, _stage: &str, _done: u64, _total: u64) {}
}

/// How a run is followed and stopped from outside.
pub struct Control<'a> {
    /// Set from outside to stop after the steps under way, at most [`crate::watchdog::EVERY`].
    pub stop: &'a AtomicBool,
    /// When to stop by itself, likewise.
    pub deadline: Option<Instant>,
    /// Told how far the run is.
    pub progress: &'a mut dyn Progress,
}

impl Control<'_> {
    /// Whether and why to stop now.
    pub(crate) fn told_to_stop(&self) -> Option<Ending> {
        if self.stop.load(Ordering::Relaxed) {
            return Some(Ending::Stopped);
        }
        self.deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
            .then_some(Ending::OutOfTime)
    }
}

// Runs with everything off: what benchmarks, studies and plans time.

/// Steps of a stage that ends when its follower says so; as an interval, one that no run reaches.
pub const ENDLESS: u64 = 1_000_000_000_000_000;

/// The stage that a scene measures: the last measured one, or the last of all.
///
/// # Panics
/// Where the scene has no stage, which no reader lets pass.
#[must_use]
pub fn measured_stage(scene: &Scene) -> &Stage {
    scene.measured_stage().expect("a scene has a stage: its reader refuses one without")
}

/// The scene with its measured stage alone: without end, at constant energy, with nothing to observe or write.
#[must_use]
pub fn bare(scene: &Scene) -> Scene {
    let mut bare = scene.clone();
    bare.stages = vec![Stage {
        steps: ENDLESS,
        thermostat: None,
        barostat: None,
        measure: false,
        ..measured_stage(scene).clone()
    }];
    bare.observables.clear();
    bare.output.trajectory_every = None;
    bare
}

/// Takes `steps` steps and asks the forces of each for `want`; where that is nothing, several are taken in one go.
///
/// # Errors
/// [`EngineError`] where the run fails.
pub fn take(simulation: &mut Simulation, steps: u64, want: Want) -> Result<(), EngineError> {
    let end = simulation.state.step + steps;
    let wanted =
        (!want.is_nothing()).then(|| Operation::new(Action::Call, Trigger::Always).wanting(want));
    let schedule = wanted.into_iter().collect();
    simulation.follow(&mut StopAt::following(schedule, end)).map(drop)
}
