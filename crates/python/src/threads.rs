//! Threads that belong to one process.

use std::sync::Arc;

use lennard_core::parallel::{self, PoolError};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;

/// The threads of a simulation, as long as it lives.
///
/// A forked child has none of the threads of its parent, and work that waits for them never ends. The child starts its own.
/// All parallel work of this module runs here: the pool that rayon shares in a process cannot be started again.
pub struct Threads {
    count: usize,
    process: u32,
    pool: Arc<ThreadPool>,
}

impl Threads {
    /// Starts so many threads.
    pub fn new(count: usize) -> PyResult<Self> {
        let pool = parallel::pool(count).map_err(|e| match e {
            PoolError::Number(_) => PyValueError::new_err(e.to_string()),
            PoolError::System(e) => PyRuntimeError::new_err(format!("starting threads: {e}")),
        })?;
        Ok(Self { count, process: std::process::id(), pool: Arc::new(pool) })
    }

    /// Number of threads.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The threads, in the process that asks.
    pub fn pool(&mut self) -> PyResult<&ThreadPool> {
        if self.is_of_parent() {
            *self = Self::new(self.count)?;
        }
        Ok(&self.pool)
    }

    /// Does `work` on the threads, without Python's lock.
    pub fn run<R: Send>(&mut self, py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
        let pool = self.pool()?;
        Ok(py.detach(|| pool.install(work)))
    }

    fn is_of_parent(&self) -> bool {
        self.process != std::process::id()
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        if self.is_of_parent() {
            // To end threads takes locks that some of them may have held when the process was copied.
            std::mem::forget(Arc::clone(&self.pool));
        }
    }
}
