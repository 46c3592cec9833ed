//! Threads that belong to one process.

use std::sync::{Arc, Mutex, PoisonError};

use lennard_core::parallel::{self, PoolError};
use rayon::ThreadPool;

/// The threads of a simulation, as long as it lives.
///
/// A forked child has none of the threads of its parent, and work that waits for them never ends. The child starts its own.
pub struct Threads {
    count: usize,
    started: Mutex<Started>,
}

struct Started {
    process: u32,
    pool: Arc<ThreadPool>,
}

impl Started {
    fn new(count: usize) -> Result<Self, PoolError> {
        Ok(Self { process: std::process::id(), pool: Arc::new(parallel::pool(count)?) })
    }

    fn is_of_parent(&self) -> bool {
        self.process != std::process::id()
    }
}

impl Threads {
    /// Starts so many threads.
    ///
    /// # Errors
    /// [`PoolError`] where the number is not allowed, or the system gives no threads.
    pub fn new(count: usize) -> Result<Self, PoolError> {
        Ok(Self { count, started: Mutex::new(Started::new(count)?) })
    }

    /// Number of threads.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The threads, in the process that asks.
    ///
    /// # Errors
    /// [`PoolError`] where a forked child gets no threads.
    pub fn pool(&self) -> Result<Arc<ThreadPool>, PoolError> {
        let mut started = self.started.lock().unwrap_or_else(PoisonError::into_inner);
        if started.is_of_parent() {
            *started = Started::new(self.count)?;
        }
        Ok(Arc::clone(&started.pool))
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        if self.is_of_parent() {
            // To end threads takes locks that some of them may have held when the process was copied.
            std::mem::forget(Arc::clone(&self.pool));
        }
    }
}
