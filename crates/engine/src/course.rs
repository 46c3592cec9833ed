//! The course of a run with output: to files, to memory, or beside a rank that writes.

use std::ops::ControlFlow;
use std::time::Instant;

use lennard_core::State;

use crate::follower::{Control, Ending, Follower};
use crate::moment::Moment;
use crate::ranks::{Decision, agree};
use crate::schedule::{Action, Schedule};
use crate::{EngineError, Simulation};

/// What becomes of the output of a run: files, memory, or nothing.
pub(crate) trait Writer: Send {
    /// Writes the row and the frame of this step, as far as they are due.
    fn write(
        &mut self,
        simulation: &mut Simulation,
        row: bool,
        frame: bool,
    ) -> Result<(), EngineError>;

    /// Sets a state aside for the case that physics fails.
    fn set_aside(&mut self, _state: &State) {}

    /// Whether the time between two checkpoints is over.
    fn time_is_up(&self) -> bool {
        false
    }

    /// Writes a checkpoint.
    fn checkpoint(&mut self, _simulation: &mut Simulation) -> Result<(), EngineError> {
        Ok(())
    }
}

/// Follows a run up to a step: has its output written, shows progress, and listens for a request to stop.
pub(crate) struct Course<'a, W> {
    pub(crate) schedule: Schedule,
    pub(crate) writer: W,
    pub(crate) ending: Ending,
    control: Control<'a>,
    pub(crate) end: u64,
    /// Whether no other rank takes part.
    is_alone: bool,
}

impl<'a, W: Writer> Course<'a, W> {
    /// The output of the scene, up to the step `end`.
    pub(crate) fn new(simulation: &Simulation, control: Control<'a>, end: u64, writer: W) -> Self {
        Self {
            schedule: Schedule::of_output(&simulation.scene),
            writer,
            ending: Ending::Finished,
            control,
            end,
            is_alone: simulation.team.is_none(),
        }
    }

    /// Writes what is due at the step of the simulation, and tells whether that was a row.
    pub(crate) fn write(&mut self, simulation: &mut Simulation) -> Result<bool, EngineError> {
        let (step, measured) = (simulation.state.step, simulation.current_stage().measure);
        let row = self.schedule.does(Action::Row, step, measured);
        let frame = self.schedule.does(Action::Frame, step, measured);
        self.writer.write(simulation, row, frame)?;
        Ok(row)
    }

    /// Shows how far the simulation is.
    pub(crate) fn tell(&mut self, simulation: &Simulation) {
        let name = &simulation.current_stage().name;
        self.control.progress.update(name, simulation.state.step, self.end);
    }
}

impl<W: Writer> Follower for Course<'_, W> {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Clocks of ranks differ: several ranks wait for the step at which they agree.
    fn is_waiting(&self) -> bool {
        self.is_alone && self.writer.time_is_up()
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let clock = Instant::now();
        if self.write(simulation)? {
            self.control.progress.at_row(&|| Moment::of(simulation));
        }
        let (step, measured) = (simulation.state.step, simulation.current_stage().measure);
        if self.schedule.does(Action::SetAside, step, measured) {
            self.writer.set_aside(&simulation.state);
        }
        simulation.timers.write += clock.elapsed();
        self.tell(simulation);
        let own =
            Decision { stop: self.control.told_to_stop(), checkpoint: self.writer.time_is_up() };
        let all = agree(simulation, own)?;
        // A request that comes with the last step changes nothing any more.
        if let Some(ending) = all.stop.filter(|_| step < self.end) {
            self.ending = ending;
            return Ok(ControlFlow::Break(()));
        }
        if all.checkpoint || self.schedule.does(Action::Checkpoint, step, measured) {
            self.writer.checkpoint(simulation)?;
        }
        Ok(if step < self.end { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    }
}
