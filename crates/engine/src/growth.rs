//! A scene that grows while it is run: a stage is added, the last one is made longer, or the scene ends where it is.
//!
//! Such a scene may have no stage yet, or none that is measured. The run has the bits of one whose scene had the stages from
//! the start, where the list was laid out alike.

use lennard_scene::{Scene, SceneError};
use toml::{Table, Value};

use crate::recording::Recording;
use crate::simulation::Simulation;
use crate::{EngineError, build, pressure};

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
    let measures = scene.stages.iter().any(|stage| stage.measure);
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
        let (own, species) = (&self.own, self.system.species());
        let observers = build::observers(&scene, self.start_cell, species, own)?;
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
            let refused = scene.source.invalid(&key, found, "a new stage: run(steps, …)");
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
