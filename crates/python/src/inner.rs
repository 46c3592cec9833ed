//! What a simulation in Python is made of.

use std::path::Path;

use lennard_core::{DVec3, parallel};
use lennard_engine::{
    EngineError, Measurement, OwnParts, Recording, Simulation, planned_steps, recommended_threads,
};
use lennard_io::{Checkpoint, StartConfiguration};
use lennard_scene::{Scene, SceneError};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::threads::Threads;
use crate::view::View;
use crate::{errors, numbers};

/// A simulation with what belongs to it.
pub struct Inner {
    pub simulation: Simulation,
    pub recording: Recording,
    pub threads: Threads,
    /// Whether lines of the scene mean anything to the user.
    pub from_file: bool,
    /// The start, where it came as arrays.
    pub start: Option<StartConfiguration>,
    /// The view that has the vectors of the state now.
    pub view: Option<Py<View>>,
}

/// The parts that a simulation is made from.
pub struct Made {
    pub scene: Scene,
    pub from_file: bool,
    pub threads: Option<usize>,
    pub start: Option<StartConfiguration>,
}

/// Positions, velocities and box sides.
pub type Arrays<'py> = (PyReadonlyArray2<'py, f64>, Option<PyReadonlyArray2<'py, f64>>, [f64; 3]);

/// A start from arrays.
pub fn start((positions, velocities, lengths): Arrays<'_>) -> PyResult<StartConfiguration> {
    let positions = numbers::vectors(&positions, "positions")?;
    let velocities = velocities.map(|v| numbers::vectors(&v, "velocities")).transpose()?;
    lennard_engine::start_from_arrays(DVec3::from_array(lengths), positions, velocities)
        .map_err(|e| PyValueError::new_err(e.to_string()))
}

impl Inner {
    /// Prepares a scene.
    pub fn make(py: Python<'_>, made: Made) -> PyResult<Self> {
        let Made { scene, from_file, threads, start } = made;
        let begin = start.clone();
        let prepare = || lennard_engine::prepare_with(scene, begin, OwnParts::none());
        Ok(Self { start, ..Self::built(py, from_file, threads, prepare)? })
    }

    /// Brings a saved simulation back.
    pub fn restored(
        py: Python<'_>,
        checkpoint: &Checkpoint,
        path: &Path,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        Self::built(py, false, threads, || lennard_engine::restored(checkpoint, path))
    }

    fn built(
        py: Python<'_>,
        from_file: bool,
        asked: Option<usize>,
        build: impl FnOnce() -> Result<Simulation, EngineError> + Send,
    ) -> PyResult<Self> {
        let mut threads = Threads::new(asked.unwrap_or_else(parallel::processors))?;
        let built = threads.run(py, build)?;
        let simulation = built.map_err(|e| errors::of_engine(e, from_file))?;
        if asked.is_none() {
            threads = Threads::new(recommended_threads(simulation.state.len()))?;
        }
        Ok(Self {
            simulation,
            recording: Recording::default(),
            threads,
            from_file,
            start: None,
            view: None,
        })
    }

    /// Does `work` on the threads of the simulation.
    pub fn on_threads<R: Send>(
        &mut self,
        py: Python<'_>,
        work: impl FnOnce(&mut Simulation) -> R + Send,
    ) -> PyResult<R> {
        let simulation = &mut self.simulation;
        self.threads.run(py, move || work(simulation))
    }

    /// Forces on all particles where they are now, ε/σ.
    pub fn present_forces(&mut self, py: Python<'_>) -> PyResult<Vec<DVec3>> {
        let forces = self.on_threads(py, |simulation| simulation.present_forces())?;
        forces.map_err(|e| errors::of_engine(e, self.from_file))
    }

    /// All that is needed to go on from here, to the bit.
    pub fn snapshot(&mut self, py: Python<'_>) -> PyResult<Checkpoint> {
        self.on_threads(py, |simulation| lennard_engine::snapshot(simulation))
    }

    /// Takes a scene with other stages to come.
    pub fn grow(
        &mut self,
        py: Python<'_>,
        scene: Result<Scene, SceneError>,
        measurement: Measurement,
    ) -> PyResult<()> {
        let scene = scene.map_err(|e| errors::of_scene(&e))?;
        self.on_threads(py, |simulation| simulation.grow(scene, measurement))?
            .map_err(|e| errors::of_engine(e, false))?;
        if measurement == Measurement::Anew {
            self.recording = Recording::default();
        }
        Ok(())
    }

    /// Steps of the scene that are not done.
    pub fn steps_left(&self) -> u64 {
        let steps = planned_steps(&self.simulation.scene);
        steps.saturating_sub(self.simulation.state.step)
    }
}
