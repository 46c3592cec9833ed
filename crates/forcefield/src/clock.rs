//! The time that forces take, for the run record.

use std::time::Instant;

/// Seconds spent so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Clock {
    /// Seconds in pair loops.
    pub force: f64,
    /// Seconds in list builds.
    pub neighbor: f64,
}

impl Clock {
    /// Does some work and counts its time as a list build.
    pub fn building<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let done = work();
        self.neighbor += start.elapsed().as_secs_f64();
        done
    }

    /// Does some work and counts its time as pair loops, except for the builds that the work counts itself.
    pub fn computing<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> R {
        let (start, before) = (Instant::now(), self.neighbor);
        let done = work(self);
        self.force += start.elapsed().as_secs_f64() - (self.neighbor - before);
        done
    }
}
