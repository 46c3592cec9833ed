//! A run on the threads of a pool, while the calling thread looks for signals and tells how far it is.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use lennard_engine::{Control, Ending, Progress};
use lennard_io::{Existing, RunRecord};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::errors;
use crate::inner::Inner;

/// The time between two looks: Ctrl-C is answered after this and a few steps.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// How far a run is, written by the run and read by the calling thread.
#[derive(Default)]
struct Position {
    done: AtomicU64,
    total: AtomicU64,
    stage: Mutex<String>,
}

struct Teller<'a> {
    position: &'a Position,
    stage: String,
}

impl Progress for Teller<'_> {
    fn update(&mut self, stage: &str, done: u64, total: u64) {
        if self.stage != stage {
            stage.clone_into(&mut self.stage);
            let mut shown = self.position.stage.lock().unwrap_or_else(PoisonError::into_inner);
            stage.clone_into(&mut shown);
        }
        self.position.total.store(total, Ordering::Relaxed);
        self.position.done.store(done, Ordering::Relaxed);
    }
}

impl Position {
    /// Lets Python answer signals, and tells a callback `(stage, done, total)`.
    fn look(&self, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let total = self.total.load(Ordering::Relaxed);
            let Some(callback) = callback.filter(|_| total > 0) else {
                return Ok(());
            };
            let done = self.done.load(Ordering::Relaxed);
            let stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
            callback.call1(py, (stage, done, total)).map(drop)
        })
    }
}

/// Does `work` on the pool without Python's lock. A signal or an exception of the callback stops it, and is raised after it.
pub fn watched<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    callback: Option<&Py<PyAny>>,
    work: impl FnOnce(Control<'_>) -> T + Send,
) -> (Option<T>, PyResult<()>) {
    py.detach(move || {
        let (stop, position) = (AtomicBool::new(false), Position::default());
        let (finish, finished) = mpsc::channel();
        pool.in_place_scope(|scope| {
            let (stop, position) = (&stop, &position);
            scope.spawn(move |_| {
                let stage = String::new();
                let progress = &mut Teller { position, stage };
                let done = work(Control { stop, deadline: None, progress });
                // The receiver waits below for as long as this runs.
                let _ = finish.send(done);
            });
            let mut raised = Ok(());
            let done = loop {
                match finished.recv_timeout(LOOK_EVERY) {
                    Ok(done) => break Some(done),
                    // It panicked, and the scope passes that on.
                    Err(RecvTimeoutError::Disconnected) => break None,
                    Err(RecvTimeoutError::Timeout) => {}
                }
                if raised.is_ok() {
                    raised = position.look(callback);
                    if raised.is_err() {
                        stop.store(true, Ordering::Relaxed);
                    }
                }
            };
            if raised.is_ok() {
                raised = position.look(callback);
            }
            (done, raised)
        })
    })
}

/// Runs the whole scene of a simulation with the files that the command line writes, and returns the record.
pub fn in_folder(
    py: Python<'_>,
    inner: &mut Inner,
    folder: &Path,
    existing: Existing,
    report: bool,
    callback: Option<&Py<PyAny>>,
) -> PyResult<RunRecord> {
    let pool = inner.pool()?;
    let Inner { simulation, from_file, .. } = inner;
    let (done, raised) =
        watched(py, &pool, callback, |control| simulation.run_in(folder, existing, control));
    let outcome = done.transpose().map_err(|e| errors::of_engine(e, *from_file))?;
    raised?;
    let outcome = outcome.ok_or_else(|| PyRuntimeError::new_err("the run has no end"))?;
    if report && outcome.ending == Ending::Finished {
        let write = || lennard_studies::run_page::write(folder);
        let written = py.detach(|| pool.install(write));
        written.map_err(|e| PyOSError::new_err(e.to_string()))?;
    }
    Ok(outcome.record)
}
