//! A run that writes no file: rows and frames stay in memory.

use std::time::Instant;

use lennard_core::{DVec3, Table};

use crate::course::{Course, Writer};
use crate::files::{thermo_columns, thermo_row};
use crate::follower::{Control, Ending};
use crate::recording::{KeptFrame, Recording, Results};
use crate::schedule::{Action, Operation, Trigger};
use crate::simulation::Simulation;
use crate::{EngineError, record, watchdog};

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
        let mut record = record::finished(self, &findings, *wall, frames, finished);
        record.remarks.extend(self.remarks.iter().cloned());
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

fn kept(simulation: &Simulation) -> KeptFrame {
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
