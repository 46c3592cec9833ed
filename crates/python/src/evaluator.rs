//! Forces on positions that a caller moves.

use std::sync::{Mutex, PoisonError};

use lennard_core::{Configuration, DVec3, Energetics, ForceTerm, Part, PeriodicBox, Want};
use lennard_engine::Threads;
use lennard_forcefield::{ForceFieldOptions, PairForces};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::{errors, numbers, scenes};

struct Inner {
    options: ForceFieldOptions,
    forces: PairForces,
    threads: Threads,
    n: usize,
}

/// Forces, energy and virial by the potential of a scene; the neighbor list is kept between calls.
#[pyclass(frozen)]
pub struct Evaluator {
    inner: Mutex<Inner>,
}

/// Energy (no number unless asked for), forces `[N, 3]`, and where asked for virial Σ r ⊗ F `[3, 3]` and energies of particles.
type Evaluation<'py> = (
    f64,
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<f64>>>,
    Option<Bound<'py, PyArray1<f64>>>,
);

fn cell(lengths: [f64; 3]) -> PyResult<PeriodicBox> {
    PeriodicBox::new(DVec3::from_array(lengths)).map_err(|e| PyValueError::new_err(e.to_string()))
}

/// The sides of the box whose edges are the rows of a cell, in any unit of length; `None` where the cell is no box.
#[pyfunction]
pub fn box_sides(cell: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    let cell = lennard_io::box_of_edges(cell.map(DVec3::from_array));
    cell.ok().map(|cell| cell.lengths().to_array())
}

#[pymethods]
impl Evaluator {
    /// Forces for `n` particles in a box with these sides; the scene's own start is not looked at.
    #[new]
    fn new(
        py: Python<'_>,
        scene: &str,
        n: usize,
        lengths: [f64; 3],
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let overrides = Vec::new();
        let scene = scenes::from_text(scene, "calculator", &overrides)?;
        if scene.mixture.is_some() {
            return Err(PyValueError::new_err(
                "forces without a scene take one species of particles; run a mixture as a Simulation",
            ));
        }
        let species = scene.species_table(n, &[]);
        let threads = threads.unwrap_or_else(|| lennard_engine::recommended_threads(n));
        let cell = cell(lengths)?;
        let built = py.detach(|| {
            let threads = Threads::new(threads)?;
            let build = || lennard_engine::forces(&scene, cell, &species);
            let (options, forces) = threads.pool()?.install(build)?;
            Ok((options, forces, threads))
        });
        let (options, forces, threads) = built.map_err(|e| errors::of_engine(e, false))?;
        let inner = Mutex::new(Inner { options, forces, threads, n });
        Ok(Self { inner })
    }

    /// Evaluates at positions in a box, with the tail where the scene has one.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        positions: PyReadonlyArray2<'py, f64>,
        lengths: [f64; 3],
        energy: bool,
        virial: bool,
        each: bool,
    ) -> PyResult<Evaluation<'py>> {
        let positions = numbers::vectors(&positions, "positions")?;
        let cell = cell(lengths)?;
        let wrong = PyValueError::new_err::<String>;
        let evaluated = py.detach(|| {
            let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            let Inner { options, forces, threads, n } = &mut *inner;
            if positions.len() != *n {
                return Err(wrong(format!("{} positions, made for {n}", positions.len())));
            }
            let mut out = vec![DVec3::ZERO; *n];
            let want =
                Want { energy, virial, virial_tensor: virial, per_particle: each, ..Want::NOTHING };
            let at = Configuration::at_rest(&cell, &positions);
            let evaluate = || forces.evaluate(at, Part::All, want, &mut out);
            let pool = threads.pool().map_err(|e| errors::of_engine(e.into(), false))?;
            let found = pool.install(evaluate);
            let energetics = found.map_err(|e| wrong(e.to_string()))?;
            let tail = lennard_forcefield::tail_correction(options, *n, cell.volume());
            Ok((out, energetics, tail))
        });
        let (forces, energetics, tail) = evaluated?;
        let Energetics { potential_energy, virial, per_particle, .. } = energetics;
        let (tail_energy, tail_virial) = tail.map_or((0.0, 0.0), |t| (t.energy, t.virial));
        let virial = virial.map(|mut virial| {
            for axis in 0..3 {
                virial.col_mut(axis)[axis] += tail_virial / 3.0;
            }
            numbers::array(py, &[virial.row(0), virial.row(1), virial.row(2)])
        });
        let n = forces.len() as f64;
        let energies = per_particle.map(|all| {
            let each = all.iter().map(|p| p.0 + tail_energy / n).collect();
            PyArray1::from_vec(py, each)
        });
        Ok((
            potential_energy.unwrap_or(f64::NAN) + tail_energy,
            numbers::array(py, &forces)?,
            virial.transpose()?,
            energies,
        ))
    }

    /// List builds so far.
    #[getter]
    fn builds(&self) -> u64 {
        let inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        inner.forces.statistics().builds
    }
}
