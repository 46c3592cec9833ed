//! The fluid of a study of claims: a study file whose points run from starts that they share.

use std::path::Path;

use lennard_engine::measured_stage;
use lennard_scene::{Scene, Stage};

use crate::StudyError;
use crate::jobs::side_by_side;
use crate::lab::Start;
use crate::sweep::{self, Point, SweepError};

/// A study file whose reading judges claims, such as `reading = "stability"`.
pub struct FluidStudy {
    /// The base scene, with the method and the bonds that starts are equilibrated with.
    pub base: Scene,
    /// The points of the file.
    pub points: Vec<Point>,
    /// Whether the file is a user's own.
    pub(crate) is_own: bool,
}

impl FluidStudy {
    /// Reads a study file; where none is named, the shipped file of the reading.
    ///
    /// # Errors
    /// [`SweepError`] where the file has another reading, or its points differ in what the reading does not compare.
    pub fn read(reading: &str, file: Option<&Path>, quick: bool) -> Result<Self, SweepError> {
        let size = if quick { "-quick" } else { "" };
        let shipped = format!("shipped:/studies/{reading}{size}.toml");
        let file_or_shipped = file.unwrap_or(shipped.as_ref());
        let (base, study) = sweep::of_command(reading, file_or_shipped, &[])?;
        Ok(Self { base, points: study.points, is_own: file.is_some() })
    }

    /// How long the run of a point is, τ: as many steps of the base scene as its measured stage has.
    pub(crate) fn time(&self, point: &Point) -> f64 {
        measured_stage(&point.scene).steps as f64 * self.base.integrator.dt
    }

    /// Starts in equilibrium, and the start of each point. Points that begin alike share one.
    pub(crate) fn starts(
        &self,
        done: impl FnMut(f64),
    ) -> Result<(Vec<Start>, Vec<usize>), StudyError> {
        let (mut scenes, mut of_points): (Vec<Scene>, Vec<usize>) = (Vec::new(), Vec::new());
        for point in &self.points {
            let scene = self.beginning(&point.scene);
            let known = scenes.iter().position(|known| *known == scene);
            of_points.push(known.unwrap_or(scenes.len()));
            scenes.extend(known.is_none().then_some(scene));
        }
        let starts = side_by_side(&scenes, Start::equilibrate, done);
        Ok((starts.into_iter().collect::<Result<_, _>>()?, of_points))
    }

    /// The scene that a point begins with: in state and model the point's, in all else the base scene.
    fn beginning(&self, point: &Scene) -> Scene {
        let mut scene = Scene {
            system: point.system.clone(),
            truncation: point.truncation,
            stages: point.stages.clone(),
            ..self.base.clone()
        };
        scene.system.seed = self.base.system.seed;
        for stage in scene.stages.iter_mut().filter(|stage| stage.measure) {
            let measured = measured_stage(&self.base).clone();
            *stage = Stage { temperature: stage.temperature, ..measured };
        }
        scene
    }
}
