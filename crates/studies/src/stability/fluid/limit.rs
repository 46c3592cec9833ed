//! The largest stable step of a method on the fluid, by bisection.

use lennard_forcefield::Precision;
use lennard_integrators::IntegratorEntry;
use serde::Serialize;

use super::run::{FluidRun, Outcome, Plan, run};
use super::start::{FluidStart, STATES, TRUNCATIONS};
use crate::StudyError;

/// A step is stable if the energy has changed by less than this share of the kinetic energy 3/2·T …
pub const ALLOWED_CHANGE: f64 = 0.05;
/// … after at least this time, τ …
pub const LEAST_TIME: f64 = 0.5;
/// … and at least this many steps.
pub const LEAST_STEPS: u64 = 500;
/// The search starts here, τ, and goes up or down from it.
const FIRST_DT: f64 = 0.005;
/// Factor of the search.
const STRIDE: f64 = 1.4;
/// The search ends here.
const SMALLEST_DT: f64 = 2e-5;
const LARGEST_DT: f64 = 0.5;
/// Halvings, in the logarithm: 1.4^(1/16) is 2 %.
const HALVINGS: u32 = 4;

/// The limit of one method at one state point under one truncation.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FluidLimit {
    /// The method.
    pub method: &'static str,
    /// Name of the state point.
    pub state: &'static str,
    /// Name of the truncation.
    pub truncation: &'static str,
    /// The largest step found stable, τ; `None` where even the smallest tried is not.
    pub stable: Option<f64>,
    /// The smallest step found unstable, τ; `None` where even the largest tried is stable.
    pub unstable: Option<f64>,
    /// How the run at that unstable step ended.
    pub failure: Option<Outcome>,
    /// Its change of energy where it completed, ε per atom.
    pub failure_change: Option<f64>,
}

impl FluidLimit {
    /// The middle between the two, in the logarithm.
    #[must_use]
    pub fn middle(&self) -> Option<f64> {
        Some((self.stable? * self.unstable?).sqrt())
    }
}

fn stable(run: &FluidRun, temperature: f64) -> bool {
    run.completed() && run.change.is_some_and(|c| c.abs() < ALLOWED_CHANGE * 1.5 * temperature)
}

/// Searches and bisects.
pub(crate) fn find(
    entry: &'static IntegratorEntry,
    start: &FluidStart,
) -> Result<FluidLimit, StudyError> {
    let temperature = STATES[start.state_point].temperature;
    let attempt = |dt: f64| {
        run(&Plan {
            entry,
            start,
            dt,
            steps: LEAST_STEPS.max((LEAST_TIME / dt).ceil() as u64),
            precision: Precision::Double,
        })
    };
    let mut limit = FluidLimit {
        method: entry.spec.name,
        state: STATES[start.state_point].name,
        truncation: TRUNCATIONS[start.truncation].1,
        ..FluidLimit::default()
    };
    let take = |limit: &mut FluidLimit, dt: f64| -> Result<bool, StudyError> {
        let run = attempt(dt)?;
        let good = stable(&run, temperature);
        if good {
            limit.stable = Some(dt);
        } else {
            limit.unstable = Some(dt);
            limit.failure_change = run.change;
            limit.failure = Some(run.outcome);
        }
        Ok(good)
    };
    let mut dt = FIRST_DT;
    let up = take(&mut limit, dt)?;
    while limit.stable.is_none() || limit.unstable.is_none() {
        dt = if up { dt * STRIDE } else { dt / STRIDE };
        if !(SMALLEST_DT..LARGEST_DT).contains(&dt) {
            return Ok(limit);
        }
        take(&mut limit, dt)?;
    }
    for _ in 0..HALVINGS {
        let Some(middle) = limit.middle() else { break };
        take(&mut limit, middle)?;
    }
    Ok(limit)
}
