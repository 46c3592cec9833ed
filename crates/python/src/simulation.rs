//! A simulation that Python holds.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, TryLockError};

use lennard_engine::{
    Addition, OwnParts, Results, Simulation, Threads, prepare_with, restored, text_to_run,
};
use lennard_io::{Existing, WriteError};
use lennard_scene::{Arrangement, Scene, shipped};
use numpy::PyArray2;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::inner::{self, Arrays, Inner};
use crate::scenes::Overrides;
use crate::view::View;
use crate::{errors, numbers, run, scenes};

/// A simulation. One thread of Python uses it at a time; another gets an error at once.
#[pyclass(frozen)]
pub struct Core {
    inner: Mutex<Inner>,
}

impl Core {
    fn around(inner: Inner) -> Self {
        Self { inner: Mutex::new(inner) }
    }

    /// The simulation, where no other thread uses it.
    fn used(&self) -> PyResult<MutexGuard<'_, Inner>> {
        match self.inner.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::WouldBlock) => Err(errors::busy(
                "a run of this simulation is under way in another thread; wait for it, or use a simulation for each thread",
            )),
            Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
                "an earlier run of this simulation ended in a bug of the program; load or make another simulation",
            )),
        }
    }

    /// The simulation with its state in place: no view is open.
    fn whole(&self) -> PyResult<MutexGuard<'_, Inner>> {
        let inner = self.used()?;
        if inner.view.is_some() {
            return Err(errors::busy(
                "a view of this simulation is open; leave its `with` block first",
            ));
        }
        Ok(inner)
    }
}

#[pymethods]
impl Core {
    /// A simulation of a scene file or of a scene that comes with the program. A lock file brings the settings of one that asks
    /// for an accuracy.
    #[staticmethod]
    #[pyo3(signature = (path, overrides, lock, threads))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        overrides: Overrides,
        lock: Option<PathBuf>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let path = shipped::locate(&path);
        let loaded = Scene::load_settled(&path, &overrides, lock.as_deref());
        let (scene, lock) = loaded.map_err(|e| errors::of_scene(&e))?;
        let processors = lennard_core::parallel::processors();
        let of_lock = lock.map(|l| l.threads.min(processors));
        let make = || lennard_engine::prepare(scene);
        Inner::made(py, true, threads.or(of_lock), make).map(Self::around)
    }

    /// A simulation of a scene from its text. `start` is positions, velocities and box sides in the place of a file.
    #[staticmethod]
    #[pyo3(signature = (text, name, overrides, threads, start))]
    fn parse(
        py: Python<'_>,
        text: &str,
        name: &str,
        overrides: Overrides,
        threads: Option<usize>,
        start: Option<Arrays<'_>>,
    ) -> PyResult<Self> {
        let scene = scenes::from_text(text, name, &overrides)?;
        let start = start.map(inner::start).transpose()?;
        let begin = start.clone();
        let make = || prepare_with(scene, begin, OwnParts::none());
        Ok(Self::around(Inner { start, ..Inner::made(py, false, threads, make)? }))
    }

    /// A simulation as it was when it was saved, to the bit.
    #[staticmethod]
    #[pyo3(signature = (path, threads))]
    fn load(py: Python<'_>, path: PathBuf, threads: Option<usize>) -> PyResult<Self> {
        let checkpoint =
            lennard_io::read_checkpoint(&path).map_err(|e| PyValueError::new_err(e.to_string()))?;
        let make = || restored(&checkpoint, &path, &OwnParts::none());
        Inner::made(py, false, threads, make).map(Self::around)
    }

    /// The same from bytes.
    #[staticmethod]
    #[pyo3(signature = (bytes, threads))]
    fn from_bytes(py: Python<'_>, bytes: &[u8], threads: Option<usize>) -> PyResult<Self> {
        let checkpoint = lennard_io::read_checkpoint_bytes(bytes)
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        let make = || restored(&checkpoint, "bytes".as_ref(), &OwnParts::none());
        Inner::made(py, false, threads, make).map(Self::around)
    }

    /// Saves all that is needed to go on from here to the bit.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let snapshot = self.whole()?.snapshot(py)?;
        lennard_io::write_checkpoint(&path, &snapshot)
            .map_err(|e| PyOSError::new_err(e.to_string()))
    }

    /// The bytes that `save` writes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let snapshot = self.whole()?.snapshot(py)?;
        Ok(PyBytes::new(py, &lennard_io::checkpoint_bytes(&snapshot)))
    }

    /// The scene as TOML, every default written out.
    fn scene(&self) -> PyResult<String> {
        let inner = self.used()?;
        Ok(text_to_run(&inner.simulation.scene))
    }

    /// Writes the scene, and the start where it came as arrays, into a folder.
    fn export(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let mut inner = self.used()?;
        std::fs::create_dir_all(&folder)?;
        let failed = |e: WriteError| PyOSError::new_err(e.to_string());
        let text = text_to_run(&inner.simulation.scene);
        lennard_io::write_text_atomically(&folder.join("scene.toml"), &text).map_err(failed)?;
        let Some(start) = inner.start.clone() else {
            return Ok(());
        };
        let written = inner.on_threads(py, move |simulation| {
            let Arrangement::File { path, .. } = &simulation.scene.system.start else {
                return Ok(Ok(()));
            };
            Ok(lennard_engine::write_start(&folder.join(path), simulation, &start))
        })?;
        written.map_err(failed)
    }

    /// Adds a stage and begins to measure anew; keys of the stage, observables and output come as TOML.
    #[pyo3(signature = (stage, observables, output))]
    fn add_stage(
        &self,
        py: Python<'_>,
        stage: &str,
        observables: Option<&str>,
        output: Option<&str>,
    ) -> PyResult<()> {
        let addition = Addition { stage, observables, output };
        self.whole()?.on_threads(py, |simulation| simulation.add(&addition))
    }

    /// Makes the last stage longer.
    fn prolong(&self, py: Python<'_>, steps: u64) -> PyResult<()> {
        self.whole()?.on_threads(py, |simulation| simulation.prolong(steps))
    }

    /// Ends the stage under way here, and drops the stages after it.
    fn end_stage(&self, py: Python<'_>) -> PyResult<()> {
        self.whole()?.on_threads(py, Simulation::end_stage)
    }

    /// Runs up to a step, or to the end of the scene, without Python's lock.
    #[pyo3(signature = (until, callback))]
    fn run(&self, py: Python<'_>, until: Option<u64>, callback: Option<Py<PyAny>>) -> PyResult<()> {
        let mut inner = self.whole()?;
        let pool = inner.pool()?;
        let Inner { simulation, from_file, .. } = &mut *inner;
        let until = until.unwrap_or(u64::MAX);
        let (done, raised) = run::watched(py, &pool, callback.as_ref(), |control| {
            simulation.run_until(until, control)
        });
        // Physics that failed is the more important news.
        if let Some(Err(error)) = done {
            return Err(errors::of_engine(error, *from_file));
        }
        raised
    }

    /// Runs the whole scene with the files that the command line writes; returns whether it came to its end, and the record.
    #[pyo3(signature = (folder, replace, report, callback))]
    fn run_in_folder(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        replace: bool,
        report: bool,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<String> {
        let mut inner = self.whole()?;
        let existing = if replace { Existing::Replace } else { Existing::Refuse };
        let record = run::in_folder(py, &mut inner, &folder, existing, report, callback.as_ref())?;
        as_json(&record)
    }

    /// The record of what was measured, as JSON, and the tables of the observables.
    fn results<'py>(&self, py: Python<'py>) -> PyResult<(String, Vec<Bound<'py, PyDict>>)> {
        let mut inner = self.whole()?;
        let found = inner.on_threads(py, |simulation| Ok(simulation.results()))?;
        let Results { record, tables } = found;
        let tables = tables.iter().map(|t| numbers::table(py, t));
        Ok((as_json(&record)?, tables.collect::<PyResult<_>>()?))
    }

    /// The rows of this run: the table that the command line writes to `thermo.csv`.
    fn thermo<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.used()?;
        numbers::table(py, &inner.simulation.thermo())
    }

    /// The frames of this run, as arrays by name.
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.used()?;
        numbers::frames(py, &inner.simulation.recording.frames, inner.simulation.state.len())
    }

    /// Lends the vectors of the state to a view; until it is closed, the simulation cannot be used.
    fn open_view(&self, py: Python<'_>) -> PyResult<Py<View>> {
        let mut inner = self.whole()?;
        if inner.simulation.stage.is_none() {
            inner.simulation.state.forces = inner.present_forces(py)?;
        }
        let view = View::open(py, &mut inner.simulation.state)?;
        inner.view = Some(view.clone_ref(py));
        Ok(view)
    }

    /// Takes the vectors back.
    fn close_view(&self) -> PyResult<()> {
        let mut inner = self.used()?;
        if let Some(view) = inner.view.take() {
            view.get().close(&mut inner.simulation.state);
        }
        Ok(())
    }

    /// A copy of the unwrapped positions, `[N, 3]`, σ.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        numbers::array(py, &self.whole()?.simulation.state.positions)
    }

    /// A copy of the velocities, `[N, 3]`, σ/τ.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        numbers::array(py, &self.whole()?.simulation.state.velocities)
    }

    /// A copy of the forces, `[N, 3]`, ε/σ.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        numbers::array(py, &self.whole()?.present_forces(py)?)
    }

    /// The box sides, σ.
    #[getter]
    fn lengths(&self) -> PyResult<[f64; 3]> {
        Ok(self.used()?.simulation.state.cell.lengths().to_array())
    }

    /// Steps done, steps of the scene, time in τ.
    #[getter]
    fn clock(&self) -> PyResult<(u64, u64, f64)> {
        let inner = self.used()?;
        let (step, time) = (inner.simulation.state.step, inner.simulation.state.time);
        Ok((step, step + inner.steps_left(), time))
    }

    /// Number of particles, number of molecules, mass of a particle.
    #[getter]
    fn size(&self) -> PyResult<(usize, usize)> {
        let system = &self.used()?.simulation.system;
        Ok((system.n_molecules() * system.molecules.sites(), system.n_molecules()))
    }

    /// Temperature, kinetic and potential energy of a particle, and pressure.
    fn moment(&self, py: Python<'_>) -> PyResult<(f64, f64, f64, f64)> {
        let moment = self.whole()?.on_threads(py, Simulation::moment)?;
        Ok((moment.temperature, moment.kinetic_energy, moment.potential_energy, moment.pressure))
    }

    /// Names of the stages with their steps, whether they are measured, and the index of the stage under way.
    #[getter]
    fn stages(&self) -> PyResult<(Vec<StageEntry>, Option<usize>)> {
        let inner = self.used()?;
        let simulation = &inner.simulation;
        let stages = simulation.scene.stages.iter();
        let all = stages.map(|s| (s.name.to_string(), s.steps, s.measure)).collect();
        Ok((all, simulation.stage.as_ref().map(|s| s.index)))
    }

    /// Name of the scene, the model in words, and threads.
    #[getter]
    fn names(&self) -> PyResult<(String, String, usize)> {
        let inner = self.used()?;
        let Simulation { scene, threads, .. } = &inner.simulation;
        let threads = threads.as_ref().map_or(1, Threads::count);
        Ok((scene.name.to_string(), scene.model_name(), threads))
    }

    /// Element and mass of each species, and the species of each particle.
    #[getter]
    fn species<'py>(&self, py: Python<'py>) -> PyResult<numbers::Species<'py>> {
        Ok(numbers::species(py, &self.used()?.simulation))
    }
}

/// A stage: its name, its steps, and whether it is measured.
type StageEntry = (String, u64, bool);

fn as_json(record: &lennard_io::RunRecord) -> PyResult<String> {
    serde_json::to_string(record).map_err(|e| PyValueError::new_err(e.to_string()))
}
