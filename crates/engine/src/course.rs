//! The course of a run with output: to files or to memory.

use std::ops::ControlFlow;
use std::time::Instant;

use lennard_core::State;
use lennard_observables::Table;

use crate::files::{thermo_columns, thermo_row};
use crate::follower::{Control, Ending, Follower};
use crate::instant::Moment;
use crate::ranks::{Decision, agree};
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::simulation::{Recording, Results, Simulation};
use crate::{EngineError, record, watchdog};

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
            is_alone: simulation.team().is_none(),
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
            // Ranks sum together, whether anyone looks or not.
            let shared = simulation.team().map(|_| Moment::of(simulation));
            let moment = || shared.unwrap_or_else(|| Moment::of(simulation));
            self.control.progress.at_row(&moment);
        }
        let (step, measured) = (simulation.state.step, simulation.current_stage().measure);
        if self.schedule.does(Action::SetAside, step, measured) {
            self.writer.set_aside(&simulation.state);
        }
        simulation.timers.write += clock.elapsed();
        self.tell(simulation);
        let own =
            Decision { stop: self.control.told_to_stop(), checkpoint: self.writer.time_is_up() };
        let all = agree(simulation, own);
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

/// Atom-steps between two looks at a request to stop: about a tenth of a second.
const ATOM_STEPS_BETWEEN_LOOKS: usize = 1_000_000;
/// Steps between two looks at least: fewer could not be taken at once.
const LEAST_STEPS: usize = 4;

impl Simulation {
    /// Runs on up to a step, or to the end of the scene where that comes first, with the bits of [`crate::run()`]. Rows and
    /// frames stay in memory.
    ///
    /// # Errors
    /// [`EngineError`] where physics stops it.
    pub fn run_until(&mut self, end: u64, control: Control<'_>) -> Result<Ending, EngineError> {
        let started = Instant::now();
        let total = self.scene.total_steps();
        let end = end.min(total);
        if self.state.step >= end {
            return Ok(Ending::Finished);
        }
        self.begin_recording();
        let mut course = Course::new(self, control, end, Memory);
        let mut call = |trigger, want| {
            course.schedule.add(Operation::new(Action::Call, trigger).wanting(want));
        };
        if end < total {
            call(Trigger::At(end), lennard_core::Want::ENERGY_AND_VIRIAL);
        }
        let often = (ATOM_STEPS_BETWEEN_LOOKS / self.state.len().max(1)).max(LEAST_STEPS) as u64;
        if often < watchdog::EVERY {
            call(Trigger::Every(often), lennard_core::Want::NOTHING);
        }
        let done = self.on_its_threads(|simulation| simulation.follow(&mut course))?;
        self.recording.wall += started.elapsed();
        done.map(|_| course.ending)
    }

    /// Makes room for the rows of `thermo.csv`.
    pub(crate) fn begin_recording(&mut self) {
        let columns = thermo_columns(self).len();
        self.recording.thermo.resize(columns, Vec::new());
    }

    /// The rows that a run with files writes to `thermo.csv`.
    #[must_use]
    pub fn thermo(&self) -> Table {
        let table = Table::new("thermo", "Instantaneous values.");
        let columns = thermo_columns(self).into_iter();
        let numbers = self.recording.thermo.iter().cloned().chain(std::iter::repeat(Vec::new()));
        columns
            .zip(numbers)
            .fold(table, |table, ((name, unit), numbers)| table.with(name, unit, numbers))
    }

    /// What was measured since the start, or since the last stage was added, as a run with files writes it.
    #[must_use]
    pub fn results(&self) -> Results {
        let findings = self.findings();
        let tables = findings.iter().flat_map(|f| f.tables.iter().cloned()).collect();
        let Recording { frames, wall, .. } = &self.recording;
        let frames = self.scene.output.trajectory_every.map(|_| frames.len() as u64);
        let finished = self.state.step == self.scene.total_steps();
        let record = record::finished(self, &findings, *wall, frames, finished, &self.remarks);
        Results { record, tables }
    }
}

/// Keeps rows and frames in the simulation itself.
pub(crate) struct Memory;

impl Writer for Memory {
    fn write(
        &mut self,
        simulation: &mut Simulation,
        row: bool,
        frame: bool,
    ) -> Result<(), EngineError> {
        if row {
            let row = thermo_row(simulation);
            for (column, cell) in simulation.recording.thermo.iter_mut().zip(&row) {
                column.push(cell.value.number());
            }
        }
        if frame {
            let frame = kept(simulation);
            simulation.recording.frames.push(frame);
        }
        Ok(())
    }
}

/// The state as the output of the scene keeps it: without what a frame has no place for.
fn kept(simulation: &Simulation) -> State {
    let output = &simulation.scene.output;
    let mut kept = aside(&simulation.state);
    if !output.velocities {
        kept.velocities = Vec::new();
    }
    if output.forces {
        kept.forces.clone_from(&simulation.state.forces);
    }
    kept
}

/// A copy of a state in which other states are set aside. It has no forces, since they are not read there.
pub(crate) fn aside(state: &State) -> State {
    State {
        step: state.step,
        time: state.time,
        cell: state.cell,
        positions: state.positions.clone(),
        velocities: state.velocities.clone(),
        forces: Vec::new(),
        energetics: state.energetics.clone(),
    }
}

/// Copies a state into the memory of another.
pub(crate) fn set_aside(state: &State, to: &mut State) {
    to.step = state.step;
    to.time = state.time;
    to.cell = state.cell;
    to.positions.clone_from(&state.positions);
    to.velocities.clone_from(&state.velocities);
}
