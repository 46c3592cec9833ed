//! One run of the fluid at constant energy, and what it says about the method.

use lennard_core::{Momentum, StepError, Want};
use lennard_forcefield::Precision;
use lennard_integrators::IntegratorEntry;
use lennard_observables::statistics::Line;
use serde::Serialize;

use super::start::{ATOMS, FluidStart, STATES, TRUNCATIONS};
use crate::StudyError;
use crate::lab::Rig;

/// Time between two looks at the energy, τ.
const SAMPLE_INTERVAL: f64 = 0.02;
/// Blocks for the errors of means and of the drift.
const BLOCKS: usize = 10;
/// A run has run away when its energy has changed by this many times the kinetic energy 3/2·T.
const RUN_AWAY: f64 = 10.0;

/// How a run ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Outcome {
    /// It reached its end.
    #[default]
    Completed,
    /// The method or the forces refused to go on.
    Stopped {
        /// Step at which it stopped.
        step: u64,
        /// Time at which it stopped, τ.
        time: f64,
        /// The message.
        reason: String,
    },
    /// The energy ran away.
    RanAway {
        /// Step at which that was seen.
        step: u64,
        /// Time, τ.
        time: f64,
        /// Change of energy by then, ε per atom.
        change: f64,
    },
}

/// A run and its numbers, which are missing where the run did not complete.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FluidRun {
    /// The method.
    pub method: &'static str,
    /// Name of the state point.
    pub state: &'static str,
    /// Name of the truncation.
    pub truncation: &'static str,
    /// The step, τ.
    pub dt: f64,
    /// Steps made.
    pub steps: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Slope of the energy, ε/τ per atom.
    pub drift: Option<f64>,
    /// Its standard error, from the slopes between blocks.
    pub drift_error: Option<f64>,
    /// RMS of the energy around that slope, ε per atom.
    pub fluctuation: Option<f64>,
    /// Energy at the end less the energy at the start, ε per atom.
    pub change: Option<f64>,
    /// Kinetic temperature less the configurational one Σ⟨F²⟩/⟨∇²U⟩, as a share of T*.
    pub temperature_error: Option<f64>,
    /// Its standard error.
    pub temperature_error_error: Option<f64>,
    /// Largest |Σ m·v| per atom.
    pub momentum: Option<f64>,
    /// Force evaluations per step, Hessian products counted as two.
    pub evaluations_per_step: f64,
}

impl FluidRun {
    /// Whether it reached its end.
    #[must_use]
    pub fn completed(&self) -> bool {
        self.outcome == Outcome::Completed
    }
}

/// What to run.
#[derive(Clone, Copy)]
pub(crate) struct Plan<'a> {
    pub(crate) entry: &'static IntegratorEntry,
    pub(crate) start: &'a FluidStart,
    pub(crate) dt: f64,
    pub(crate) steps: u64,
    pub(crate) precision: Precision,
}

/// A sample of a running system.
struct Sample {
    time: f64,
    energy: f64,
    temperature: f64,
    force_squared: f64,
    laplacian: f64,
}

impl Sample {
    /// A look at the system; `None` where no energies were asked for.
    fn of(rig: &Rig) -> Option<Self> {
        let Rig { system, state, .. } = rig;
        let potential = state.energetics.conserved_potential?;
        Some(Self {
            time: state.time,
            energy: (potential + system.kinetic_energy(&state.velocities)) / ATOMS as f64,
            temperature: system.temperature(&state.velocities, Momentum::Conserved),
            force_squared: state.forces.iter().map(|f| f.length_squared()).sum(),
            laplacian: state.energetics.laplacian?,
        })
    }
}

/// Runs the plan to its end or to its failure; only a fluid that cannot even be started is an error.
pub(crate) fn run(plan: &Plan<'_>) -> Result<FluidRun, StudyError> {
    let options = plan.entry.default_options.clone();
    let mut result = FluidRun {
        method: plan.entry.spec.name,
        state: STATES[plan.start.state_point].name,
        truncation: TRUNCATIONS[plan.start.truncation].1,
        dt: plan.dt,
        ..FluidRun::default()
    };
    let looking = Want { energy: true, laplacian: true, ..Want::NOTHING };
    let every = ((SAMPLE_INTERVAL / plan.dt).round() as u64).max(1);
    let stopped = |step: u64, time: f64, reason: StepError| Outcome::Stopped {
        step,
        time,
        reason: reason.to_string(),
    };
    let mut rig = match plan.start.rig(&options, plan.dt, plan.precision, looking) {
        Ok(rig) => rig,
        Err(StudyError::Step { source, .. }) => {
            result.outcome = stopped(0, 0.0, source);
            return Ok(result);
        }
        Err(error) => return Err(error),
    };
    let mut samples: Vec<Sample> = Sample::of(&rig).into_iter().collect();
    let limit = RUN_AWAY * 1.5 * STATES[plan.start.state_point].temperature;
    let mut momentum = 0.0_f64;
    for n in 1..=plan.steps {
        let due = n % every == 0;
        rig.want = if due { looking } else { Want::NOTHING };
        if let Err(reason) = rig.try_step() {
            result.outcome = stopped(n, n as f64 * plan.dt, reason);
            break;
        }
        result.steps = n;
        if !due {
            continue;
        }
        let Some(sample) = Sample::of(&rig) else { continue };
        let now = rig.system.momentum(&rig.state.velocities).length();
        momentum = momentum.max(now / ATOMS as f64);
        let change = sample.energy - samples[0].energy;
        // A NaN is as far away as an infinity.
        if change.abs() > limit || change.is_nan() {
            result.outcome = Outcome::RanAway { step: n, time: sample.time, change };
            break;
        }
        samples.push(sample);
    }
    result.evaluations_per_step =
        rig.forces.statistics().evaluations as f64 / result.steps.max(1) as f64;
    if result.completed() {
        result.momentum = Some(momentum);
        summarise(&mut result, &samples, plan);
    }
    Ok(result)
}

fn summarise(result: &mut FluidRun, samples: &[Sample], plan: &Plan<'_>) {
    let energies: Vec<(f64, f64)> = samples.iter().map(|s| (s.time, s.energy)).collect();
    let line = Line::through(&energies);
    let (offset, slope) = (line.intercept(), line.slope());
    let squares: f64 = energies.iter().map(|(t, e)| (e - offset - slope * t).powi(2)).sum();
    result.fluctuation = Some((squares / energies.len() as f64).sqrt());
    result.drift = Some(slope);
    result.change = Some(samples[samples.len() - 1].energy - samples[0].energy);
    let size = samples.len() / BLOCKS;
    if size < 2 {
        return;
    }
    let blocks = || samples.chunks_exact(size).take(BLOCKS);
    // The line through block means: what the blocks scatter around it says how well its slope is known.
    let means: Vec<(f64, f64)> = blocks()
        .map(|b| {
            let n = b.len() as f64;
            (b.iter().map(|s| s.time).sum::<f64>() / n, b.iter().map(|s| s.energy).sum::<f64>() / n)
        })
        .collect();
    result.drift_error = Some(Line::through(&means).error_of_slope());
    let differences: Vec<f64> = blocks()
        .map(|b| {
            let sum = |f: fn(&Sample) -> f64| b.iter().map(f).sum::<f64>();
            let kinetic = sum(|s| s.temperature) / b.len() as f64;
            let configurational = sum(|s| s.force_squared) / sum(|s| s.laplacian);
            (kinetic - configurational) / STATES[plan.start.state_point].temperature
        })
        .collect();
    let mean = differences.iter().sum::<f64>() / BLOCKS as f64;
    let variance: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>()
        / (BLOCKS as f64 * (BLOCKS as f64 - 1.0));
    result.temperature_error = Some(mean);
    result.temperature_error_error = Some(variance.sqrt());
}
