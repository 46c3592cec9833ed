//! One run from scene to finished folder.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use lennard_core::{Findings, Table, Want};
use lennard_io::{RunRecord, WriteError};
use lennard_scene::Scene;

use crate::files::RunFiles;
use crate::simulation::{Follower, Simulation, Verdict};
use crate::{EngineError, build, record};

/// Told how far a run is, after every step.
pub trait Progress: Send {
    /// `done` of `total` steps, in the stage of this name.
    fn update(&mut self, stage: &str, done: u64, total: u64);
}

impl Progress for () {
    fn update(&mut self, _stage: &str, _done: u64, _total: u64) {}
}

/// How to run.
pub struct RunOptions<'a> {
    /// The output folder, which exists and is empty.
    pub folder: &'a Path,
    /// Threads in use, for the record.
    pub threads: usize,
    /// Set from outside to stop after the current step.
    pub stop: &'a AtomicBool,
    /// Told how far the run is.
    pub progress: &'a mut dyn Progress,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// All stages are done.
    Finished,
    /// It was asked to stop.
    Stopped,
}

/// What a run gives back.
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// The run record, as written to `run.json`.
    pub record: RunRecord,
    /// The tables of the observables, as written.
    pub tables: Vec<Table>,
}

/// Builds a scene into a simulation, before anything is written.
///
/// # Errors
/// [`EngineError`] for everything that is wrong with the scene.
pub fn prepare(scene: Scene) -> Result<Simulation, EngineError> {
    build::simulation(scene)
}

/// Runs a simulation to its end and writes its folder.
///
/// # Errors
/// [`EngineError`] where physics stops it or a file cannot be written. What is whole stays;
/// `run.json` then says `"finished": false`.
pub fn run(simulation: &mut Simulation, options: RunOptions<'_>) -> Result<Outcome, EngineError> {
    let started = Instant::now();
    let files = RunFiles::create(options.folder, simulation)?;
    files.write_record(&record::unfinished(simulation, options.threads, None))?;
    let total = simulation.scene.total_steps();
    let mut follower = Recorder { files, stop: options.stop, progress: options.progress, total };
    let done = match simulation.run(&mut follower) {
        Ok(done) => done,
        Err(error) => {
            // The record of a failed run is a courtesy: the error itself matters more than a second one.
            let note = Some(error.to_string());
            let _ = follower.files.write_record(&record::unfinished(simulation, options.threads, note));
            if matches!(error, EngineError::Physics(_)) {
                let _ = follower.files.write_state("failed.xyz", simulation);
            }
            return Err(error);
        }
    };
    let findings: Vec<Findings> = simulation.findings();
    let clock = Instant::now();
    let tables: Vec<Table> = findings.iter().flat_map(|f| f.tables.iter().cloned()).collect();
    follower.files.write_tables(&tables)?;
    follower.files.write_state("final.xyz", simulation)?;
    follower.files.marks()?;
    simulation.timers.write += clock.elapsed();
    let ending = if done { Ending::Finished } else { Ending::Stopped };
    let record =
        record::finished(
            simulation,
            &findings,
            options.threads,
            started.elapsed(),
            follower.files.frames(),
            ending == Ending::Finished,
        );
    follower.files.write_record(&record)?;
    Ok(Outcome { ending, record, tables })
}

/// Writes rows and frames, shows progress, and listens for a request to stop.
struct Recorder<'a> {
    files: RunFiles,
    stop: &'a AtomicBool,
    progress: &'a mut dyn Progress,
    total: u64,
}

impl Recorder<'_> {
    fn write(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let step = simulation.state.step;
        let output = &simulation.scene.output;
        if step.is_multiple_of(output.thermo_every) {
            self.files.write_thermo(simulation)?;
        }
        if simulation.current_stage().measure && output.trajectory_every.is_some_and(|e| step.is_multiple_of(e)) {
            self.files.write_frame(simulation)?;
        }
        Ok(())
    }
}

impl Follower for Recorder<'_> {
    fn want(&self, scene: &Scene, step: u64, measured: bool) -> Want {
        let output = &scene.output;
        let row = step.is_multiple_of(output.thermo_every);
        let frame = measured && output.trajectory_every.is_some_and(|e| step.is_multiple_of(e));
        if row || frame { Want::ENERGY_AND_VIRIAL } else { Want::NOTHING }
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        let clock = Instant::now();
        self.write(simulation)?;
        simulation.timers.write += clock.elapsed();
        self.progress.update(&simulation.current_stage().name, simulation.state.step, self.total);
        Ok(if self.stop.load(Ordering::Relaxed) { Verdict::Stop } else { Verdict::Continue })
    }
}
