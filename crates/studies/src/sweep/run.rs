//! Running the points of a sweep side by side, and going on where an earlier sweep stopped.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use lennard_engine::{EngineError, ResumeOptions, RunOptions};
use lennard_io::{Existing, OutputFolder, RunRecord};
use serde::Serialize;

use super::threads::{threads_of, workers};
use super::{Agreement, Point, Sweep, SweepError, agreement, page};
use crate::compare::{ComparedRun, Row, RunFolder, StateOfMatter, compare};
use crate::jobs::pool;
use crate::kept::same_scene;
use crate::{Progress, run_page};

/// Name and version of the schema of [`SweepRecord`].
const SWEEP_SCHEMA: &str = "lennard-sweep/1";

/// What a sweep writes itself in its folder: record, table and page.
pub const FILES: [&str; 3] = ["sweep.json", "table.csv", "report.html"];

/// Time between two looks at how far the points are.
const LOOK_EVERY: Duration = Duration::from_millis(200);

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
    /// Set from outside to stop: the points at work write checkpoints.
    pub stop: &'a AtomicBool,
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

/// What is in the folder of a point.
enum Found {
    /// A finished run of the same scene.
    Finished,
    /// A run of the same scene that can go on.
    Begun,
    /// Nothing of use.
    Nothing,
}

/// How the run of one point ended.
enum Ran {
    Kept,
    Finished,
    Stopped,
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
    let outcomes = run_all(sweep, &found, options, progress);
    let points: Vec<SweptPoint> = sweep
        .points
        .iter()
        .zip(outcomes)
        .map(|(point, outcome)| conclude(point, outcome, &options.folder.join(&point.name)))
        .collect();
    let stopped =
        options.stop.load(Ordering::Relaxed) && points.iter().any(|p| p.compared.is_none());
    let ending = if stopped {
        Ending::Stopped
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
    let [json, table, report] = FILES.map(|name| options.folder.join(name));
    lennard_io::write_json_atomically(&json, &record)?;
    lennard_io::write_text_atomically(&table, &page::csv(&record))?;
    let html = page::page(&record, &options.command)?.to_html();
    lennard_io::write_text_atomically(&report, &html)?;
    Ok(record)
}

/// Looks what an earlier sweep has left, before anything is written.
fn look(folder: &Path, point: &Point, replace: bool) -> Result<Found, SweepError> {
    if !folder.join("run.json").exists() {
        return Ok(Found::Nothing);
    }
    let other = |found: String| SweepError::Folder {
        folder: folder.to_owned(),
        found,
    };
    let same = same_scene(folder, &point.scene) == Some(true);
    match (lennard_io::read_run_record(&folder.join("run.json")), same) {
        (Ok(RunRecord { finished: true, .. }), true) => Ok(Found::Finished),
        (Ok(_), true) => Ok(Found::Begun),
        _ if replace => Ok(Found::Nothing),
        (Ok(_), false) => Err(other("it holds the run of another scene".into())),
        (Err(e), _) => Err(other(format!("its run.json cannot be read: {e}"))),
    }
}

/// Runs all points, and tells how far they are.
fn run_all(
    sweep: &Sweep,
    found: &[Found],
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Vec<Result<Ran, String>> {
    let points = &sweep.points;
    let work = |point: &Point| point.scene.total_steps() * point.atoms as u64;
    let total: u64 = points
        .iter()
        .zip(found)
        .filter(|(_, f)| !matches!(f, Found::Finished))
        .map(|(p, _)| work(p))
        .sum();
    let done: Vec<AtomicU64> = points.iter().map(|_| AtomicU64::new(0)).collect();
    let next = AtomicUsize::new(0);
    let to_run = found
        .iter()
        .filter(|f| !matches!(f, Found::Finished))
        .count();
    let workers = workers(to_run, options.threads);
    let left = AtomicUsize::new(workers);
    let results: Vec<Mutex<Option<Result<Ran, String>>>> =
        points.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for worker in 0..workers {
            let (next, left, results, done) = (&next, &left, &results, &done);
            scope.spawn(move || {
                while let Some(i) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).filter(|i| *i < points.len())
                {
                    let threads = threads_of(worker, workers, options.threads, points[i].atoms);
                    let result = run_point(&points[i], &found[i], options, threads, &done[i]);
                    if let Ok(mut slot) = results[i].lock() {
                        *slot = Some(result);
                    }
                }
                left.fetch_sub(1, Ordering::Relaxed);
            });
        }
        while left.load(Ordering::Relaxed) > 0 {
            std::thread::sleep(LOOK_EVERY);
            let so_far: u64 = done.iter().map(|d| d.load(Ordering::Relaxed)).sum();
            let finished = results
                .iter()
                .filter(|r| r.lock().is_ok_and(|slot| slot.is_some()))
                .count();
            let share = so_far as f64 / total.max(1) as f64;
            progress.update(
                &format!("{finished} of {} points", points.len()),
                share.min(1.0),
            );
        }
    });
    let not_run = || Err("it was not run".to_owned());
    results
        .into_iter()
        .map(|slot| slot.into_inner().ok().flatten().unwrap_or_else(not_run))
        .collect()
}

/// Counts particles times steps.
struct Counter<'a> {
    done: &'a AtomicU64,
    atoms: u64,
}

impl lennard_engine::Progress for Counter<'_> {
    fn update(&mut self, _stage: &str, done: u64, _total: u64) {
        self.done.store(done * self.atoms, Ordering::Relaxed);
    }
}

fn run_point(
    point: &Point,
    found: &Found,
    options: &SweepOptions<'_>,
    threads: usize,
    done: &AtomicU64,
) -> Result<Ran, String> {
    if matches!(found, Found::Finished) {
        return Ok(Ran::Kept);
    }
    if options.stop.load(Ordering::Relaxed) {
        return Ok(Ran::Stopped);
    }
    let folder = options.folder.join(&point.name);
    let ending = pool(threads)
        .map_err(|e| e.to_string())?
        .install(|| start_or_go_on(point, found, options, threads, &folder, done))
        .map_err(|error| error.to_string())?;
    if ending != lennard_engine::Ending::Finished {
        return Ok(Ran::Stopped);
    }
    if options.reports {
        run_page::write(&folder).map_err(|e| e.to_string())?;
    }
    Ok(Ran::Finished)
}

fn start_or_go_on(
    point: &Point,
    found: &Found,
    options: &SweepOptions<'_>,
    threads: usize,
    folder: &Path,
    done: &AtomicU64,
) -> Result<lennard_engine::Ending, EngineError> {
    let claim =
        |existing| lennard_io::create_named_folder(folder, existing).map_err(EngineError::Folder);
    let mut counter = Counter {
        done,
        atoms: point.atoms as u64,
    };
    if matches!(found, Found::Begun) {
        let held = claim(Existing::Keep)?;
        if let Ok(mut resumed) = lennard_engine::resume(folder, &ResumeOptions::default()) {
            let how = how(&held, threads, options.stop, &mut counter);
            return Ok(lennard_engine::go_on(&mut resumed, how)?.ending);
        }
    }
    let mut simulation = lennard_engine::prepare(point.scene.clone())?;
    let held = claim(Existing::Replace)?;
    let how = how(&held, threads, options.stop, &mut counter);
    Ok(lennard_engine::run(&mut simulation, how)?.ending)
}

fn how<'a>(
    folder: &'a OutputFolder,
    threads: usize,
    stop: &'a AtomicBool,
    progress: &'a mut dyn lennard_engine::Progress,
) -> RunOptions<'a> {
    RunOptions {
        folder,
        threads,
        stop,
        deadline: None,
        progress,
    }
}

fn conclude(point: &Point, outcome: Result<Ran, String>, folder: &Path) -> SweptPoint {
    let model = lennard_engine::model_kind(&point.scene);
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
