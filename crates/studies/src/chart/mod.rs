//! `lennard chart`: speed against accuracy, for one scene with many settings.
//!
//! All runs begin at one equilibrated start. What each finishes is stored in the output folder, so that the same command
//! goes on where it was stopped.

pub mod ensembles;
mod figures;
pub(crate) mod grid;
mod kinds;
mod measure;
mod page;
mod panels;
mod peers;
mod point;
mod standings;
mod store;
mod tables;
mod workshop;

pub use grid::{LeftOut, Size};
pub use page::own_settings;
pub use panels::{Axis, Mark, Panel, panels};
pub use point::{ChartedPoint, Errors, Outcome};
pub use standings::{Advice, Done, NOT_RESOLVED, Standing, basis, done, standings};
pub use store::{POINTS, has_points};

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use lennard_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::lab::Slopes;
use crate::{Progress, StudyError, files};

/// Name and version of the schema of [`Chart`].
const SCHEMA: &str = lennard_io::schema!("chart", 2);

/// Why a chart cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// The output folder holds something else.
    #[error("{}: {found}\n  allowed: an empty folder, or one that holds this chart; give another --out, or --force to begin anew", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What it holds.
        found: String,
    },
    /// The grid has no two settings that can run.
    #[error("there is nothing to compare: {found} of the settings around this scene can run{why}")]
    NothingToCompare {
        /// How many can.
        found: usize,
        /// Why the others cannot.
        why: String,
    },
    /// Anything that goes wrong in any study.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl From<lennard_io::WriteError> for ChartError {
    fn from(error: lennard_io::WriteError) -> Self {
        Self::Study(error.into())
    }
}

/// How to make a chart.
pub struct ChartOptions<'a> {
    /// The output folder, which exists.
    pub folder: &'a Path,
    /// How many settings.
    pub size: Size,
    /// Whether what the folder holds is thrown away.
    pub anew: bool,
    /// Points whose errors are measured at once, one thread each. Costs are timed one after the other.
    pub workers: usize,
    /// Threads of each timed run.
    pub threads: usize,
    /// Whether the points of other engines are added, where they are installed.
    pub with_peers: bool,
    /// Set from outside to stop; what is finished is kept.
    pub stop: &'a AtomicBool,
    /// The command, for the page.
    pub command: String,
}

/// What is run for how long: a function of scene and size, never of a clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// How many settings are tried, in words.
    pub size: Size,
    /// Settings, the tightest included.
    pub points: usize,
    /// Time for which each run is measured, τ.
    pub time: f64,
    /// The same for the tightest run, τ.
    pub tight_time: f64,
    /// Length of the trajectories that are compared, and of the way there and back, τ.
    pub short_time: f64,
    /// Timings of each.
    pub repeats: usize,
    /// Length of a timing by a model of the costs, s.
    pub timing_seconds: f64,
    /// Threads of a timed run.
    pub threads: usize,
    /// The processor that the timings belong to.
    pub cpu: String,
    /// The version of the program.
    pub version: String,
}

impl Plan {
    /// What made a chart, for its page.
    fn provenance(&self, command: &str) -> Vec<(String, String)> {
        vec![
            ("Command".into(), format!("`{command}`")),
            ("Version".into(), self.version.clone()),
            ("Processor".into(), self.cpu.clone()),
        ]
    }
}

/// A length of the runs of a chart, τ: no shorter than `shortest`, and no longer than `longest` or the run that the scene plans. That
/// would tell more than is asked.
fn bounded(scene: &Scene, time: f64, shortest: f64, longest: f64) -> f64 {
    let measured = scene.stages.iter().filter(|s| s.measure);
    let planned: f64 = measured.map(|s| s.steps as f64 * scene.stage_dt(s)).sum();
    time.clamp(shortest, longest.min(planned).max(shortest))
}

/// A chart: every point with its costs and errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chart {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Particles.
    pub atoms: usize,
    /// Number density, σ⁻³.
    pub density: f64,
    /// What was run for how long.
    pub plan: Plan,
    /// Whether every point is finished.
    pub finished: bool,
    /// How runs are carried to one temperature.
    pub slopes: Slopes,
    /// The step at which ω·dt is 1 for the fastest pair or spring, τ: light and small particles are fast.
    pub step_of_fastest: f64,
    /// Farthest pairs in the forces of the untruncated fluid, σ; absent where the potential ends by itself.
    pub reach: Option<f64>,
    /// What that sum leaves out, relative to the forces.
    pub left_out_of_forces: Option<f64>,
    /// The points; the scene's own settings stand first.
    pub points: Vec<ChartedPoint>,
    /// Index of the tightest.
    pub tightest: usize,
    /// Settings that were not tried, with the reason.
    pub left_out: Vec<LeftOut>,
    /// What else is to be known: engines that are not installed.
    pub remarks: Vec<String>,
    /// The diagrams.
    pub panels: Vec<Panel>,
}

/// Measures what is not measured yet, and writes the chart; where it was stopped, with what there is.
///
/// # Errors
/// [`ChartError`] where the scene cannot be run, the folder holds something else, or a file cannot be written.
pub fn run(
    scene: &Scene,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Chart, ChartError> {
    let chart = measure::all(scene, options, progress)?;
    write(&chart, options)?;
    Ok(chart)
}

/// Writes tables, figures, JSON and the page.
fn write(chart: &Chart, options: &ChartOptions<'_>) -> Result<(), ChartError> {
    let mut tables = vec![tables::points(chart)];
    tables.extend(chart.panels.iter().map(|p| tables::panel(chart, p)));
    let page = page::page(chart, &options.command);
    files::write_all(options.folder, &tables, ("study.json", chart), &page)?;
    for panel in &chart.panels {
        let path = options.folder.join(format!("{}.json", panel.name));
        lennard_io::write_json_atomically(&path, &tables::panel_json(chart, panel))?;
    }
    Ok(())
}
