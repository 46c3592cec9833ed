//! One run from scene to finished folder, in one go or in several.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use lennard_core::{DVec3, Findings, State, Table};
use lennard_io::{OutputFolder, RunRecord};

use crate::checkpointing::{Checkpointer, Past};
use crate::failure::PhysicsFailure;
use crate::files::RunFiles;
use crate::follower::{Ending, Follower};
use crate::ranks::{Decision, Next, next};
use crate::resume::Resumed;
use crate::schedule::{Action, Schedule};
use crate::simulation::Simulation;
use crate::{EngineError, record};

/// Bytes that a state set aside takes for each particle: position and velocity.
pub(crate) const SET_ASIDE_BYTES: usize = 2 * size_of::<DVec3>();

/// Told how far a run is, time and again.
pub trait Progress: Send {
    /// `done` of `total` steps, in the stage of this name.
    fn update(&mut self, stage: &str, done: u64, total: u64);

    /// The fluid at a step that writes a row of `thermo.csv`, before [`Self::update`] tells the step. The numbers are taken
    /// where they are asked for.
    fn at_row(&mut self, _fluid: &dyn Fn() -> Instantaneous) {}
}

/// Instantaneous values of the fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instantaneous {
    /// Temperature of whole steps, ε/k_B.
    pub temperature: f64,
    /// Potential energy in ε per particle, or per molecule; not a number where it is not known at this step.
    pub potential_energy: f64,
    /// Pressure in ε/σ³, likewise.
    pub pressure: f64,
}

impl Instantaneous {
    fn of(simulation: &Simulation) -> Self {
        Self {
            temperature: simulation.view().temperature(),
            potential_energy: simulation.potential_energy_per_particle().unwrap_or(f64::NAN),
            pressure: simulation.pressure().unwrap_or(f64::NAN),
        }
    }
}

impl Progress for () {
    fn update(&mut self, _stage: &str, _done: u64, _total: u64) {}
}

/// How to run.
pub struct RunOptions<'a> {
    /// The output folder, held by this process; empty for a new run.
    pub folder: &'a OutputFolder,
    /// Threads in use, for the record.
    pub threads: usize,
    /// Set from outside to stop after the steps under way, at most [`crate::watchdog::EVERY`].
    pub stop: &'a AtomicBool,
    /// When to stop by itself, likewise.
    pub deadline: Option<Instant>,
    /// Told how far the run is.
    pub progress: &'a mut dyn Progress,
}

/// What a run gives back.
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// The run record, as written to `run.json`.
    pub record: RunRecord,
    /// The tables of the observables; written where the run is finished.
    pub tables: Vec<Table>,
}

/// Runs a simulation to its end and writes its folder.
///
/// # Errors
/// [`EngineError`] where physics stops it or a file cannot be written. What is whole stays;
/// `run.json` then says `"finished": false`.
pub fn run(simulation: &mut Simulation, options: RunOptions<'_>) -> Result<Outcome, EngineError> {
    let started = Instant::now();
    options.folder.remove_half_written();
    let files = RunFiles::create(options.folder.path(), simulation)?;
    let past = Past { remarks: simulation.remarks.clone(), ..Past::default() };
    drive(simulation, files, past, options, started)
}

/// Goes on with a run that [`crate::resume()`] has brought back. Its growing files are cut back to the
/// checkpoint. They end up as if the run had never been interrupted.
///
/// # Errors
/// As [`run`].
pub fn go_on(resumed: &mut Resumed, options: RunOptions<'_>) -> Result<Outcome, EngineError> {
    let started = Instant::now();
    let Resumed { simulation, marks, past, .. } = resumed;
    let files = RunFiles::resume(options.folder.path(), simulation, *marks)?;
    // First of all, since the scene in it may have more steps than before, or another instruction set.
    Checkpointer::new(options.folder.path(), &simulation.scene.checkpoint)
        .write_unwatched(simulation, *marks, past)?;
    options.folder.remove_half_written();
    files.refresh(simulation)?;
    drive(simulation, files, past.clone(), options, started)
}

fn drive(
    simulation: &mut Simulation,
    files: RunFiles,
    past: Past,
    options: RunOptions<'_>,
    started: Instant,
) -> Result<Outcome, EngineError> {
    let threads = options.threads;
    files.write_record(&RunRecord {
        // A run that goes on beyond its end has its tables there already.
        tables: options.folder.tables(),
        ..record::unfinished(simulation, threads, past.remarks.clone())
    })?;
    let mut recorder = Recorder {
        schedule: Schedule::of_output(&simulation.scene),
        total: simulation.scene.total_steps(),
        checkpoints: Checkpointer::new(options.folder.path(), &simulation.scene.checkpoint),
        before: aside(&simulation.state),
        is_alone: simulation.team.is_none(),
        files,
        past,
        started,
        options,
        ending: Ending::Finished,
    };
    if let Err(mut error) = recorder.follow(simulation) {
        if error.is_of_lost_folder() {
            // The folder belongs to another process now.
            return Err(error);
        }
        if let EngineError::Physics(failure) = &mut error {
            recorder.keep_evidence(simulation, failure);
        }
        // The record of a failed run is a courtesy: the error itself matters more than a second one.
        let remarks = recorder.past.remarks.iter().cloned().chain([error.to_string()]);
        let _ = recorder.files.write_record(&RunRecord {
            tables: recorder.options.folder.tables(),
            ..record::unfinished(simulation, threads, remarks)
        });
        return Err(error);
    }
    recorder.conclude(simulation)
}

/// Writes rows, frames and checkpoints, shows progress, and listens for a request to stop.
struct Recorder<'a> {
    files: RunFiles,
    checkpoints: Checkpointer,
    past: Past,
    started: Instant,
    options: RunOptions<'a>,
    schedule: Schedule,
    total: u64,
    /// A state with which nothing was wrong.
    before: State,
    /// Whether no other rank takes part.
    is_alone: bool,
    ending: Ending,
}

impl Recorder<'_> {
    /// Runs to the end, or to where it is told to stop, and leaves a checkpoint there.
    fn follow(&mut self, simulation: &mut Simulation) -> Result<(), EngineError> {
        if std::mem::take(&mut self.past.owes_output) {
            self.write(simulation)?;
        }
        simulation.run(self)?;
        self.checkpoint(simulation)
    }

    fn write(&mut self, simulation: &Simulation) -> Result<(), EngineError> {
        let measured = simulation.current_stage().measure;
        let due = |action| self.schedule.does(action, simulation.state.step, measured);
        let (row, frame) = (due(Action::Row), due(Action::Frame));
        let marks = self.files.marks();
        let mut written = Ok(());
        if row {
            written = self.files.write_thermo(simulation);
        }
        if frame {
            written = written.and_then(|()| {
                let remark = self.files.write_frame(simulation)?;
                let is_new = |remark: &String| !self.past.remarks.contains(remark);
                self.past.remarks.extend(remark.filter(is_new));
                Ok(())
            });
        }
        written.map_err(|error| {
            // What cannot be written now is written when the run goes on: where there is room for a checkpoint,
            // not a step is lost. Where there is none, the last one is as good as before.
            let past = Past { owes_output: true, ..self.past_until_now() };
            if simulation.watch_closely().is_ok() {
                let _ = self.checkpoints.write_unwatched(simulation, marks, &past);
            }
            error.into()
        })
    }

    fn past_until_now(&self) -> Past {
        Past { wall: self.past.wall + self.started.elapsed(), ..self.past.clone() }
    }

    fn checkpoint(&mut self, simulation: &mut Simulation) -> Result<(), EngineError> {
        let clock = Instant::now();
        let marks = self.files.synced_marks()?;
        let past = self.past_until_now();
        self.checkpoints.write(simulation, marks, &past)?;
        simulation.timers.write += clock.elapsed();
        Ok(())
    }

    /// Saves what shows how a run failed.
    fn keep_evidence(&self, simulation: &Simulation, failure: &mut PhysicsFailure) {
        let folder = self.files.folder();
        // Each is a courtesy: a second error must not hide the first. Numbers that are not finite are never written.
        if self.files.write_state("failed.xyz", simulation).is_ok() {
            let path = folder.join("failed.xyz");
            failure.kept.push(format!(
                "saved: {} (step {})",
                path.display(),
                simulation.state.step
            ));
        }
        if self.files.write_earlier_state("before-failure.xyz", &self.before).is_ok() {
            let path = folder.join("before-failure.xyz");
            failure.kept.push(format!(
                "saved: {} (step {}, before it)",
                path.display(),
                self.before.step
            ));
        }
        if let Ok(all) = lennard_io::CheckpointFolder::new(folder).list()
            && let Some((_, newest)) = all.first()
        {
            failure
                .kept
                .push(format!("the last good checkpoint is untouched: {}", newest.display()));
        }
    }

    /// Writes what comes at the end.
    fn conclude(&mut self, simulation: &mut Simulation) -> Result<Outcome, EngineError> {
        let clock = Instant::now();
        let findings: Vec<Findings> = simulation.findings();
        let tables: Vec<Table> = findings.iter().flat_map(|f| f.tables.iter().cloned()).collect();
        let finished = self.ending == Ending::Finished;
        // What looks like a result is written where the run is done; until then the checkpoint has it all.
        let listed: Vec<String> =
            tables.iter().map(|table| format!("{}.csv", table.name)).collect();
        if finished {
            let (threads, remarks) = (self.options.threads, self.past.remarks.clone());
            // Before the tables, so that none is there that no record lists.
            self.files.write_record(&RunRecord {
                tables: listed.clone(),
                ..record::unfinished(simulation, threads, remarks)
            })?;
            self.files.write_tables(&tables)?;
            self.files.write_state("final.xyz", simulation)?;
        }
        simulation.timers.write += clock.elapsed();
        let wall: Duration = self.past_until_now().wall;
        let mut record = record::finished(
            simulation,
            &findings,
            self.options.threads,
            wall,
            self.files.frames(),
            finished,
        );
        record.remarks.extend(self.past.remarks.iter().cloned());
        record.tables = match finished {
            true => listed,
            false => self.options.folder.tables(),
        };
        self.files.write_record(&record)?;
        Ok(Outcome { ending: self.ending, record, tables })
    }

    /// Whether and why to stop now.
    fn told_to_stop(&self) -> Option<Ending> {
        if self.options.stop.load(Ordering::Relaxed) {
            return Some(Ending::Stopped);
        }
        self.options
            .deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
            .then_some(Ending::OutOfTime)
    }
}

impl Follower for Recorder<'_> {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Clocks of ranks differ: several ranks wait for the step at which they agree.
    fn is_waiting(&self) -> bool {
        self.is_alone && self.checkpoints.time_is_up()
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let held = self.options.folder.still_held();
        held.map_err(EngineError::Folder)?;
        let clock = Instant::now();
        self.write(simulation)?;
        let step = simulation.state.step;
        let measured = simulation.current_stage().measure;
        if self.schedule.does(Action::Row, step, measured) {
            let fluid = || Instantaneous::of(simulation);
            self.options.progress.at_row(&fluid);
        }
        if self.schedule.does(Action::SetAside, step, measured) {
            set_aside(&simulation.state, &mut self.before);
        }
        simulation.timers.write += clock.elapsed();
        self.options.progress.update(&simulation.current_stage().name, step, self.total);
        let own = Decision { stop: self.told_to_stop(), checkpoint: self.checkpoints.time_is_up() };
        match next(simulation, &self.schedule, own)? {
            Next::Stop(ending) => {
                self.ending = ending;
                return Ok(ControlFlow::Break(()));
            }
            Next::Checkpoint => self.checkpoint(simulation)?,
            Next::GoOn => {}
        }
        Ok(ControlFlow::Continue(()))
    }
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
