//! A run that writes no file: rows and frames stay in memory.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use lennard_core::{DVec3, Table};
use lennard_io::RunRecord;

use crate::files::{thermo_columns, thermo_row};
use crate::follower::Follower;
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::simulation::Simulation;
use crate::{Ending, EngineError, Progress, record, watchdog};

/// Atom-steps between two looks at a request to stop: about a tenth of a second.
const ATOM_STEPS_BETWEEN_LOOKS: usize = 1_000_000;
/// Steps between two looks at least: fewer could not be taken at once.
const LEAST_STEPS: usize = 4;

/// A state of the trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptFrame {
    /// Step.
    pub step: u64,
    /// Time, τ.
    pub time: f64,
    /// Box sides, σ.
    pub lengths: DVec3,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ; empty where `output.velocities` is off.
    pub velocities: Vec<DVec3>,
    /// Forces, `[N]`, ε/σ; empty where `output.forces` is off.
    pub forces: Vec<DVec3>,
}

/// What a run in memory has kept so far; a run that goes on adds to it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// The rows that a run with files writes to `thermo.csv`, column by column.
    pub thermo: Vec<Vec<f64>>,
    /// The frames that it writes to its trajectory.
    pub frames: Vec<KeptFrame>,
    /// Wall time.
    pub wall: Duration,
}

/// How to run in memory.
pub struct MemoryOptions<'a> {
    /// The step to stop at; the end of the scene where it is `None`.
    pub until: Option<u64>,
    /// Set from outside to stop after the steps under way, at most [`crate::watchdog::EVERY`].
    pub stop: &'a AtomicBool,
    /// Told how far the run is.
    pub progress: &'a mut dyn Progress,
}

/// Runs a simulation on from where it is, with the bits of [`crate::run()`], and writes nothing.
///
/// # Errors
/// [`EngineError`] where physics stops it.
pub fn run_in_memory(
    simulation: &mut Simulation,
    recording: &mut Recording,
    options: MemoryOptions<'_>,
) -> Result<Ending, EngineError> {
    let started = Instant::now();
    let total = simulation.scene.total_steps();
    let end = options.until.unwrap_or(total).min(total);
    if simulation.stage.is_some() && simulation.state.step >= end {
        return Ok(Ending::Finished);
    }
    let mut schedule = Schedule::of_output(&simulation.scene);
    if end < total {
        let last = Operation::new(Action::Call, Trigger::At(end));
        schedule = schedule.with(last.wanting(lennard_core::Want::ENERGY_AND_VIRIAL));
    }
    let often = (ATOM_STEPS_BETWEEN_LOOKS / simulation.state.len().max(1)).max(LEAST_STEPS);
    if (often as u64) < watchdog::EVERY {
        schedule = schedule.with(Operation::new(Action::Call, Trigger::Every(often as u64)));
    }
    recording.thermo.resize(thermo_columns(simulation).len(), Vec::new());
    let mut keeper = Keeper { schedule, recording, options, end, total, ending: Ending::Finished };
    let done = simulation.run(&mut keeper);
    let ending = keeper.ending;
    recording.wall += started.elapsed();
    done.map(|_| ending)
}

impl Recording {
    /// The rows as a table with names and units.
    #[must_use]
    pub fn thermo_table(&self, simulation: &Simulation) -> Table {
        let table = Table::new("thermo", "Instantaneous values.");
        let columns = thermo_columns(simulation).into_iter();
        let numbers = self.thermo.iter().cloned().chain(std::iter::repeat(Vec::new()));
        columns
            .zip(numbers)
            .fold(table, |table, ((name, unit), numbers)| table.with(name, unit, numbers))
    }

    /// The record of the run so far and the tables of its observables, as a run with files writes them.
    #[must_use]
    pub fn results(&self, simulation: &Simulation, threads: usize) -> (RunRecord, Vec<Table>) {
        let findings = simulation.findings();
        let tables = findings.iter().flat_map(|f| f.tables.iter().cloned());
        let frames = simulation.scene.output.trajectory_every;
        let frames = frames.map(|_| self.frames.len() as u64);
        let finished = simulation.state.step == simulation.scene.total_steps();
        let mut record =
            record::finished(simulation, &findings, threads, self.wall, frames, finished);
        record.remarks.extend(simulation.remarks.iter().cloned());
        (record, tables.collect())
    }
}

/// Keeps rows and frames, shows progress, and listens for a request to stop.
struct Keeper<'a, 'o> {
    schedule: Schedule,
    recording: &'a mut Recording,
    options: MemoryOptions<'o>,
    end: u64,
    total: u64,
    ending: Ending,
}

impl Follower for Keeper<'_, '_> {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let clock = Instant::now();
        let step = simulation.state.step;
        let stage = simulation.current_stage();
        if self.schedule.does(Action::Row, step, stage.measure) {
            let row = thermo_row(simulation);
            for (column, cell) in self.recording.thermo.iter_mut().zip(&row) {
                column.push(cell.value.number());
            }
        }
        if self.schedule.does(Action::Frame, step, stage.measure) {
            self.recording.frames.push(frame(simulation));
        }
        self.options.progress.update(&simulation.current_stage().name, step, self.end);
        simulation.timers.write += clock.elapsed();
        // A request that comes with the last step changes nothing any more.
        if step < self.end && self.options.stop.load(Ordering::Relaxed) {
            self.ending = Ending::Stopped;
            return Ok(ControlFlow::Break(()));
        }
        Ok(if step >= self.end && self.end < self.total {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    }
}

fn frame(simulation: &Simulation) -> KeptFrame {
    let (state, output) = (&simulation.state, &simulation.scene.output);
    let wanted = |wanted: bool, all: &[DVec3]| if wanted { all.to_vec() } else { Vec::new() };
    KeptFrame {
        step: state.step,
        time: state.time,
        lengths: state.cell.lengths(),
        positions: state.positions.clone(),
        velocities: wanted(output.velocities, &state.velocities),
        forces: wanted(output.forces, &state.forces),
    }
}
