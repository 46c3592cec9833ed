//! Running the points of a sweep side by side, and going on where an earlier sweep stopped.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use lennard_core::parallel::pool;
use lennard_engine::{Control, EngineError, ResumeOptions};
use lennard_io::{CheckpointFolder, Existing, FolderError, RunRecord};
use rayon::ThreadPool;

use super::{Ending, Failed, Point, Sweep, SweepError, SweepRecord, SweptPoint, record};
use crate::compare::{RunFolder, compare};
use crate::files::same_scene;
use crate::jobs::{side_by_side_with, unless_stopped};
use crate::{Progress, run_page};

/// Runs what is not finished yet, and writes table, page and record.
///
/// # Errors
/// [`SweepError`] where a folder holds something else, a file cannot be written, or the points have nothing for the reading
/// that the study names. A point that fails is no error: the record says so.
pub fn run(
    sweep: &Sweep,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<SweepRecord, SweepError> {
    let points = run_points(sweep, options, progress)?;
    let ending = ending_of(&points, options.folder);
    let read = record::read(sweep, points, ending, options.threads)?;
    match ending {
        Ending::NotBegun => Ok(read.record),
        _ => read.write(options.folder, &options.command),
    }
}

/// Writes table, page and record of the points that many processes have finished, and runs nothing.
///
/// # Errors
/// [`SweepError`] where a file cannot be written. A folder that holds another run is a failure of its point.
pub fn collect(sweep: &Sweep, folder: &Path, command: &str) -> Result<SweepRecord, SweepError> {
    let points = sweep.points.iter().map(|point| {
        let place = folder.join(&point.name);
        let end = match contents_of(&place, point) {
            Ok(FolderContents::Finished) => Ok(PointEnd::FinishedBefore),
            Ok(FolderContents::Begun | FolderContents::Nothing) => Ok(PointEnd::Stopped),
            Err(holds) => Err(Failed::of_input(holds)),
        };
        conclude(point, end, &place)
    });
    let points: Vec<_> = points.collect();
    let ending = if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else if points.iter().any(|p| p.is_unfinished()) {
        Ending::Incomplete
    } else {
        Ending::Finished
    };
    record::read(sweep, points, ending, 1)?.write(folder, command)
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
    let found: Vec<FolderContents> = sweep
        .points
        .iter()
        .map(|point| look(&options.folder.join(&point.name), point, options.replace))
        .collect::<Result<_, _>>()?;
    let outcomes = run_all(&sweep.points, &found, options, progress);
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

/// Finds out what an earlier sweep has left, before anything is written.
fn look(folder: &Path, point: &Point, replace: bool) -> Result<FolderContents, SweepError> {
    let found = match contents_of(folder, point) {
        Ok(found @ (FolderContents::Finished | FolderContents::Nothing)) => return Ok(found),
        Ok(FolderContents::Begun) => FolderContents::Begun,
        Err(_) if replace => FolderContents::Nothing,
        Err(found) => {
            let folder = folder.to_owned();
            return Err(SweepError::Folder { folder, found });
        }
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

fn conclude(point: &Point, outcome: Result<PointEnd, Failed>, folder: &Path) -> SweptPoint {
    let page = folder.join("report.html").exists();
    let settings = point.settings.clone();
    let mut swept = SweptPoint {
        page: page.then(|| format!("{}/report.html", point.name)),
        kept: matches!(outcome, Ok(PointEnd::FinishedBefore)),
        ..SweptPoint::not_run(point.name.as_str(), settings, point.planned())
    };
    match outcome {
        Err(failure) => swept.failure = Some(failure),
        Ok(PointEnd::Stopped) => {}
        Ok(PointEnd::Elsewhere(process)) => swept.elsewhere = Some(process),
        Ok(PointEnd::FinishedBefore | PointEnd::Finished) => match RunFolder::open(folder) {
            Err(e) => swept.failure = Some(Failed::otherwise(&e)),
            Ok(run) => {
                swept.wall_s = run.record.wall_s;
                swept.ns_per_atom_step = run.record.performance.ns_per_atom_step;
                swept.compared = Some(compare(&run));
                swept.record = Some(run.record);
            }
        },
    }
    swept
}

/// The largest share that is told while a point is at work: after its last step it still writes its page.
const UNFINISHED: f64 = 0.99;

/// From this number of particles on, a point takes threads that are left over. In smaller systems, threads wait
/// for each other longer than they compute.
const LARGE: usize = 4000;

/// Points at work at once.
#[must_use]
pub fn workers(points: usize, threads: usize) -> usize {
    threads.clamp(1, points.max(1))
}

/// Threads for a point of `atoms` particles that worker number `worker` of `workers` runs: one, or for a large point
/// its share of all threads. Threads that are left over go to the first workers. The number of threads changes no bit
/// of the results.
pub(super) fn threads_of(worker: usize, workers: usize, threads: usize, atoms: usize) -> usize {
    if atoms < LARGE {
        return 1;
    }
    threads.max(1) / workers + usize::from(worker < threads % workers)
}

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

/// What is in the folder of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FolderContents {
    /// A finished run of the same scene.
    Finished,
    /// A run of the same scene that can go on.
    Begun,
    /// Nothing of use.
    Nothing,
}

/// What the folder of a point holds; an error says what else it holds.
pub(super) fn contents_of(folder: &Path, point: &Point) -> Result<FolderContents, String> {
    let record = folder.join("run.json");
    if !record.exists() {
        return Ok(FolderContents::Nothing);
    }
    match lennard_io::read_run_record(&record) {
        Err(e) => Err(format!("its run.json cannot be read: {e}")),
        Ok(_) if same_scene(folder, &point.scene) != Some(true) => {
            Err("it holds the run of another scene".into())
        }
        Ok(RunRecord { finished: true, .. }) => Ok(FolderContents::Finished),
        Ok(_) => Ok(FolderContents::Begun),
    }
}

/// How the run of one point ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum PointEnd {
    /// It had been finished before.
    FinishedBefore,
    /// It was run to its end.
    Finished,
    /// It can go on.
    Stopped,
    /// Another process is at work there; which, in words.
    Elsewhere(String),
}

impl From<lennard_engine::Ending> for PointEnd {
    fn from(ending: lennard_engine::Ending) -> Self {
        match ending {
            lennard_engine::Ending::Finished => Self::Finished,
            lennard_engine::Ending::Stopped | lennard_engine::Ending::OutOfTime => Self::Stopped,
        }
    }
}

/// Runs all points, and tells how far they are. A point that was not begun when the sweep was asked to stop counts as
/// stopped.
pub(super) fn run_all(
    points: &[Point],
    found: &[FolderContents],
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Vec<Result<PointEnd, Failed>> {
    let runs: Vec<PointRun<'_>> = points
        .iter()
        .zip(found)
        .map(|(point, contents)| PointRun {
            point,
            contents: *contents,
            options,
            done: AtomicU64::new(0),
        })
        .collect();
    let to_run = || runs.iter().filter(|run| run.contents != FolderContents::Finished);
    let total: u64 =
        to_run().map(|run| run.point.scene.total_steps() * run.point.atoms as u64).sum();
    let workers = workers(to_run().count(), options.threads);
    side_by_side_with(
        workers,
        &runs,
        |worker, run| run.run(threads_of(worker, workers, options.threads, run.point.atoms)),
        |finished| {
            let done: u64 = runs.iter().map(|run| run.done.load(Ordering::Relaxed)).sum();
            let share = done as f64 / total.max(1) as f64;
            let most = if finished == runs.len() { 1.0 } else { UNFINISHED };
            let label = format!("{finished} of {} points", points.len());
            progress.update(&label, share.min(most));
        },
    )
}

/// A point and how far its run is.
struct PointRun<'a> {
    point: &'a Point,
    contents: FolderContents,
    options: &'a SweepOptions<'a>,
    /// Particles times steps.
    done: AtomicU64,
}

impl PointRun<'_> {
    fn run(&self, threads: usize) -> Result<PointEnd, Failed> {
        if self.contents == FolderContents::Finished {
            return Ok(PointEnd::FinishedBefore);
        }
        let is_late = self.options.deadline.is_some_and(|end| Instant::now() >= end);
        if self.options.stop.load(Ordering::SeqCst) || is_late {
            return Ok(PointEnd::Stopped);
        }
        let folder = self.options.folder.join(&self.point.name);
        let pool = Arc::new(pool(threads).map_err(|e| Failed::otherwise(&e))?);
        let end = match self.start_or_go_on(&pool, &folder) {
            Err(EngineError::Folder(busy @ FolderError::Busy { .. })) => {
                return Ok(PointEnd::Elsewhere(busy.to_string()));
            }
            end => end?,
        };
        if end == PointEnd::Finished && self.options.reports {
            run_page::write(&folder).map_err(|e| Failed::otherwise(&e))?;
        }
        Ok(end)
    }

    fn start_or_go_on(
        &self,
        pool: &Arc<ThreadPool>,
        folder: &Path,
    ) -> Result<PointEnd, EngineError> {
        let claim =
            || lennard_io::create_named_folder(folder, Existing::Keep).map_err(EngineError::Folder);
        // Another process may have finished it since.
        let is_finished = || contents_of(folder, self.point) == Ok(FolderContents::Finished);
        let stop = &self.options.stop;
        let mut counter = Counter { done: &self.done, atoms: self.point.atoms as u64 };
        if self.contents == FolderContents::Begun {
            let held = claim()?;
            if is_finished() {
                return Ok(PointEnd::FinishedBefore);
            }
            let (own, from) = (Arc::clone(pool), folder.to_owned());
            let resumed = unless_stopped(stop, move || {
                own.install(|| lennard_engine::resume(&from, &ResumeOptions::default()))
            });
            let Some(resumed) = resumed else {
                return Ok(PointEnd::Stopped);
            };
            if let Ok(mut resumed) = resumed {
                let go_on =
                    || lennard_engine::go_on(&mut resumed, &held, self.control(&mut counter));
                return Ok(pool.install(go_on)?.ending.into());
            }
        }
        let (own, scene) = (Arc::clone(pool), self.point.scene.clone());
        let prepared = unless_stopped(stop, move || own.install(|| lennard_engine::prepare(scene)));
        let Some(simulation) = prepared else {
            return Ok(PointEnd::Stopped);
        };
        let mut simulation = simulation?;
        let mut held = claim()?;
        if is_finished() {
            return Ok(PointEnd::FinishedBefore);
        }
        held.remove_run().map_err(EngineError::Folder)?;
        let run = || lennard_engine::run(&mut simulation, &held, self.control(&mut counter));
        Ok(pool.install(run)?.ending.into())
    }

    fn control<'a>(&'a self, progress: &'a mut dyn lennard_engine::Progress) -> Control<'a> {
        let SweepOptions { stop, deadline, .. } = self.options;
        Control { stop, deadline: *deadline, progress }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_left_over_go_to_large_points_and_every_thread_has_work() {
        for (points, threads) in [(3, 8), (8, 8), (38, 2), (1, 4), (5, 1)] {
            let n = workers(points, threads);
            assert!(n <= points && n <= threads);
            let large: usize = (0..n).map(|w| threads_of(w, n, threads, 32_000)).sum();
            assert_eq!(large, threads);
            assert!((0..n).all(|w| threads_of(w, n, threads, 864) == 1));
        }
        assert_eq!((0..3).map(|w| threads_of(w, 3, 8, 32_000)).collect::<Vec<_>>(), [3, 3, 2]);
        // A sweep with nothing to run still has one worker.
        assert_eq!(workers(0, 4), 1);
    }
}
