//! One run from scene to finished folder, in one go or in several.

use std::time::Instant;

use lennard_core::{DVec3, State};
use lennard_io::{OutputFolder, RunRecord};
use lennard_observables::{Findings, Table};

use crate::checkpointing::{Checkpointer, Past};
use crate::course::{Course, Writer, aside, set_aside};
use crate::failure::PhysicsFailure;
use crate::files::RunFiles;
use crate::follower::{Control, Ending};
use crate::resume::Resumed;
use crate::simulation::Simulation;
use crate::together::made;
use crate::{EngineError, record};

/// Bytes that a state set aside takes for each particle: position and velocity.
pub(crate) const SET_ASIDE_BYTES: usize = 2 * size_of::<DVec3>();

/// What a run gives back.
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// The run record, as written to `run.json`.
    pub record: RunRecord,
    /// The tables of the observables; written where the run is finished.
    pub tables: Vec<Table>,
}

/// Runs a simulation to its end and writes its folder, which this process holds and which is empty. A rank beside rank 0 has no
/// folder, and takes part in what rank 0 writes.
///
/// # Errors
/// [`EngineError`] where physics stops it or a file cannot be written, by rank 0 too. What is whole stays;
/// `run.json` then says `"finished": false`.
///
/// # Panics
/// Where there is no folder, and no ranks share the simulation: that is a bug of the caller.
pub fn run<'a>(
    simulation: &mut Simulation,
    folder: impl Into<Option<&'a OutputFolder>>,
    control: Control<'_>,
) -> Result<Outcome, EngineError> {
    let (started, folder) = (Instant::now(), folder.into());
    assert!(folder.is_some() || simulation.team().is_some(), "a folder, or a rank beside rank 0");
    if let Some(folder) = folder {
        folder.remove_half_written();
    }
    let files = RunFiles::open(folder.map(OutputFolder::path), simulation, None)?;
    let past = Past { remarks: simulation.remarks.clone(), ..Past::default() };
    drive(simulation, Recorder::new(simulation, folder, files, past, started), control)
}

/// Goes on with a run that [`crate::resume()`] has brought back. Its growing files are cut back to the
/// checkpoint. They end up as if the run had never been interrupted.
///
/// # Errors
/// As [`run`].
///
/// # Panics
/// As [`run`].
pub fn go_on<'a>(
    resumed: &mut Resumed,
    folder: impl Into<Option<&'a OutputFolder>>,
    control: Control<'_>,
) -> Result<Outcome, EngineError> {
    let (started, folder) = (Instant::now(), folder.into());
    let Resumed { simulation, marks, past, .. } = resumed;
    assert!(folder.is_some() || simulation.team().is_some(), "a folder, or a rank beside rank 0");
    let path = folder.map(OutputFolder::path);
    let files = RunFiles::open(path, simulation, Some(*marks))?;
    // First of all, since the scene in it may have more steps than before, or another instruction set.
    Checkpointer::new(path, &simulation.scene.checkpoint)
        .write_unwatched(simulation, *marks, past)?;
    if let Some(folder) = folder {
        folder.remove_half_written();
    }
    made(simulation.system.own(), files.refresh(simulation))?;
    drive(simulation, Recorder::new(simulation, folder, files, past.clone(), started), control)
}

/// Writes the folder of a simulation that has its rows in memory and is at its end.
pub(crate) fn write_whole(
    simulation: &mut Simulation,
    folder: &OutputFolder,
    started: Instant,
) -> Result<Outcome, EngineError> {
    let mut files = RunFiles::open(Some(folder.path()), simulation, None)?;
    files.write_kept_rows(simulation)?;
    let past = Past { remarks: simulation.remarks.clone(), ..Past::default() };
    let recorder = Recorder::new(simulation, Some(folder), files, past, started);
    recorder.conclude(simulation, Ending::Finished)
}

fn drive(
    simulation: &mut Simulation,
    recorder: Recorder<'_>,
    control: Control<'_>,
) -> Result<Outcome, EngineError> {
    // A run that goes on beyond its end has its tables there already.
    let before = recorder.tables();
    made(simulation.system.own(), recorder.write_unfinished(simulation, before, None))?;
    let end = simulation.scene.total_steps();
    let mut course = Course::new(simulation, control, end, recorder);
    if let Err(mut error) = to_the_end(simulation, &mut course) {
        let recorder = course.writer;
        if error.is_of_lost_folder() {
            // The folder belongs to another process now.
            return Err(error);
        }
        if let EngineError::Physics(failure) = &mut error {
            recorder.keep_evidence(simulation, failure);
        }
        // The record of a failed run is a courtesy: the error itself matters more than a second one.
        let tables = recorder.tables();
        let _ = recorder.write_unfinished(simulation, tables, Some(error.to_string()));
        return Err(error);
    }
    course.writer.conclude(simulation, course.ending)
}

/// Runs to the end, or to where it is told to stop, and leaves a checkpoint there.
fn to_the_end(
    simulation: &mut Simulation,
    course: &mut Course<'_, Recorder<'_>>,
) -> Result<(), EngineError> {
    if std::mem::take(&mut course.writer.past.owes_output) {
        course.write(simulation)?;
    }
    simulation.follow(course)?;
    course.writer.checkpoint(simulation)
}

/// Writes rows, frames and checkpoints into a folder. Beside rank 0 it has none, and takes part in what rank 0 writes.
struct Recorder<'a> {
    folder: Option<&'a OutputFolder>,
    files: RunFiles,
    checkpoints: Checkpointer,
    past: Past,
    started: Instant,
    /// A state with which nothing was wrong.
    before: State,
}

impl<'a> Recorder<'a> {
    fn new(
        simulation: &Simulation,
        folder: Option<&'a OutputFolder>,
        files: RunFiles,
        past: Past,
        started: Instant,
    ) -> Self {
        let checkpoints =
            Checkpointer::new(folder.map(OutputFolder::path), &simulation.scene.checkpoint);
        Self { folder, files, checkpoints, past, started, before: aside(&simulation.state) }
    }

    /// The tables that are in the folder.
    fn tables(&self) -> Vec<String> {
        self.folder.map(OutputFolder::tables).unwrap_or_default()
    }

    fn past_until_now(&self) -> Past {
        Past { wall: self.past.wall + self.started.elapsed(), ..self.past.clone() }
    }

    /// Writes the record of a run that has not ended, or not well.
    fn write_unfinished(
        &self,
        simulation: &Simulation,
        tables: Vec<String>,
        failure: Option<String>,
    ) -> Result<(), EngineError> {
        let remarks = self.past.remarks.iter().cloned().chain(failure);
        let record = record::unfinished(simulation, remarks);
        Ok(self.files.write_record(&RunRecord { tables, ..record })?)
    }

    /// Saves what shows how a run failed.
    fn keep_evidence(&self, simulation: &Simulation, failure: &mut PhysicsFailure) {
        // Each is a courtesy: a second error must not hide the first. Numbers that are not finite are never written.
        let states =
            [("failed.xyz", None, ""), ("before-failure.xyz", Some(&self.before), ", before it")];
        for (name, earlier, words) in states {
            let written = self.files.write_state(name, simulation, earlier);
            if let (Ok(()), Some(folder)) = (written, self.files.folder()) {
                let (path, step) = (folder.join(name), earlier.unwrap_or(&simulation.state).step);
                failure.kept.push(format!("saved: {} (step {step}{words})", path.display()));
            }
        }
        if let Some(folder) = self.files.folder()
            && let Ok(all) = lennard_io::CheckpointFolder::new(folder).list()
            && let Some((_, newest)) = all.first()
        {
            let words = "the last good checkpoint is untouched";
            failure.kept.push(format!("{words}: {}", newest.display()));
        }
    }

    /// Writes what comes at the end.
    fn conclude(
        &self,
        simulation: &mut Simulation,
        ending: Ending,
    ) -> Result<Outcome, EngineError> {
        let clock = Instant::now();
        let findings: Vec<Findings> = simulation.findings();
        let tables: Vec<Table> = findings.iter().flat_map(|f| f.tables.iter().cloned()).collect();
        let finished = ending == Ending::Finished;
        // What looks like a result is written where the run is done; until then the checkpoint has it all.
        let listed: Vec<String> =
            tables.iter().map(|table| format!("{}.csv", table.name)).collect();
        if finished {
            // Before the tables, so that none is there that no record lists.
            let mut written = self.write_unfinished(simulation, listed.clone(), None);
            written = written.and_then(|()| Ok(self.files.write_tables(&tables)?));
            let last = self.files.write_state("final.xyz", simulation, None);
            made(simulation.system.own(), written.and(last.map_err(EngineError::from)))?;
        }
        simulation.timers.write += clock.elapsed();
        let wall = self.past_until_now().wall;
        let (frames, remarks) = (self.files.frames(), &self.past.remarks);
        let mut record = record::finished(simulation, &findings, wall, frames, finished, remarks);
        record.tables = if finished { listed } else { self.tables() };
        made(simulation.system.own(), self.files.write_record(&record))?;
        Ok(Outcome { ending, record, tables })
    }
}

impl Writer for Recorder<'_> {
    fn write(
        &mut self,
        simulation: &mut Simulation,
        row: bool,
        frame: bool,
    ) -> Result<(), EngineError> {
        let held = self.folder.map_or(Ok(()), OutputFolder::still_held);
        made(simulation.system.own(), held.map_err(EngineError::Folder))?;
        let marks = self.files.marks();
        let mut written = Ok(());
        if row {
            written = self.files.write_thermo(simulation);
        }
        if frame {
            // Other ranks give their part of the frame, whatever became of the row.
            let remark = self.files.write_frame(simulation);
            written = written.and_then(|()| {
                let remark = remark?;
                let is_new = |remark: &String| !self.past.remarks.contains(remark);
                self.past.remarks.extend(remark.filter(is_new));
                Ok(())
            });
        }
        let written = made(simulation.system.own(), written);
        written.inspect_err(|_| {
            // What cannot be written now is written when the run goes on: where there is room for a checkpoint,
            // not a step is lost. Where there is none, the last one is as good as before.
            let past = Past { owes_output: true, ..self.past_until_now() };
            if simulation.watch_closely().is_ok() {
                let _ = self.checkpoints.write_unwatched(simulation, marks, &past);
            }
        })
    }

    fn set_aside(&mut self, state: &State) {
        set_aside(state, &mut self.before);
    }

    fn time_is_up(&self) -> bool {
        self.checkpoints.time_is_up()
    }

    fn checkpoint(&mut self, simulation: &mut Simulation) -> Result<(), EngineError> {
        let clock = Instant::now();
        let marks = made(simulation.system.own(), self.files.synced_marks())?;
        let past = self.past_until_now();
        self.checkpoints.write(simulation, marks, &past)?;
        simulation.timers.write += clock.elapsed();
        Ok(())
    }
}
