//! The state without copies, while no run can touch it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lennard_core::{DVec3, State};
use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Vectors of the state while they are lent out. Nothing changes them as long as an array holds them.
type Lent = Arc<Vec<DVec3>>;

/// What keeps the vectors of an array alive.
#[pyclass(frozen)]
struct Keeper {
    vectors: Lent,
}

/// A read-only array `[N, 3]` on the vectors.
#[allow(unsafe_code)] // numpy cannot know how long the memory stays
fn array<'py>(py: Python<'py>, vectors: &Lent) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let keeper = Bound::new(py, Keeper { vectors: Lent::clone(vectors) })?;
    let first = keeper.get().vectors.as_ptr().cast::<f64>();
    // SAFETY: `DVec3` is three `f64` in a row (`repr(C)`), so that n of them are 3n numbers. The array holds the keeper, and
    // the keeper holds the vectors. `give_back` takes vectors away only where no keeper holds them.
    let array = unsafe {
        let view = ArrayView2::from_shape_ptr((vectors.len(), 3), first);
        PyArray2::borrow_from_array(&view, keeper.into_any())
    };
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// The vectors themselves where no array shows them any more, else a copy.
fn give_back(vectors: Lent) -> Vec<DVec3> {
    Arc::unwrap_or_clone(vectors)
}

/// Positions, velocities and forces without copies, read-only, until the view is closed.
#[pyclass(frozen)]
pub struct View {
    lent: Mutex<Option<[Lent; 3]>>,
}

impl View {
    /// Takes the vectors of a state.
    pub fn open(py: Python<'_>, state: &mut State) -> PyResult<Py<Self>> {
        let State { positions, velocities, forces, .. } = state;
        let lent = [positions, velocities, forces].map(|v| Arc::new(std::mem::take(v)));
        let lent = Mutex::new(Some(lent));
        Py::new(py, Self { lent })
    }

    /// Gives the vectors back to the state.
    pub fn close(&self, state: &mut State) {
        let lent = self.lent().take();
        if let Some(lent) = lent {
            [state.positions, state.velocities, state.forces] = lent.map(give_back);
        }
    }

    fn lent(&self) -> MutexGuard<'_, Option<[Lent; 3]>> {
        self.lent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn array<'py>(&self, py: Python<'py>, which: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &*self.lent() {
            Some(lent) => array(py, &lent[which]),
            None => Err(PyValueError::new_err(
                "the view is closed: take arrays inside of `with simulation.view() as view:`",
            )),
        }
    }
}

#[pymethods]
impl View {
    /// Unwrapped positions, `[N, 3]`, σ.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, 0)
    }

    /// Velocities, `[N, 3]`, σ/τ.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, 1)
    }

    /// Forces, `[N, 3]`, ε/σ.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, 2)
    }
}
