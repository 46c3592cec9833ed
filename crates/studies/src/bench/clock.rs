//! Two clocks: the one on the wall, and the time that a thread really had a processor.

use std::time::Instant;

/// Started at the beginning of a block.
pub(super) struct Clock {
    wall: Instant,
    on_processor: Option<f64>,
}

impl Clock {
    pub(super) fn start() -> Self {
        Self {
            on_processor: seconds_on_processor(),
            wall: Instant::now(),
        }
    }

    /// Seconds on the wall.
    pub(super) fn wall(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Seconds that this thread was on a processor, on a shared machine a steadier measure; those on the wall where the
    /// system does not tell.
    pub(super) fn on_processor(&self) -> f64 {
        match (self.on_processor, seconds_on_processor()) {
            (Some(before), Some(now)) => now - before,
            _ => self.wall(),
        }
    }
}

/// Whether [`Clock::on_processor`] is what its name says.
pub(super) fn tells_processor_time() -> bool {
    seconds_on_processor().is_some()
}

#[cfg(target_os = "linux")]
fn seconds_on_processor() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(target_os = "linux"))]
fn seconds_on_processor() -> Option<f64> {
    None
}
