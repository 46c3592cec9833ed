//! Who follows a run from outside.

use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::{EngineError, Simulation};
use std::ops::ControlFlow;

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
