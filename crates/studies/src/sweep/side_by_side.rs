//! The points of a sweep on threads of their own, so that a sweep which is asked to stop need not wait for starts.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lennard_engine::{EngineError, ResumeOptions, RunOptions};
use lennard_io::{Existing, FolderError, OutputFolder};

use super::ran::{Failed, Found, Ran};
use super::run::found_in;
use super::threads::{threads_of, workers};
use super::{Point, SweepOptions};
use crate::jobs::pool;
use crate::{Progress, run_page};

/// Time between two looks at how far the points are.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// The largest share that is told while a point is at work.
const UNFINISHED: f64 = 0.99;

/// What the workers share. A worker that is abandoned while it places particles keeps it alive, and writes nothing.
struct Shared {
    points: Vec<Point>,
    found: Vec<Found>,
    folder: PathBuf,
    threads: usize,
    workers: usize,
    reports: bool,
    stop: Arc<AtomicBool>,
    deadline: Option<Instant>,
    /// The next point to take.
    next: AtomicUsize,
    /// Workers that are not done.
    left: AtomicUsize,
    /// Workers that place particles or read a checkpoint, and have written nothing for their point.
    starting: AtomicUsize,
    /// Particles times steps of each point.
    done: Vec<AtomicU64>,
    results: Vec<Mutex<Option<Result<Ran, Failed>>>>,
}

/// Runs all points, and tells how far they are. A point that was not begun when the sweep was asked to stop counts as
/// stopped.
pub(super) fn run_all(
    points: &[Point],
    found: Vec<Found>,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Vec<Result<Ran, Failed>> {
    let to_run = found.iter().filter(|f| **f != Found::Finished).count();
    let total: u64 = points
        .iter()
        .zip(&found)
        .filter(|(_, f)| **f != Found::Finished)
        .map(|(point, _)| point.scene.total_steps() * point.atoms as u64)
        .sum();
    let workers = workers(to_run, options.threads);
    let shared = Arc::new(Shared {
        points: points.to_vec(),
        found,
        folder: options.folder.to_path_buf(),
        threads: options.threads,
        workers,
        reports: options.reports,
        stop: Arc::clone(&options.stop),
        deadline: options.deadline,
        next: AtomicUsize::new(0),
        left: AtomicUsize::new(workers),
        starting: AtomicUsize::new(0),
        done: points.iter().map(|_| AtomicU64::new(0)).collect(),
        results: points.iter().map(|_| Mutex::new(None)).collect(),
    });
    for worker in 0..workers {
        let shared = Arc::clone(&shared);
        std::thread::spawn(move || shared.work(worker));
    }
    let mut tell = |most: f64| {
        let so_far: u64 = shared.done.iter().map(|d| d.load(Ordering::Relaxed)).sum();
        let finished =
            shared.results.iter().filter(|r| r.lock().is_ok_and(|slot| slot.is_some())).count();
        let share = so_far as f64 / total.max(1) as f64;
        progress.update(&format!("{finished} of {} points", points.len()), share.min(most));
    };
    while shared.is_at_work() {
        std::thread::sleep(LOOK_EVERY);
        // After its last step a point still writes its page.
        tell(UNFINISHED);
    }
    tell(1.0);
    let missing = || match shared.is_told_to_stop() {
        true => Ok(Ran::Stopped),
        false => Err(Failed::otherwise(&"it was not run")),
    };
    shared
        .results
        .iter()
        .map(|slot| slot.lock().ok().and_then(|mut slot| slot.take()))
        .map(|result| result.unwrap_or_else(missing))
        .collect()
}

impl Shared {
    /// In one order for all threads: a worker that did not see the request is seen to have begun.
    fn is_told_to_stop(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Whether a worker has something to finish or to keep.
    fn is_at_work(&self) -> bool {
        let idle = match self.is_told_to_stop() {
            true => self.starting.load(Ordering::SeqCst),
            false => 0,
        };
        self.left.load(Ordering::SeqCst) > idle
    }

    /// Takes one point after the other.
    fn work(&self, worker: usize) {
        /// Lets go however the worker ends.
        struct Leaving<'a>(&'a AtomicUsize);
        impl Drop for Leaving<'_> {
            fn drop(&mut self) {
                self.0.fetch_sub(1, Ordering::SeqCst);
            }
        }
        let _leaving = Leaving(&self.left);
        while let Some(i) =
            Some(self.next.fetch_add(1, Ordering::Relaxed)).filter(|i| *i < self.points.len())
        {
            let threads = threads_of(worker, self.workers, self.threads, self.points[i].atoms);
            let result = self.run_point(i, threads);
            if let Ok(mut slot) = self.results[i].lock() {
                *slot = Some(result);
            }
        }
    }

    fn run_point(&self, i: usize, threads: usize) -> Result<Ran, Failed> {
        if self.found[i] == Found::Finished {
            return Ok(Ran::Kept);
        }
        let is_late = self.deadline.is_some_and(|end| Instant::now() >= end);
        if self.is_told_to_stop() || is_late {
            return Ok(Ran::Stopped);
        }
        let folder = self.folder.join(&self.points[i].name);
        let ran = pool(threads)
            .map_err(|e| Failed::otherwise(&e))?
            .install(|| self.start_or_go_on(i, threads, &folder));
        let ran = match ran {
            Err(EngineError::Folder(busy @ FolderError::Busy { .. })) => {
                return Ok(Ran::Elsewhere(busy.to_string()));
            }
            ran => ran?,
        };
        if ran == Ran::Finished && self.reports {
            run_page::write(&folder).map_err(|e| Failed::otherwise(&e))?;
        }
        Ok(ran)
    }

    /// Does what may take long and writes nothing; `None` where the sweep was asked to stop meanwhile.
    fn start<T>(&self, start: impl FnOnce() -> T) -> Option<T> {
        self.starting.fetch_add(1, Ordering::SeqCst);
        let started = start();
        self.starting.fetch_sub(1, Ordering::SeqCst);
        (!self.is_told_to_stop()).then_some(started)
    }

    fn start_or_go_on(&self, i: usize, threads: usize, folder: &Path) -> Result<Ran, EngineError> {
        let claim =
            || lennard_io::create_named_folder(folder, Existing::Keep).map_err(EngineError::Folder);
        let point = &self.points[i];
        let mut counter = Counter { done: &self.done[i], atoms: point.atoms as u64 };
        if self.found[i] == Found::Begun {
            let held = claim()?;
            // Another process may have finished it since.
            if found_in(folder, point) == Ok(Found::Finished) {
                return Ok(Ran::Kept);
            }
            let options = ResumeOptions::default();
            let Some(resumed) = self.start(|| lennard_engine::resume(folder, &options)) else {
                return Ok(Ran::Stopped);
            };
            if let Ok(mut resumed) = resumed {
                let how = self.how(&held, threads, &mut counter);
                return Ok(Ran::of(lennard_engine::go_on(&mut resumed, how)?.ending));
            }
        }
        let scene = point.scene.clone();
        let Some(simulation) = self.start(|| lennard_engine::prepare(scene)) else {
            return Ok(Ran::Stopped);
        };
        let mut simulation = simulation?;
        let mut held = claim()?;
        if found_in(folder, point) == Ok(Found::Finished) {
            return Ok(Ran::Kept);
        }
        held.remove_run().map_err(EngineError::Folder)?;
        let how = self.how(&held, threads, &mut counter);
        Ok(Ran::of(lennard_engine::run(&mut simulation, how)?.ending))
    }

    fn how<'a>(
        &'a self,
        folder: &'a OutputFolder,
        threads: usize,
        progress: &'a mut dyn lennard_engine::Progress,
    ) -> RunOptions<'a> {
        RunOptions { folder, threads, stop: &self.stop, deadline: self.deadline, progress }
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
