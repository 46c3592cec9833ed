//! Where the time of a run goes.

use std::time::Duration;

/// Time by stage of work. Force and neighbor times come from the force provider, which knows them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Timers {
    /// Steps as a whole: integrator, forces, lists and heat bath.
    pub step: Duration,
    /// Observables.
    pub observe: Duration,
    /// Files.
    pub write: Duration,
}
