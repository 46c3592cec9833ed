//! The compiled part of the Python package `lennard`. What a user sees is Python, in `python/lennard`.
//!
//! A scene comes as TOML text or as a file, and errors are the errors of the scene. Python and the command line therefore
//! cannot differ in what a scene means.

mod equations;
mod errors;
mod evaluator;
mod inner;
mod numbers;
mod run;
mod scenes;
mod simulation;
mod view;

use pyo3::prelude::*;

/// The compiled part of `lennard`.
#[pymodule(gil_used = false)]
mod _lennard {
    #[pymodule_export]
    use crate::equations::{
        coexistence, density_at, equations_of_state, freezing_density, phase_of, properties,
        property_list,
    };
    #[pymodule_export]
    use crate::evaluator::{Evaluator, box_sides};
    #[pymodule_export]
    use crate::scenes::{key_reference, resolve, resolve_file};
    #[pymodule_export]
    use crate::simulation::Core;
    #[pymodule_export]
    use crate::view::View;
    #[pymodule_export]
    use crate::{command, instead_of, version};
}

/// Runs the command line with these arguments, the name of the program first, and returns the exit code.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| lennard::program::main(arguments))
}

/// The new way of a mean or a column that was removed; `None` for any other name.
#[pyfunction]
fn instead_of(column: &str) -> Option<&'static str> {
    lennard_scene::removed(lennard_scene::RemovedKind::Column, column)
}

/// The version of the program.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
