//! The cheapest settings that meet an accuracy.
//!
//! A survey of the fluid, a few seconds long, gives models of every error. They say what a truncation leaves out
//! (`survey`), what a time step and a precision change, and how the energy drifts (`predict`). `choose` finds
//! the cheapest settings whose predicted errors keep the targets, and `verify` runs them beside the safest settings.
//! Where measurement and prediction together miss a target, the models learn from it and the search goes on (`search`).

mod advice;
mod choose;
mod finish;
mod pairs;
mod predict;
mod prices;
mod sample;
mod search;
mod speed;
mod survey;
mod verify;

pub use predict::Prediction;
pub use search::tune;
pub use speed::Speed;
pub use verify::Runs;

use lennard_forcefield::NeighborOptions;
use lennard_observables::Estimate;
use lennard_scene::{Chosen, Judged};
use serde::Serialize;

use crate::StudyError;
use crate::lab::{Cost, Workbench};
use crate::settings::Settings;

/// Name and version of the schema of [`Tuning`].
const SCHEMA: &str = lennard_io::schema!("tune", 1);

/// How to tune.
#[derive(Debug, Clone, Copy)]
pub struct TuneOptions {
    /// About how long it may take, s.
    pub seconds: f64,
    /// Threads: survey and verification run a chain on each.
    pub threads: usize,
}

/// A quantity of the accuracy: what was wanted, predicted and measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The numbers, as the lock file keeps them.
    #[serde(flatten)]
    pub judged: Judged,
    /// The prediction by causes; absent for the drift.
    pub causes: Option<Prediction>,
    /// Standard error that the planned run of the scene will have; absent for the drift.
    pub planned_error: Option<f64>,
}

/// What was chosen, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tuning {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Number density, σ⁻³.
    pub density: f64,
    /// Temperature of the measurement, ε/k_B.
    pub temperature: f64,
    /// Particles in the fluid that was judged.
    pub atoms_judged: usize,
    /// Whose U and P the accuracy is about, in words.
    pub about: String,
    /// The settings.
    pub settings: Settings,
    /// In a line.
    pub label: String,
    /// The safest settings, against which was measured, in a line.
    pub safest: String,
    /// Threads that pay.
    pub threads: usize,
    /// Quantity by quantity.
    pub rows: Vec<Row>,
    /// Cost of the chosen settings on these threads.
    pub cost: Cost,
    /// Cost of the safest.
    pub safest_cost: Cost,
    /// Cost of the usual r_cut = 2.5 σ and dt = 0.004 τ in double precision, where they fit.
    pub usual_cost: Option<Cost>,
    /// Whether the chosen settings are faster than the usual ones, as far as these timings tell.
    pub speed: Speed,
    /// Errors of U and P predicted for the usual settings.
    pub usual_errors: Option<[Estimate; 2]>,
    /// What the chosen settings measured in the verification.
    pub runs: Runs,
    /// Remarks.
    pub notes: Vec<String>,
    /// Wall time of the whole, s.
    pub seconds: f64,
}

impl Tuning {
    /// What a lock file keeps.
    #[must_use]
    pub fn chosen(&self) -> Chosen {
        Chosen {
            truncation: self.settings.truncation,
            dt: self.settings.dt,
            precision: self.settings.precision,
            neighbor: NeighborOptions { mode: self.settings.list, skin: self.settings.skin },
            threads: self.threads,
        }
    }

    /// The rows as a lock file keeps them.
    #[must_use]
    pub fn judged(&self) -> Vec<Judged> {
        self.rows.iter().map(|row| row.judged.clone()).collect()
    }
}

/// The time in τ that settings can be run for in some seconds, from a short timing.
fn affordable(bench: &Workbench, settings: &Settings, seconds: f64) -> Result<f64, StudyError> {
    /// Fewest τ from which anything can be said.
    const SHORTEST: f64 = 5.0;
    const TIMED: f64 = 0.02;
    let timing = bench.timing(settings, TIMED)?;
    Ok((seconds / (timing.seconds_per_atom_tau * bench.start().len() as f64)).max(SHORTEST))
}

/// Why a scene without `accuracy` is not tuned.
#[must_use]
pub fn no_accuracy(file: &str) -> StudyError {
    let reason = "there is no `accuracy` to tune for\n  found:   a scene with settings of its own\n  \
                  allowed: a scene with `accuracy = { potential_energy = 1e-3, pressure = 5e-3, drift = 1e-5 }`, or some of these";
    StudyError::Settings { label: file.to_owned(), reason: reason.to_owned() }
}
