//! A simulation in memory.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, State, Table};
use lennard_engine::{
    Addition, Ending, EngineError, KeptFrame, Measurement, MemoryOptions, Moment, OwnParts,
    Progress, Recording, RunOptions,
};
use lennard_io::{Existing, RunRecord};
use lennard_scene::Scene;
use rayon::ThreadPool;

use crate::{Error, Result, Results};

/// A simulation of a scene, with its threads and with what it has measured.
pub struct Simulation {
    engine: lennard_engine::Simulation,
    recording: Recording,
    pool: ThreadPool,
}

impl Simulation {
    /// Places the particles of a scene and builds its forces. No step is done yet.
    ///
    /// # Errors
    /// [`Error::Engine`] for what is wrong with the scene and can only be seen now, such as a file of its start.
    pub fn new(scene: Scene) -> Result<Self> {
        Self::with_parts(scene, OwnParts::none())
    }

    /// A simulation with forces, an integrator or observables that the program brings.
    ///
    /// The resolved scene names these parts in `[program]`. `lennard run` and `lennard resume` refuse it, since they have not
    /// got them.
    ///
    /// # Errors
    /// As [`Simulation::new`], and where a part does not keep its contract or does not go with the scene.
    pub fn with_parts(scene: Scene, parts: OwnParts) -> Result<Self> {
        Self::around(lennard_engine::prepare_with(scene, None, parts)?)
    }

    /// A simulation that starts from arrays: box sides and positions in σ, velocities in σ/τ. Without velocities they are drawn
    /// for the temperature of the scene.
    ///
    /// The scene names a file in their place, such as `start.file = "start.xyz"`; it is not read.
    ///
    /// # Errors
    /// As [`Simulation::with_parts`]; [`Error::Start`] where the arrays differ in length or hold a number that is not finite.
    pub fn from_arrays(
        scene: Scene,
        sides: DVec3,
        positions: Vec<DVec3>,
        velocities: Option<Vec<DVec3>>,
        parts: OwnParts,
    ) -> Result<Self> {
        let start = lennard_engine::start_from_arrays(sides, positions, velocities)?;
        Self::around(lennard_engine::prepare_with(scene, Some(start), parts)?)
    }

    /// A simulation as it was when it was saved, to the bit. A checkpoint of a run in a folder is such a file too.
    ///
    /// # Errors
    /// [`Error`] where the file cannot be read, is of another version, or its simulation had parts of a program.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        Self::load_with_parts(path, &OwnParts::none())
    }

    /// As [`Simulation::load`], for a simulation that had these parts.
    ///
    /// # Errors
    /// As [`Simulation::load`], and where it had other parts.
    pub fn load_with_parts(path: impl AsRef<Path>, parts: &OwnParts) -> Result<Self> {
        let path = path.as_ref();
        let checkpoint = lennard_io::read_checkpoint(path)?;
        Self::around(lennard_engine::restored_with(&checkpoint, path, parts)?)
    }

    fn around(engine: lennard_engine::Simulation) -> Result<Self> {
        let threads = lennard_engine::recommended_threads(engine.state.len());
        Ok(Self { pool: pool(threads)?, recording: Recording::default(), engine })
    }

    /// The same simulation on so many threads, in the place of as many as pay. The bits do not depend on it.
    ///
    /// # Errors
    /// [`Error::Threads`] where the system gives none.
    pub fn on_threads(self, threads: usize) -> Result<Self> {
        Ok(Self { pool: pool(threads)?, ..self })
    }

    /// Saves all that is needed to go on from here, to the bit. Rows and frames in memory are not saved.
    ///
    /// # Errors
    /// [`Error::Engine`] where the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let snapshot = lennard_engine::snapshot(&self.engine);
        let written = lennard_io::write_checkpoint(path.as_ref(), &snapshot);
        written.map_err(|e| EngineError::from(e).into())
    }

    /// Runs what is left of the scene.
    ///
    /// # Errors
    /// [`Error::Engine`] where physics stops the run.
    pub fn run(&mut self) -> Result<()> {
        self.run_watched(&AtomicBool::new(false), &mut ()).map(drop)
    }

    /// As [`Simulation::run`], and tells how far it is. It stops a few steps after `stop` is set, and a later call goes on to
    /// the same bits.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn run_watched(
        &mut self,
        stop: &AtomicBool,
        progress: &mut dyn Progress,
    ) -> Result<Ending> {
        let end = lennard_engine::planned_steps(&self.engine.scene);
        self.run_to(end, stop, progress)
    }

    /// Takes so many steps. The last stage becomes longer where the scene would end.
    ///
    /// 400 steps and 600 steps have the bits and the averages of 1000 steps.
    ///
    /// # Errors
    /// As [`Simulation::run`], and where the last stage is a ramp.
    pub fn step(&mut self, steps: u64) -> Result<()> {
        let planned = lennard_engine::planned_steps(&self.engine.scene);
        let end = self.engine.state.step + steps;
        if end > planned {
            let longer = lennard_engine::prolonged(&self.engine, end - planned)?;
            self.engine.grow(longer, Measurement::GoesOn)?;
        }
        self.run_to(end, &AtomicBool::new(false), &mut ()).map(drop)
    }

    fn run_to(
        &mut self,
        end: u64,
        stop: &AtomicBool,
        progress: &mut dyn Progress,
    ) -> Result<Ending> {
        if self.engine.state.step >= end {
            return Ok(Ending::Finished);
        }
        let Self { engine, recording, pool } = self;
        let options = MemoryOptions { until: Some(end), stop, progress };
        Ok(pool.install(|| lennard_engine::run_in_memory(engine, recording, options))?)
    }

    /// Adds a stage with the keys of a `[[stage]]` table, and begins to measure anew. [`Simulation::run`] then runs it.
    ///
    /// # Errors
    /// [`Error::Engine`] where the stage is wrong, with the words of the scene reader.
    pub fn add_stage(&mut self, stage: toml::Table) -> Result<()> {
        let addition = Addition { stage: &stage.to_string(), observables: None, output: None };
        let scene = lennard_engine::with_stage(&self.engine, &addition)?;
        self.engine.grow(scene, Measurement::Anew)?;
        self.recording = Recording::default();
        Ok(())
    }

    /// Runs the whole scene into a new folder, with the files of `lennard run` to the byte except for the page.
    ///
    /// # Errors
    /// [`Error`] where steps were done before, the folder is taken, physics stops the run, or a file cannot be written.
    pub fn run_in_folder(&mut self, folder: impl AsRef<Path>) -> Result<RunRecord> {
        if self.engine.stage.is_some() {
            return Err(Error::Begun(self.engine.state.step));
        }
        let folder = lennard_io::create_named_folder(folder.as_ref(), Existing::Refuse)
            .map_err(EngineError::Folder)?;
        let (engine, threads) = (&mut self.engine, self.pool.current_num_threads());
        let outcome = self.pool.install(|| {
            let options = RunOptions {
                folder: &folder,
                threads,
                stop: &AtomicBool::new(false),
                deadline: None,
                progress: &mut (),
            };
            lennard_engine::run(engine, options)
        })?;
        Ok(outcome.record)
    }

    /// What was measured since the start, or since the last stage was added.
    #[must_use]
    pub fn results(&self) -> Results {
        let threads = self.pool.current_num_threads();
        let (record, tables) = self.recording.results(&self.engine, threads);
        Results { record, tables }
    }

    /// The rows that a run with files writes to `thermo.csv`.
    #[must_use]
    pub fn thermo(&self) -> Table {
        self.recording.thermo_table(&self.engine)
    }

    /// The frames of measured stages, where the scene has `output.trajectory_every`.
    #[must_use]
    pub fn frames(&self) -> &[KeptFrame] {
        &self.recording.frames
    }

    /// Box, positions, velocities and forces as they are, with step and time.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.engine.state
    }

    /// Temperature, energies and pressure as they are. The bits of later steps do not change.
    ///
    /// # Errors
    /// [`Error::Engine`] where a force is not finite.
    pub fn moment(&mut self) -> Result<Moment> {
        let engine = &mut self.engine;
        Ok(self.pool.install(|| engine.moment())?)
    }

    /// The scene, every default filled in; [`Scene::resolved_toml`] is its text.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.engine.scene
    }
}

fn pool(threads: usize) -> Result<ThreadPool> {
    Ok(lennard_core::parallel::pool(threads)?)
}
