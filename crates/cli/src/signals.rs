//! Signals that ask a run to stop: it finishes its step, writes a checkpoint and ends with exit code 4.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::{Failure, OTHER};

/// What a shell says of a program that SIGINT has ended.
const ENDED_BY_SIGINT: i32 = 130;

/// A flag that is set by SIGINT, SIGTERM and, where there is such a thing, SIGUSR1. A second SIGINT ends the
/// program at once: whoever presses the keys twice does not want to wait for the step.
pub fn stop_flag() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let failed = |e| Failure::new("listening for signals", e, OTHER);
    // In this order: the first SIGINT must not find the flag set by itself.
    flag::register_conditional_shutdown(SIGINT, ENDED_BY_SIGINT, Arc::clone(&stop))
        .map_err(failed)?;
    for signal in signals() {
        flag::register(signal, Arc::clone(&stop)).map_err(failed)?;
    }
    Ok(stop)
}

#[cfg(unix)]
fn signals() -> Vec<i32> {
    vec![SIGINT, SIGTERM, signal_hook::consts::SIGUSR1]
}

#[cfg(not(unix))]
fn signals() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}
