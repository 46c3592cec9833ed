//! A scene on the workbench: one start, and short runs of it with any settings.

use std::sync::{Arc, Mutex, OnceLock};

use glam::DVec3;
use lennard_core::ForceError;
use lennard_engine::{EngineError, Simulation, measured_stage};
use lennard_forcefield::{PairForces, TruncationOptions};
use lennard_scene::{Scene, Stage};
use serde::{Deserialize, Serialize};

use super::start::Start;
use super::untruncated::Untruncated;
use crate::StudyError;
use crate::settings::Settings;

/// A scene with its equilibrated start, ready to be run with any settings.
///
/// It may be used from many threads at once; runs take as many threads as the pool that they are called in.
pub struct Workbench {
    scene: Scene,
    start: Start,
    pub(super) untruncated: OnceLock<Untruncated>,
    pub(super) tight: Mutex<Vec<Tight>>,
}

/// Where a tight trajectory ends, and how well that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct TightTrajectory {
    /// Unwrapped positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Root mean square distance from a trajectory with twice the step, σ.
    pub floor: f64,
}

/// A tight trajectory that is known.
pub(super) struct Tight {
    pub truncation: TruncationOptions,
    pub time: f64,
    pub trajectory: Arc<TightTrajectory>,
}

/// A run that failed: a result, and no error of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failed {
    /// Why, in a line.
    pub reason: String,
    /// Step at which it was found, where that is known.
    pub step: Option<u64>,
}

impl Failed {
    /// Takes physics that failed as a result, and hands any other error back.
    ///
    /// # Errors
    /// The error itself where it is not about physics.
    pub fn or<T>(result: Result<T, StudyError>) -> Result<Result<T, Self>, StudyError> {
        let (reason, step) = match result {
            Ok(found) => return Ok(Ok(found)),
            Err(StudyError::Engine(EngineError::Physics(failure))) => {
                let reason = failure.to_string().lines().next().unwrap_or_default().to_owned();
                (reason, Some(failure.step))
            }
            Err(error @ StudyError::Step { .. }) => (error.to_string(), None),
            Err(other) => return Err(other),
        };
        Ok(Err(Self { reason, step }))
    }
}

/// A stage of a run on the workbench, in the ensemble of the scene's measured stage.
pub(crate) struct ShortStage {
    pub(crate) steps: u64,
    pub(crate) measure: bool,
}

/// The error of forces that cannot be evaluated under some settings.
pub(super) fn failed_forces(settings: &Settings, source: ForceError) -> StudyError {
    StudyError::Force { label: settings.label(), source }
}

impl Workbench {
    /// Equilibrates the scene with its own settings.
    ///
    /// # Errors
    /// [`StudyError::Engine`] where the scene cannot be built or its equilibration fails.
    pub fn new(scene: &Scene) -> Result<Self, StudyError> {
        Ok(Self::with_start(scene, Start::equilibrate(scene)?))
    }

    /// The same from a start that is there already.
    pub(crate) fn with_start(scene: &Scene, start: Start) -> Self {
        Self { scene: scene.clone(), start, untruncated: OnceLock::new(), tight: Mutex::default() }
    }

    /// The scene as it was given.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Where all runs begin.
    #[must_use]
    pub fn start(&self) -> &Start {
        &self.start
    }

    /// The stage of the scene that is measured.
    pub(crate) fn measured_stage(&self) -> &Stage {
        measured_stage(&self.scene)
    }

    /// Whether these settings can run this scene in this box.
    ///
    /// # Errors
    /// [`StudyError::Settings`] with the reason.
    pub fn check(&self, settings: &Settings) -> Result<(), StudyError> {
        let scene = settings.apply(&self.scene)?;
        let (cell, n) = (self.start.cell, self.start.len());
        let mixture = scene.mixture_of(&self.start.species);
        let conditions = lennard_engine::conditions(&scene, cell, n, mixture.as_ref());
        lennard_forcefield::check(&scene.force_field(), &conditions)
            .map_err(|e| StudyError::Settings { label: settings.label(), reason: e.to_string() })
    }

    /// The forces under these settings, for the start.
    pub(super) fn forces(&self, settings: &Settings) -> Result<PairForces, StudyError> {
        let scene = settings.apply(&self.scene)?;
        Ok(self.start.forces(&scene)?)
    }

    /// A simulation from the start with these stages, at the density of the start; thermodynamics is sampled on each
    /// `sample_every`th step.
    pub(crate) fn simulation(
        &self,
        settings: &Settings,
        stages: &[ShortStage],
        sample_every: u64,
    ) -> Result<Simulation, StudyError> {
        let mut scene = settings.apply(&self.scene)?;
        let measured = measured_stage(&scene).clone();
        scene.observables.clear();
        scene.output.thermo_every = sample_every;
        let stage = |(i, stage): (usize, &ShortStage)| Stage {
            name: format!("part-{}", i + 1).as_str().into(),
            steps: stage.steps,
            measure: stage.measure,
            temperature_from: None,
            barostat: None,
            exchange: None,
            ..measured.clone()
        };
        scene.stages = stages.iter().enumerate().map(stage).collect();
        Ok(self.start.simulation(scene)?)
    }

    /// The time step that a measured stage takes under these settings, τ.
    pub(crate) fn stage_dt(&self, settings: &Settings) -> f64 {
        let own = self.scene.stage_dt(self.measured_stage());
        settings.dt * own / self.scene.integrator.dt
    }
}
