//! Where the time of forces goes.

use std::time::Instant;

/// Seconds spent, for the run record.
#[derive(Debug, Clone, Copy, Default)]
pub struct Clock {
    /// In pair loops.
    pub force: f64,
    /// In building lists.
    pub neighbor: f64,
}

impl Clock {
    /// Counts some work as building of lists.
    pub fn building<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let done = work();
        self.neighbor += start.elapsed().as_secs_f64();
        done
    }

    /// Counts some work as pair loops, but for what it counts as building by itself.
    pub fn using<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> R {
        let (start, before) = (Instant::now(), self.neighbor);
        let done = work(self);
        self.force += start.elapsed().as_secs_f64() - (self.neighbor - before);
        done
    }
}
