//! The largest stable step of a method on the fluid, by bisection.

use super::run::{FluidRun, Plan, run};
use crate::StudyError;

/// A step is stable if the energy has changed by less than this share of the kinetic energy 3/2·T …
pub(super) const ALLOWED_CHANGE: f64 = 0.05;
/// … after at least this time, τ …
pub(super) const LEAST_TIME: f64 = 0.5;
/// … and at least this many steps.
pub(super) const LEAST_STEPS: u64 = 500;
/// The search starts here, τ, and goes up or down from it.
const FIRST_DT: f64 = 0.005;
/// Factor of the search.
const STRIDE: f64 = 1.4;
/// The search ends here.
const SMALLEST_DT: f64 = 2e-5;
const LARGEST_DT: f64 = 0.5;
/// Halvings, in the logarithm: 1.4^(1/16) is 2 %.
const HALVINGS: u32 = 4;

/// The limit of one method from one start.
#[derive(Default)]
pub(super) struct FluidLimit {
    /// The run at the smallest unstable step, or at the largest one where every step tried is stable.
    pub(super) last: FluidRun,
    /// The largest step found stable, τ; `None` where even the smallest tried is not.
    pub(super) stable: Option<f64>,
    /// The smallest step found unstable, τ; `None` where even the largest tried is stable.
    pub(super) unstable: Option<f64>,
}

impl FluidLimit {
    /// The middle between the two, in the logarithm.
    pub(super) fn middle(&self) -> Option<f64> {
        Some((self.stable? * self.unstable?).sqrt())
    }
}

/// Searches and bisects with a method from a start; the plan's own step and length do not count.
pub(super) fn find(plan: &Plan<'_>) -> Result<FluidLimit, StudyError> {
    let attempt = |dt: f64| {
        let steps = LEAST_STEPS.max((LEAST_TIME / dt).ceil() as u64);
        run(&Plan { dt, steps, ..*plan })
    };
    let (mut dt, mut upwards, mut halvings) = (FIRST_DT, None, 0);
    let mut limit = FluidLimit::default();
    while (SMALLEST_DT..LARGEST_DT).contains(&dt) && halvings <= HALVINGS {
        let run = attempt(dt)?;
        let allowed = ALLOWED_CHANGE * 1.5 * run.temperature;
        let is_stable = run.failure.is_none() && run.change.is_some_and(|c| c.abs() < allowed);
        if is_stable {
            limit.stable = Some(dt);
        } else {
            limit.unstable = Some(dt);
        }
        if !is_stable || limit.unstable.is_none() {
            limit.last = run;
        }
        dt = match (limit.middle(), *upwards.get_or_insert(is_stable)) {
            (Some(middle), _) => {
                halvings += 1;
                middle
            }
            (None, true) => dt * STRIDE,
            (None, false) => dt / STRIDE,
        };
    }
    Ok(limit)
}
