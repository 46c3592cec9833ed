//! Running the points of a sweep side by side, and going on where an earlier sweep stopped.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use lennard_io::{CheckpointFolder, Existing, RunRecord};
use serde::Serialize;

use super::ran::{Found, Ran};
use super::side_by_side::run_all;
use super::{Agreement, Point, Sweep, SweepError, agreement, isotherms, page};
use crate::Progress;
use crate::compare::{ComparedRun, Row, RunFolder, StateOfMatter, compare};
use crate::kept::same_scene;

/// Name and version of the schema of [`SweepRecord`].
const SWEEP_SCHEMA: &str = "lennard-sweep/1";

/// The files that a sweep writes in its folder: record, table and page.
pub const FILES: [&str; 4] = ["sweep.json", "table.csv", "report.html", "pressure.svg"];

/// How to run a sweep.
pub struct SweepOptions<'a> {
    /// The output folder, held by this process; a folder for each point is made in it.
    pub folder: &'a Path,
    /// Threads for all points together: one for each point at work, and more for large points where there are
    /// fewer points than threads.
    pub threads: usize,
    /// Whether runs of these points with other scenes are replaced.
    pub replace: bool,
    /// Whether every point gets a `report.html` of its own.
    pub reports: bool,
    /// Set from outside to stop: the points at work write checkpoints, and those that start are given up.
    pub stop: Arc<AtomicBool>,
    /// The command, for the page.
    pub command: String,
}

/// How a sweep ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Every point is finished.
    Finished,
    /// It was asked to stop; the same command goes on.
    Stopped,
    /// It was asked to stop before any point had a step that could be kept; nothing was written.
    NotBegun,
    /// Some points failed.
    Failed,
}

/// A point and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweptPoint {
    /// Its name and the name of its folder.
    pub name: String,
    /// Where it was to lie: density and temperature asked for.
    pub planned: StateOfMatter,
    /// Whether it had been finished before, and was not run again.
    pub kept: bool,
    /// Why it has no result, where it has none.
    pub failure: Option<String>,
    /// The run beside the literature.
    pub compared: Option<ComparedRun>,
    /// Wall time of the run in s.
    pub wall_s: f64,
    /// Wall time for each particle and step in ns.
    pub ns_per_atom_step: f64,
}

impl SweptPoint {
    /// One quantity of the run beside the literature, where there is one.
    #[must_use]
    pub fn row(&self, quantity: &str) -> Option<&Row> {
        let rows = &self.compared.as_ref()?.rows;
        rows.iter().find(|r| r.quantity == quantity)
    }
}

/// A sweep and what came of it, as written to `sweep.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepRecord {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the sweep.
    pub name: String,
    /// How it ended.
    pub ending: Ending,
    /// Version of the program.
    pub version: &'static str,
    /// The processor.
    pub cpu: String,
    /// Threads for all points together.
    pub threads: usize,
    /// Point by point.
    pub points: Vec<SweptPoint>,
    /// All points together, quantity by quantity.
    pub agreement: Vec<Agreement>,
}

/// Runs what is not finished yet, and writes table, page and record.
///
/// # Errors
/// [`SweepError`] where a folder holds something else or a file cannot be written. A point that fails is no error:
/// the record says so.
pub fn run(
    sweep: &Sweep,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<SweepRecord, SweepError> {
    let found: Vec<Found> = sweep
        .points
        .iter()
        .map(|point| look(&options.folder.join(&point.name), point, options.replace))
        .collect::<Result<_, _>>()?;
    let outcomes = run_all(&sweep.points, found, options, progress);
    let points: Vec<SweptPoint> = sweep
        .points
        .iter()
        .zip(outcomes)
        .map(|(point, outcome)| conclude(point, outcome, &options.folder.join(&point.name)))
        .collect();
    let stopped =
        options.stop.load(Ordering::Relaxed) && points.iter().any(|p| p.compared.is_none());
    let ending = if stopped {
        if points.iter().any(|p| is_kept(p, options.folder)) {
            Ending::Stopped
        } else {
            Ending::NotBegun
        }
    } else if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else {
        Ending::Finished
    };
    let record = SweepRecord {
        schema: SWEEP_SCHEMA,
        name: sweep.name.clone(),
        ending,
        version: env!("CARGO_PKG_VERSION"),
        cpu: lennard_io::cpu_name(),
        threads: options.threads,
        agreement: [
            "potential_energy",
            "pressure",
            "heat_capacity",
            "configurational_temperature",
        ]
        .iter()
        .filter_map(|q| agreement(&points, q))
        .collect(),
        points,
    };
    let [json, table, report, figure] = FILES.map(|name| options.folder.join(name));
    if ending == Ending::NotBegun {
        return Ok(record);
    }
    lennard_io::write_json_atomically(&json, &record)?;
    lennard_io::write_table_csv(&table, &page::csv(&record))?;
    let isotherms = isotherms::picture(sweep, &record);
    if let Some(picture) = &isotherms {
        lennard_io::write_text_atomically(&figure, &picture.to_svg()?)?;
    }
    let html = page::page(&record, &options.command, isotherms).to_html()?;
    lennard_io::write_text_atomically(&report, &html)?;
    Ok(record)
}

/// Finds out what an earlier sweep has left, before anything is written.
fn look(folder: &Path, point: &Point, replace: bool) -> Result<Found, SweepError> {
    if !folder.join("run.json").exists() {
        return Ok(Found::Nothing);
    }
    let other = |found: String| SweepError::Folder {
        folder: folder.to_owned(),
        found,
    };
    let same = same_scene(folder, &point.scene) == Some(true);
    let found = match (lennard_io::read_run_record(&folder.join("run.json")), same) {
        (Ok(RunRecord { finished: true, .. }), true) => return Ok(Found::Finished),
        (Ok(_), true) => Found::Begun,
        _ if replace => Found::Nothing,
        (Ok(_), false) => return Err(other("it holds the run of another scene".into())),
        (Err(e), _) => return Err(other(format!("its run.json cannot be read: {e}"))),
    };
    // A run that a process goes on with by itself shows before any point is begun.
    drop(lennard_io::create_named_folder(folder, Existing::Keep)?);
    Ok(found)
}

/// Whether a point has a result, or a checkpoint from which it goes on.
fn is_kept(point: &SweptPoint, folder: &Path) -> bool {
    let checkpoints = CheckpointFolder::new(&folder.join(&point.name));
    point.compared.is_some() || checkpoints.list().is_ok_and(|all| !all.is_empty())
}

fn conclude(point: &Point, outcome: Result<Ran, String>, folder: &Path) -> SweptPoint {
    let model = lennard_scene::model_kind(&point.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    let mut swept = SweptPoint {
        name: point.name.clone(),
        planned: StateOfMatter::new(point.density, point.scene.system.temperature, equation),
        kept: matches!(outcome, Ok(Ran::Kept)),
        failure: None,
        compared: None,
        wall_s: f64::NAN,
        ns_per_atom_step: f64::NAN,
    };
    match outcome {
        Err(failure) => swept.failure = Some(failure),
        Ok(Ran::Stopped) => {}
        Ok(Ran::Kept | Ran::Finished) => match RunFolder::open(folder) {
            Err(e) => swept.failure = Some(e.to_string()),
            Ok(run) => {
                swept.wall_s = run.record.wall_s;
                swept.ns_per_atom_step = run.record.performance.ns_per_atom_step;
                swept.compared = Some(compare(&run));
            }
        },
    }
    swept
}
