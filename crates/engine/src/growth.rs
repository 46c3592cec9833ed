//! A scene that grows while it is run: stages are added, or the last one is made longer.
//!
//! The run then has the bits of one whose scene had the stages from the start, where the list was laid out alike.

use lennard_scene::{Scene, SceneError};

use crate::simulation::Simulation;
use crate::{EngineError, build, pressure};

/// What becomes of the samples so far where the scene grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measurement {
    /// Observables begin anew, as the new scene has them.
    Anew,
    /// They go on as they are.
    GoesOn,
}

impl Simulation {
    /// The scene with its list as planned: stages that are added later then change nothing about it.
    #[must_use]
    pub fn scene_to_grow(&self) -> Scene {
        Scene { neighbor: self.list, ..self.scene.clone() }
    }

    /// Goes on with a scene that is [`Simulation::scene_to_grow`] with other stages to come.
    ///
    /// Stages that are done stay. Steps of the stage under way, what is measured, and the output may change.
    ///
    /// # Errors
    /// [`EngineError::Scene`] where the scene differs in anything else, and for what does not fit.
    pub fn grow(&mut self, scene: Scene, measurement: Measurement) -> Result<(), EngineError> {
        self.goes_on_as(&scene)?;
        let n = self.state.len();
        let skin = self.list.skin.unwrap_or(0.0);
        let remarks = pressure::foresee(&scene, &self.state.cell, n, skin)?;
        if measurement == Measurement::Anew {
            self.observers =
                build::observers(&scene, self.start_cell, self.system.species(), &self.own)?;
            self.measured_steps = 0;
        }
        for remark in remarks {
            if !self.remarks.contains(&remark) {
                self.remarks.push(remark);
            }
        }
        self.scene = scene;
        Ok(())
    }

    /// Refuses a scene that is not this one with other stages to come.
    fn goes_on_as(&self, scene: &Scene) -> Result<(), SceneError> {
        let refuse = |key: &str, found: String, allowed: &str| {
            Err(scene.source.invalid(key, found, allowed))
        };
        let grown = Scene {
            name: scene.name.clone(),
            stages: scene.stages.clone(),
            observables: scene.observables.clone(),
            output: scene.output.clone(),
            checkpoint: scene.checkpoint.clone(),
            ..self.scene_to_grow()
        };
        if grown != *scene {
            let allowed = "the scene of the simulation; stages, observables and output may change";
            return refuse("system", "another scene".to_owned(), allowed);
        }
        let Some(under_way) = &self.stage else {
            return Ok(());
        };
        for index in 0..=under_way.index {
            let key = format!("stage.{index}");
            let was = &self.scene.stages[index];
            let least = match index == under_way.index {
                true => under_way.steps_done,
                false => was.steps,
            };
            let Some(now) = scene.stages.get(index) else {
                let allowed = "all stages that have begun";
                return refuse(&key, "nothing".to_owned(), allowed);
            };
            let mut as_now = was.clone();
            as_now.measure = now.measure;
            if index == under_way.index && now.steps >= least {
                as_now.steps = now.steps;
            }
            if as_now != *now {
                let found = format!("another stage `{}`", now.name);
                let allowed = format!("stage `{}` as it was run, {least} steps or more", was.name);
                return refuse(&key, found, &allowed);
            }
        }
        Ok(())
    }
}
