//! The equations of state of the literature.

use lennard_literature::{EquationOfState, PROPERTIES, list};
use lennard_observables::quantities::{quantity_name, quantity_unit};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn find(key: &str) -> PyResult<&'static dyn EquationOfState> {
    let all = list();
    let found = all.iter().find(|equation| equation.spec().key == key);
    found.copied().ok_or_else(|| {
        let keys: Vec<String> = all.iter().map(|e| format!("{:?}", e.spec().key)).collect();
        PyValueError::new_err(format!(
            "there is no such equation of state\n  found:   {key:?}\n  allowed: {}",
            keys.join(", ")
        ))
    })
}

fn as_json(value: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| PyValueError::new_err(e.to_string()))
}

/// What each equation of state declares about itself, as JSON.
#[pyfunction]
pub fn equations_of_state() -> PyResult<String> {
    let all: Vec<_> = list().iter().map(|e| e.spec().clone()).collect();
    as_json(&all)
}

/// All properties at a density and a temperature by name.
#[pyfunction]
pub fn properties<'py>(
    py: Python<'py>,
    equation: &str,
    density: f64,
    temperature: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let equation = find(equation)?;
    let not_covered = |e: lennard_literature::OutsideRange| PyValueError::new_err(e.to_string());
    equation.check(density, temperature).map_err(not_covered)?;
    let state = equation.at(density, temperature);
    let out = PyDict::new(py);
    for property in PROPERTIES {
        out.set_item(property.key, (property.of)(&state))?;
    }
    Ok(out)
}

/// The properties that every equation of state gives: key, name, equation and unit.
#[pyfunction]
pub fn property_list() -> Vec<(&'static str, String, &'static str, &'static str)> {
    let all = PROPERTIES.iter();
    all.map(|p| (p.key, quantity_name(p.key), p.equation, quantity_unit(p.key))).collect()
}

/// Vapor and liquid at a temperature: pressure, vapor density, liquid density; `None` where they do not coexist.
#[pyfunction]
pub fn coexistence(equation: &str, temperature: f64) -> PyResult<Option<(f64, f64, f64)>> {
    let saturation = find(equation)?.saturation(temperature);
    Ok(saturation.map(|s| (s.pressure, s.vapor_density, s.liquid_density)))
}

/// The density of the stable fluid at a pressure and a temperature; `None` where the equation covers no such state.
#[pyfunction]
pub fn density_at(equation: &str, pressure: f64, temperature: f64) -> PyResult<Option<f64>> {
    Ok(find(equation)?.density(pressure, temperature))
}

/// The density at which the liquid freezes; `None` where that is not known.
#[pyfunction]
pub fn freezing_density(equation: &str, temperature: f64) -> PyResult<Option<f64>> {
    Ok(find(equation)?.freezing_density(temperature))
}

/// The phase of a state: a name, a phrase, and whether it is a stable fluid.
#[pyfunction]
pub fn phase_of(
    equation: &str,
    density: f64,
    temperature: f64,
) -> PyResult<(String, &'static str, bool)> {
    let phase = find(equation)?.phase(density, temperature);
    let name = as_json(&phase)?.trim_matches('"').to_owned();
    Ok((name, phase.describe(), phase.is_stable()))
}
