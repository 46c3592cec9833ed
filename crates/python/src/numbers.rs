//! Vectors and tables of the engine as numpy arrays, and back.

use lennard_core::{DVec3, State};
use lennard_engine::Simulation;
use lennard_observables::{Table, Value};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A copy as an array `[N, 3]`.
pub fn array<'py>(py: Python<'py>, vectors: &[DVec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut flat = vec![0.0; 3 * vectors.len()];
    for (to, v) in flat.as_chunks_mut().0.iter_mut().zip(vectors) {
        *to = v.to_array();
    }
    PyArray1::from_vec(py, flat).reshape([vectors.len(), 3])
}

/// Element and mass of each species, and the species of each particle, `[N]`.
pub type Species<'py> = (Vec<(String, f64)>, Bound<'py, PyArray1<u8>>);

/// The species of a simulation. The particles of a plain fluid have the element of its output.
pub fn species<'py>(py: Python<'py>, simulation: &Simulation) -> Species<'py> {
    let table = simulation.system.species();
    let each = table.all().iter().map(|one| match simulation.mixture {
        Some(_) => (one.element.clone(), one.mass),
        None => (simulation.scene.output.element.clone(), one.mass),
    });
    let of_particles = (0..table.n_particles()).map(|i| table.of(i) as u8);
    let of_particles = PyArray1::from_vec(py, of_particles.collect());
    (each.collect(), of_particles)
}

/// Vectors from an array `[N, 3]`.
pub fn vectors(array: &PyReadonlyArray2<'_, f64>, name: &str) -> PyResult<Vec<DVec3>> {
    let view = array.as_array();
    if view.ncols() != 3 {
        return Err(PyValueError::new_err(format!(
            "{name} has the shape ({}, {})\n  allowed: (N, 3)",
            view.nrows(),
            view.ncols()
        )));
    }
    // Rows one by one take longer than the forces on them.
    if let Some(flat) = view.as_slice() {
        return Ok(flat.as_chunks().0.iter().map(|v| DVec3::from_array(*v)).collect());
    }
    Ok(view.rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect())
}

/// A table as `{name, caption, columns: [{name, unit, values, errors}]}`: numbers in arrays, words in lists.
pub fn table<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyList::empty(py);
    for column in &table.columns {
        let out = PyDict::new(py);
        out.set_item("name", &column.name)?;
        out.set_item("unit", &column.unit)?;
        let is_words = |value: &Value| matches!(value, Value::Words(_) | Value::Figures(_));
        if column.cells.iter().any(|c| is_words(&c.value)) {
            let words: Vec<String> = column.cells.iter().map(|c| words(&c.value)).collect();
            out.set_item("values", words)?;
        } else {
            out.set_item("values", PyArray1::from_vec(py, column.numbers()))?;
        }
        let error = |value: &Value| match value {
            Value::Measured { error, .. } => *error,
            _ => f64::NAN,
        };
        let errors = column
            .has_errors
            .then(|| column.cells.iter().map(|c| error(&c.value)).collect())
            .map(|errors: Vec<f64>| PyArray1::from_vec(py, errors));
        out.set_item("errors", errors)?;
        columns.append(out)?;
    }
    let out = PyDict::new(py);
    out.set_item("name", &table.name)?;
    out.set_item("caption", &table.caption)?;
    out.set_item("columns", columns)?;
    Ok(out)
}

fn words(value: &Value) -> String {
    match value {
        Value::Words(text) | Value::Figures(text) => text.clone(),
        Value::Missing => String::new(),
        other => other.number().to_string(),
    }
}

/// Frames as arrays by name: `positions` is `[F, N, 3]`; what the output does not have is `None`.
pub fn frames<'py>(py: Python<'py>, frames: &[State], n: usize) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let steps: Vec<u64> = frames.iter().map(|f| f.step).collect();
    let times: Vec<f64> = frames.iter().map(|f| f.time).collect();
    let lengths: Vec<DVec3> = frames.iter().map(|f| f.cell.lengths()).collect();
    out.set_item("step", PyArray1::from_vec(py, steps))?;
    out.set_item("time", PyArray1::from_vec(py, times))?;
    out.set_item("box", array(py, &lengths)?)?;
    let stacked = |of: fn(&State) -> &Vec<DVec3>| {
        if frames.iter().any(|f| of(f).len() != n) {
            return Ok(None);
        }
        let vectors = frames.iter().flat_map(of);
        let all: Vec<f64> = vectors.flat_map(|v| v.to_array()).collect();
        let stack = PyArray1::from_vec(py, all).reshape([frames.len(), n, 3]);
        stack.map(Some)
    };
    out.set_item("positions", stacked(|f| &f.positions)?)?;
    out.set_item("velocities", stacked(|f| &f.velocities)?)?;
    out.set_item("forces", stacked(|f| &f.forces)?)?;
    Ok(out)
}
