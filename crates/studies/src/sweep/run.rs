//! Running the points of a sweep side by side, and going on where an earlier sweep stopped.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use lennard_io::{CheckpointFolder, Existing, RunRecord};
use serde::Serialize;

use super::ran::{Failed, Found, Ran};
use super::side_by_side::run_all;
use super::{
    Agreement, CriticalEstimate, MeltingEstimate, Point, Setting, Sweep, SweepError, agreement,
    coexistence, equations, figures, melting, page,
};
use crate::Progress;
use crate::compare::{ComparedRun, Row, RunFolder, StateOfMatter, compare};
use crate::kept::same_scene;

/// Name and version of the schema of [`SweepRecord`].
const SWEEP_SCHEMA: &str = lennard_io::schema!("sweep", 1);

/// The files that a sweep writes in its folder: record, table, page, and figures.
pub const FILES: [&str; 11] = [
    "sweep.json",
    "table.csv",
    "report.html",
    "equations.csv",
    "beside_equations.csv",
    "pressure.svg",
    "coexistence.svg",
    "vapor_pressure.svg",
    "surface_tension.svg",
    "arrhenius.svg",
    "melting.svg",
];

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
    /// When to stop by itself, likewise.
    pub deadline: Option<Instant>,
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
    /// What was there was collected, and some points are not finished.
    Incomplete,
    /// It was asked to stop before any point had a step that could be kept; nothing was written.
    NotBegun,
    /// Other processes are at work on some points.
    Elsewhere,
    /// Some points failed.
    Failed,
}

/// A point and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweptPoint {
    /// Its name and the name of its folder.
    pub name: String,
    /// What the sweep chose for it, without the seed.
    pub settings: Vec<Setting>,
    /// Its page, relative to the folder of the sweep; `None` where it has none.
    pub page: Option<String>,
    /// Where it was to lie: density and temperature asked for.
    pub planned: StateOfMatter,
    /// Whether it had been finished before, and was not run again.
    pub kept: bool,
    /// Why it has no result, where it has none.
    pub failure: Option<Failed>,
    /// The process that is at work on it, where that is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elsewhere: Option<String>,
    /// The run beside the literature.
    pub compared: Option<ComparedRun>,
    /// Wall time of the run in s.
    pub wall_s: f64,
    /// Wall time for each particle and step in ns.
    pub ns_per_atom_step: f64,
}

impl SweptPoint {
    /// Whether it has neither a result nor a failure.
    #[must_use]
    pub fn is_unfinished(&self) -> bool {
        self.compared.is_none() && self.failure.is_none() && self.elsewhere.is_none()
    }

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
    /// The critical point from slabs at three temperatures or more; `None` without them.
    pub critical_point: Option<CriticalEstimate>,
    /// Melting temperatures from crystals beside their liquids, one for all points that differ in temperature alone; absent without them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub melting: Vec<MeltingEstimate>,
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
    let points = run_points(sweep, options, progress)?;
    let ending = ending_of(&points, options.folder);
    let record = record(sweep, points, ending, options.threads);
    if ending != Ending::NotBegun {
        write(sweep, &record, options.folder, &options.command)?;
    }
    Ok(record)
}

/// Runs what is not finished yet, and writes nothing but the folders of the points: one of many processes that share a sweep.
///
/// # Errors
/// [`SweepError`] where a folder holds something else. A point that fails is no error.
pub fn run_points(
    sweep: &Sweep,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Vec<SweptPoint>, SweepError> {
    let found: Vec<Found> = sweep
        .points
        .iter()
        .map(|point| look(&options.folder.join(&point.name), point, options.replace))
        .collect::<Result<_, _>>()?;
    let outcomes = run_all(&sweep.points, found, options, progress);
    let points = sweep.points.iter().zip(outcomes);
    Ok(points
        .map(|(point, outcome)| conclude(point, outcome, &options.folder.join(&point.name)))
        .collect())
}

/// How points ended that were run in a folder.
#[must_use]
pub fn ending_of(points: &[SweptPoint], folder: &Path) -> Ending {
    if points.iter().any(SweptPoint::is_unfinished) {
        if points.iter().any(|p| is_kept(p, folder)) { Ending::Stopped } else { Ending::NotBegun }
    } else if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else if points.iter().any(|p| p.elsewhere.is_some()) {
        Ending::Elsewhere
    } else {
        Ending::Finished
    }
}

/// The record of a sweep.
pub(super) fn record(
    sweep: &Sweep,
    points: Vec<SweptPoint>,
    ending: Ending,
    threads: usize,
) -> SweepRecord {
    SweepRecord {
        schema: SWEEP_SCHEMA,
        name: sweep.name.to_string(),
        ending,
        version: env!("CARGO_PKG_VERSION"),
        cpu: lennard_io::cpu_name(),
        threads,
        agreement: ["potential_energy", "pressure", "heat_capacity", "configurational_temperature"]
            .iter()
            .filter_map(|q| agreement(&points, q))
            .collect(),
        critical_point: coexistence::critical_point(&points),
        melting: melting::estimates(sweep, &points),
        points,
    }
}

/// Writes record, table, figures and page.
pub(super) fn write(
    sweep: &Sweep,
    record: &SweepRecord,
    folder: &Path,
    command: &str,
) -> Result<(), SweepError> {
    let [json, table, report, judged, beside, ..] = FILES.map(|name| folder.join(name));
    lennard_io::write_json_atomically(&json, record)?;
    lennard_io::write_table_csv(&table, &page::csv(record))?;
    let judgements = equations::judgements(record);
    if !judgements.is_empty() {
        lennard_io::write_table_csv(&judged, &equations::table(&judgements, str::to_owned))?;
        lennard_io::write_table_csv(&beside, &equations::beside_equations(record))?;
    }
    let pictures = figures::all(sweep, record);
    for (file, picture) in pictures.files() {
        lennard_io::write_text_atomically(&folder.join(file), &picture.to_svg()?)?;
    }
    let html = page::page(record, command, pictures, &judgements).to_html()?;
    lennard_io::write_text_atomically(&report, &html)?;
    Ok(())
}

/// Finds out what an earlier sweep has left, before anything is written.
fn look(folder: &Path, point: &Point, replace: bool) -> Result<Found, SweepError> {
    let found = match found_in(folder, point) {
        Ok(found @ (Found::Finished | Found::Nothing)) => return Ok(found),
        Ok(Found::Begun) => Found::Begun,
        Err(_) if replace => Found::Nothing,
        Err(found) => {
            let folder = folder.to_owned();
            return Err(SweepError::Folder { folder, found });
        }
    };
    // A run that a process goes on with by itself shows before any point is begun.
    drop(lennard_io::create_named_folder(folder, Existing::Keep)?);
    Ok(found)
}

/// What the folder of a point holds; an error says what else it holds.
pub(super) fn found_in(folder: &Path, point: &Point) -> Result<Found, String> {
    let record = folder.join("run.json");
    if !record.exists() {
        return Ok(Found::Nothing);
    }
    match lennard_io::read_run_record(&record) {
        Err(e) => Err(format!("its run.json cannot be read: {e}")),
        Ok(_) if same_scene(folder, &point.scene) != Some(true) => {
            Err("it holds the run of another scene".into())
        }
        Ok(RunRecord { finished: true, .. }) => Ok(Found::Finished),
        Ok(_) => Ok(Found::Begun),
    }
}

/// Whether a point has a result, or a checkpoint from which it goes on.
fn is_kept(point: &SweptPoint, folder: &Path) -> bool {
    let checkpoints = CheckpointFolder::new(&folder.join(&point.name));
    point.compared.is_some() || checkpoints.list().is_ok_and(|all| !all.is_empty())
}

pub(super) fn conclude(point: &Point, outcome: Result<Ran, Failed>, folder: &Path) -> SweptPoint {
    let model = lennard_scene::model_kind(&point.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    let mut swept = SweptPoint {
        name: point.name.to_string(),
        settings: point.settings.clone(),
        page: folder.join("report.html").exists().then(|| format!("{}/report.html", point.name)),
        planned: StateOfMatter::new(point.density, point.scene.system.temperature, equation),
        kept: matches!(outcome, Ok(Ran::Kept)),
        failure: None,
        elsewhere: None,
        compared: None,
        wall_s: f64::NAN,
        ns_per_atom_step: f64::NAN,
    };
    match outcome {
        Err(failure) => swept.failure = Some(failure),
        Ok(Ran::Stopped) => {}
        Ok(Ran::Elsewhere(process)) => swept.elsewhere = Some(process),
        Ok(Ran::Kept | Ran::Finished) => match RunFolder::open(folder) {
            Err(e) => swept.failure = Some(Failed::otherwise(&e)),
            Ok(run) => {
                swept.wall_s = run.record.wall_s;
                swept.ns_per_atom_step = run.record.performance.ns_per_atom_step;
                swept.compared = Some(compare(&run));
            }
        },
    }
    swept
}
