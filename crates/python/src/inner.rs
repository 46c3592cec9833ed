//! What a simulation in Python is made of.

use std::sync::Arc;

use lennard_core::DVec3;
use lennard_engine::{EngineError, Simulation};
use lennard_io::{Checkpoint, StartConfiguration};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::view::View;
use crate::{errors, numbers};

/// A simulation with what belongs to it in Python.
pub struct Inner {
    pub simulation: Simulation,
    /// Whether lines of the scene mean anything to the user.
    pub from_file: bool,
    /// The start, where it came as arrays.
    pub start: Option<StartConfiguration>,
    /// The view that has the vectors of the state now.
    pub view: Option<Py<View>>,
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
    /// A simulation that is made, and then works, on so many threads, or on as many as pay.
    pub fn made(
        py: Python<'_>,
        from_file: bool,
        threads: Option<usize>,
        make: impl FnOnce() -> Result<Simulation, EngineError> + Send,
    ) -> PyResult<Self> {
        let made = py.detach(|| Simulation::made_on(threads, make));
        let simulation = made.map_err(|e| errors::of_engine(e, from_file))?;
        Ok(Self { simulation, from_file, start: None, view: None })
    }

    /// The threads of the simulation.
    pub fn pool(&self) -> PyResult<Arc<ThreadPool>> {
        let threads = self.simulation.threads.as_ref().expect("it was made on threads");
        threads.pool().map_err(|e| errors::of_engine(e.into(), false))
    }

    /// Does `work` on the threads of the simulation, without Python's lock.
    pub fn on_threads<R: Send>(
        &mut self,
        py: Python<'_>,
        work: impl FnOnce(&mut Simulation) -> Result<R, EngineError> + Send,
    ) -> PyResult<R> {
        let (pool, simulation) = (self.pool()?, &mut self.simulation);
        let done = py.detach(|| pool.install(|| work(simulation)));
        done.map_err(|e| errors::of_engine(e, self.from_file))
    }

    /// Forces on all particles where they are now, ε/σ.
    pub fn present_forces(&mut self, py: Python<'_>) -> PyResult<Vec<DVec3>> {
        self.on_threads(py, |simulation| simulation.present_forces())
    }

    /// All that is needed to go on from here, to the bit.
    pub fn snapshot(&mut self, py: Python<'_>) -> PyResult<Checkpoint> {
        self.on_threads(py, |simulation| Ok(lennard_engine::snapshot(simulation)))
    }

    /// Steps of the scene that are not done.
    pub fn steps_left(&self) -> u64 {
        self.simulation.scene.total_steps().saturating_sub(self.simulation.state.step)
    }
}
