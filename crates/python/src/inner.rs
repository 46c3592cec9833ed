//! What a simulation in Python is made of.

use std::path::Path;

use lennard_core::DVec3;
use lennard_core::parallel::PoolError;
use lennard_engine::{Measurement, OwnParts, Recording, Simulation, planned_steps};
use lennard_io::{Checkpoint, StartConfiguration};
use lennard_scene::{Scene, SceneError};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::view::View;
use crate::{errors, numbers};

/// Threads that live as long as a simulation.
pub fn pool(threads: usize) -> PyResult<ThreadPool> {
    lennard_core::parallel::pool(threads).map_err(|e| match e {
        PoolError::Number(_) => PyValueError::new_err(e.to_string()),
        PoolError::System(e) => PyRuntimeError::new_err(format!("starting threads: {e}")),
    })
}

/// A simulation with what belongs to it.
pub struct Inner {
    pub simulation: Simulation,
    pub recording: Recording,
    pub pool: ThreadPool,
    pub threads: usize,
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
pub type Arrays<'py> = (
    PyReadonlyArray2<'py, f64>,
    Option<PyReadonlyArray2<'py, f64>>,
    [f64; 3],
);

/// A start from arrays.
pub fn start((positions, velocities, lengths): Arrays<'_>) -> PyResult<StartConfiguration> {
    let positions = numbers::vectors(&positions, "positions")?;
    let velocities = velocities
        .map(|v| numbers::vectors(&v, "velocities"))
        .transpose()?;
    lennard_engine::start_from_arrays(DVec3::from_array(lengths), positions, velocities)
        .map_err(|e| PyValueError::new_err(e.to_string()))
}

impl Inner {
    /// Prepares a scene.
    pub fn make(py: Python<'_>, made: Made) -> PyResult<Self> {
        let Made {
            scene,
            from_file,
            threads,
            start,
        } = made;
        let prepared =
            py.detach(|| lennard_engine::prepare_with(scene, start.clone(), OwnParts::none()));
        let simulation = prepared.map_err(|e| errors::of_engine(e, from_file))?;
        Ok(Self {
            start,
            ..Self::around(simulation, from_file, threads)?
        })
    }

    /// Brings a saved simulation back.
    pub fn restored(
        checkpoint: &Checkpoint,
        path: &Path,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let simulation =
            lennard_engine::restored(checkpoint, path).map_err(|e| errors::of_engine(e, false))?;
        Self::around(simulation, false, threads)
    }

    fn around(simulation: Simulation, from_file: bool, threads: Option<usize>) -> PyResult<Self> {
        let n = simulation.state.len();
        let threads = threads.unwrap_or_else(|| lennard_engine::recommended_threads(n));
        Ok(Self {
            simulation,
            recording: Recording::default(),
            pool: pool(threads)?,
            threads,
            from_file,
            start: None,
            view: None,
        })
    }

    /// Takes a scene with other stages to come.
    pub fn grow(
        &mut self,
        scene: Result<Scene, SceneError>,
        measurement: Measurement,
    ) -> PyResult<()> {
        let scene = scene.map_err(|e| errors::of_scene(&e))?;
        self.simulation
            .grow(scene, measurement)
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
