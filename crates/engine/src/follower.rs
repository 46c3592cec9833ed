//! Who follows a run from outside.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::instant::Moment;
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::{EngineError, Simulation};

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
