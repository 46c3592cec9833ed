//! Errors of the engine as Python exceptions, with their parts as attributes.

use lennard_core::parallel::PoolError;
use lennard_engine::{EngineError, PhysicsFailure};
use lennard_scene::SceneError;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The module that defines the exceptions.
const MODULE: &str = "lennard._errors";

/// An exception of the package, with the message first and attributes by name.
fn raise(name: &str, message: String, fill: impl Fn(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    Python::attach(|py| {
        let made = || -> PyResult<PyErr> {
            let attributes = PyDict::new(py);
            fill(&attributes)?;
            let class = py.import(MODULE)?.getattr(name)?;
            let value = class.call((message.clone(),), Some(&attributes))?;
            Ok(PyErr::from_value(value))
        };
        made().unwrap_or_else(|error| error)
    })
}

/// A scene that cannot be used, as `SceneError`.
pub fn of_scene(error: &SceneError) -> PyErr {
    raise("SceneError", error.to_string(), |to| {
        to.set_item("file", error.file())?;
        to.set_item("line", error.line())?;
        to.set_item("key", error.key_path())?;
        to.set_item("problem", error.message())?;
        to.set_item("found", error.value_found())?;
        to.set_item("allowed", error.what_is_allowed())?;
        to.set_item("nearest", error.nearest())
    })
}

fn of_physics(failure: &PhysicsFailure) -> PyErr {
    raise("PhysicsError", failure.to_string(), |to| {
        to.set_item("step", failure.step)?;
        to.set_item("time", failure.time)?;
        to.set_item("stage", &failure.stage)
    })
}

/// Any error of the engine. `from_file` tells whether lines of the scene mean anything to the user.
pub fn of_engine(error: EngineError, from_file: bool) -> PyErr {
    match error {
        EngineError::Scene(e) if from_file => of_scene(&e),
        EngineError::Scene(e) => of_scene(&e.without_line()),
        EngineError::Physics(e) => of_physics(&e),
        EngineError::Write(e) => {
            PyOSError::new_err(format!("writing results: {e}\n  {}", e.advice()))
        }
        EngineError::Configuration(_) | EngineError::Trajectory(_) => {
            with_message("ConfigurationError", &error)
        }
        EngineError::Folder(_) => with_message("FolderError", &error),
        EngineError::Resume(_) => with_message("CheckpointError", &error),
        EngineError::Memory(_) => PyMemoryError::new_err(error.to_string()),
        EngineError::Checkpoint(_)
        | EngineError::Start(_)
        | EngineError::Begun(_)
        | EngineError::NoSuchResult { .. }
        | EngineError::Threads(PoolError::Number(_)) => PyValueError::new_err(error.to_string()),
        EngineError::Ranks(_) | EngineError::Threads(_) => {
            PyRuntimeError::new_err(error.to_string())
        }
    }
}

fn with_message(name: &str, error: &EngineError) -> PyErr {
    raise(name, error.to_string(), |_| Ok(()))
}

/// A simulation that is in use.
pub fn busy(what: &str) -> PyErr {
    raise("BusyError", what.to_owned(), |_| Ok(()))
}
