//! What a user of the library does with a simulation: make it, run it, let it grow, ask it, save it.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, parallel};
use lennard_io::{Existing, RunRecord};
use lennard_scene::{Scene, SceneError};
use toml::{Table, Value};

use crate::checkpointing::snapshot;
use crate::follower::{Control, Ending, Progress};
use crate::own::OwnParts;
use crate::resume::restored;
use crate::run::Outcome;
use crate::simulation::Threads;
use crate::simulation::{Recording, Simulation};
use crate::start::start_from_arrays;
use crate::{EngineError, build, pressure};

impl Simulation {
    /// Places the particles of a scene and builds its forces. No step is done yet.
    ///
    /// # Errors
    /// [`EngineError`] for what is wrong with the scene and can only be seen now, such as a file of its start.
    pub fn new(scene: Scene) -> Result<Self, EngineError> {
        Self::with_parts(scene, OwnParts::none())
    }

    /// A simulation with forces, an integrator or observables that the program brings.
    ///
    /// The resolved scene names these parts in `[program]`. `lennard run` and `lennard resume` refuse it, since they have not
    /// got them.
    ///
    /// # Errors
    /// As [`Simulation::new`], and where a part does not keep its contract or does not go with the scene.
    pub fn with_parts(scene: Scene, parts: OwnParts) -> Result<Self, EngineError> {
        Self::made_on(None, || build::prepare_with(scene, None, parts))
    }

    /// A simulation that starts from arrays: box sides and positions in σ, velocities in σ/τ. Without velocities they are drawn
    /// for the temperature of the scene.
    ///
    /// The scene names a file in their place, such as `start.file = "start.xyz"`; it is not read.
    ///
    /// # Errors
    /// As [`Simulation::with_parts`]; [`EngineError::Start`] where the arrays differ in length or hold a number that is not finite.
    pub fn from_arrays(
        scene: Scene,
        sides: DVec3,
        positions: Vec<DVec3>,
        velocities: Option<Vec<DVec3>>,
        parts: OwnParts,
    ) -> Result<Self, EngineError> {
        let start = start_from_arrays(sides, positions, velocities)?;
        Self::made_on(None, || build::prepare_with(scene, Some(start), parts))
    }

    /// A simulation as it was when it was saved, to the bit. A checkpoint of a run in a folder is such a file too.
    ///
    /// # Errors
    /// [`EngineError`] where the file cannot be read, is of another version, or its simulation had parts of a program.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, EngineError> {
        Self::load_with_parts(path, &OwnParts::none())
    }

    /// As [`Simulation::load`], for a simulation that had these parts.
    ///
    /// # Errors
    /// As [`Simulation::load`], and where it had other parts.
    pub fn load_with_parts(path: impl AsRef<Path>, parts: &OwnParts) -> Result<Self, EngineError> {
        let path = path.as_ref();
        let checkpoint = lennard_io::read_checkpoint(path)?;
        Self::made_on(None, || restored(&checkpoint, path, parts))
    }

    /// A simulation that is made, and then works, on so many threads; on as many as pay for its particles where no number is given.
    ///
    /// # Errors
    /// As `make`, and [`EngineError::Threads`] where the system gives no threads.
    pub fn made_on(
        threads: Option<usize>,
        make: impl FnOnce() -> Result<Self, EngineError> + Send,
    ) -> Result<Self, EngineError> {
        let makers = Threads::new(threads.unwrap_or_else(parallel::processors))?;
        let made = makers.pool()?.install(make)?;
        match threads {
            Some(_) => Ok(Self { threads: Some(makers), ..made }),
            None => {
                let threads = build::recommended_threads(made.state.len());
                made.on_threads(threads)
            }
        }
    }

    /// The same simulation on so many threads, in the place of as many as pay. The bits do not depend on it.
    ///
    /// # Errors
    /// [`EngineError::Threads`] where the system gives none.
    pub fn on_threads(self, threads: usize) -> Result<Self, EngineError> {
        Ok(Self { threads: Some(Threads::new(threads)?), ..self })
    }

    /// Does work on the threads of the simulation.
    ///
    /// # Errors
    /// [`EngineError::Threads`] where a forked child gets none.
    pub fn on_its_threads<R: Send>(
        &mut self,
        work: impl FnOnce(&mut Self) -> R + Send,
    ) -> Result<R, EngineError> {
        match self.threads.as_ref().map(Threads::pool) {
            None => Ok(work(self)),
            Some(pool) => Ok(pool?.install(|| work(self))),
        }
    }

    /// Saves all that is needed to go on from here, to the bit. Rows and frames in memory are not saved.
    ///
    /// # Errors
    /// [`EngineError`] where the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), EngineError> {
        Ok(lennard_io::write_checkpoint(path.as_ref(), &snapshot(self))?)
    }

    /// Runs what is left of the scene.
    ///
    /// # Errors
    /// [`EngineError`] where physics stops the run.
    pub fn run(&mut self) -> Result<(), EngineError> {
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
    ) -> Result<Ending, EngineError> {
        self.run_until(u64::MAX, Control { stop, deadline: None, progress })
    }

    /// Takes so many steps. The last stage becomes longer where the scene would end.
    ///
    /// 400 steps and 600 steps have the bits and the averages of 1000 steps.
    ///
    /// # Errors
    /// As [`Simulation::run`], and where the last stage is a ramp.
    pub fn step(&mut self, steps: u64) -> Result<(), EngineError> {
        let planned = self.scene.total_steps();
        let end = self.state.step + steps;
        if end > planned {
            self.prolong(end - planned)?;
        }
        let stop = &AtomicBool::new(false);
        self.run_until(end, Control { stop, deadline: None, progress: &mut () }).map(drop)
    }

    /// Adds a stage with the keys of a `[[stage]]` table, and begins to measure anew. [`Simulation::run`] then runs it.
    ///
    /// # Errors
    /// [`EngineError::Scene`] where the stage is wrong, with the words of the scene reader.
    pub fn add_stage(&mut self, stage: toml::Table) -> Result<(), EngineError> {
        self.add(&Addition { stage: &stage.to_string(), observables: None, output: None })
    }

    /// Runs the whole scene into a new folder, with the files of `lennard run` to the byte except for the page.
    ///
    /// # Errors
    /// [`EngineError`] where steps were done before, the folder is taken, physics stops the run, or a file cannot be written.
    pub fn run_in_folder(&mut self, folder: impl AsRef<Path>) -> Result<RunRecord, EngineError> {
        let stop = &AtomicBool::new(false);
        let control = Control { stop, deadline: None, progress: &mut () };
        Ok(self.run_in(folder.as_ref(), Existing::Refuse, control)?.record)
    }

    /// As [`Simulation::run_in_folder`], where `existing` says what becomes of an earlier run there.
    ///
    /// # Errors
    /// As [`Simulation::run_in_folder`].
    pub fn run_in(
        &mut self,
        folder: &Path,
        existing: Existing,
        control: Control<'_>,
    ) -> Result<Outcome, EngineError> {
        if self.stage.is_some() {
            return Err(EngineError::Begun(self.state.step));
        }
        let folder =
            lennard_io::create_named_folder(folder, existing).map_err(EngineError::Folder)?;
        self.on_its_threads(|simulation| crate::run(simulation, &folder, control))?
    }
}

// A scene that grows while it is run: a stage is added, the last one is made longer, or the scene ends where it is.
//
// Such a scene may have no stage yet, or none that is measured. The run has the bits of one whose scene had the stages from
// the start, where the list was laid out alike.

/// A stage that is added to a scene, each part as TOML.
pub struct Addition<'a> {
    /// The keys of the stage.
    pub stage: &'a str,
    /// Tables `[[observable]]` in the place of the tables of the scene.
    pub observables: Option<&'a str>,
    /// Keys over the keys of `[output]`.
    pub output: Option<&'a str>,
}

/// A scene as the command line can run it: where no stage is measured, the last one is marked, which changes no step.
#[must_use]
pub fn text_to_run(scene: &Scene) -> String {
    let mut marked = scene.clone();
    let measures = scene.measured_stages().next().is_some();
    if let Some(last) = marked.stages.last_mut() {
        last.measure |= !measures;
    }
    marked.resolved_toml()
}

fn table(text: &str) -> Result<Table, SceneError> {
    // The reader of scenes says what is wrong with a text; it has read ours already.
    text.parse::<Table>().or_else(|_| Scene::parse(text, "scene", &[]).map(|_| Table::new()))
}

impl Simulation {
    /// Adds a stage and begins to measure anew. No stage before it is measured any more, and recorded rows and frames are dropped.
    ///
    /// # Errors
    /// [`EngineError::Scene`] for the first thing that is wrong with the stage.
    pub fn add(&mut self, addition: &Addition<'_>) -> Result<(), EngineError> {
        let scene = self.with_stage(addition).map_err(SceneError::without_line)?;
        let observers = build::observers(&scene, self.start_cell, &self.system, &self.own)?;
        self.goes_on_with(scene)?;
        self.observers = observers;
        self.measured_steps = 0;
        self.recording = Recording::default();
        Ok(())
    }

    /// Makes the last stage longer.
    ///
    /// # Errors
    /// [`EngineError::Scene`] where that stage is a ramp: a longer ramp is another one.
    pub fn prolong(&mut self, steps: u64) -> Result<(), EngineError> {
        let mut scene = self.scene_to_grow();
        let index = scene.stages.len().saturating_sub(1);
        let Some(last) = scene.stages.last_mut() else {
            return Ok(());
        };
        if last.is_ramp() {
            let key = format!("stage.{index}.steps");
            let found = format!("{steps} more steps of a ramp");
            let refused = scene.invalid(&key, found, "a new stage: run(steps, …)");
            return Err(refused.without_line().into());
        }
        last.steps = last.steps.saturating_add(steps);
        self.goes_on_with(scene)
    }

    /// Ends the stage under way here, and drops the stages after it.
    ///
    /// # Errors
    /// [`EngineError::Scene`] where the box does not fit the stages that are left.
    pub fn end_stage(&mut self) -> Result<(), EngineError> {
        let mut scene = self.scene_to_grow();
        match &self.stage {
            None => scene.stages.clear(),
            Some(under_way) => {
                scene.stages.truncate(under_way.index + 1);
                scene.stages[under_way.index].steps = under_way.steps_done.max(1);
            }
        }
        self.goes_on_with(scene)
    }

    /// The scene with its list as planned: stages that are added later then change nothing about it.
    fn scene_to_grow(&self) -> Scene {
        Scene { neighbor: self.list, ..self.scene.clone() }
    }

    fn with_stage(&self, addition: &Addition<'_>) -> Result<Scene, SceneError> {
        let scene = self.scene_to_grow();
        let mut all = table(&scene.resolved_toml())?;
        let stages = all.entry("stage").or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(stages) = stages {
            for stage in stages.iter_mut().filter_map(Value::as_table_mut) {
                stage.insert("measure".to_owned(), Value::Boolean(false));
            }
            stages.push(Value::Table(table(addition.stage)?));
        }
        if let Some(text) = addition.observables {
            let observables = table(text)?.remove("observable");
            all.insert("observable".to_owned(), observables.unwrap_or(Value::Array(Vec::new())));
        }
        if let (Some(text), Some(Value::Table(output))) = (addition.output, all.get_mut("output")) {
            output.extend(table(text)?);
        }
        Scene::parse_to_grow(&all.to_string(), scene.source.file(), &[])
    }

    /// Takes a scene that is [`Simulation::scene_to_grow`] with other stages to come.
    fn goes_on_with(&mut self, scene: Scene) -> Result<(), EngineError> {
        let skin = self.list.skin.unwrap_or(0.0);
        for remark in pressure::foresee(&scene, &self.state.cell, self.state.len(), skin)? {
            if !self.remarks.contains(&remark) {
                self.remarks.push(remark);
            }
        }
        self.scene = scene;
        Ok(())
    }
}
