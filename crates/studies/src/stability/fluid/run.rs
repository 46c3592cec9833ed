//! One run of the fluid at constant energy, and what it says about the method.

use lennard_core::{Momentum, StepError, Want};
use lennard_forcefield::{Precision, TruncationKind};
use lennard_observables::Estimate;
use lennard_observables::statistics::{mean, variance};
use lennard_scene::Scene;

use crate::StudyError;
use crate::lab::{Rig, Start, drift_of};
use crate::report::significant;

/// The truncation that stands for all where only one can be shown. Its energy and force are continuous,
/// so that every error is an error of the method.
pub(super) const SHOWN: TruncationKind = TruncationKind::ForceShift;
/// Parts of the table of runs: below the limits, at small steps in each precision, and past the limits.
pub(super) const BELOW: &str = "below the limit";
pub(super) const SMALL: &str = "small steps";
pub(super) const PAST: &str = "past the limit";
/// Time between two looks at the energy, τ.
const SAMPLE_INTERVAL: f64 = 0.02;
/// Blocks for the errors of means and of the drift.
const BLOCKS: usize = 10;
/// A run has run away when its energy has changed by this many times the kinetic energy 3/2·T.
const RUN_AWAY: f64 = 10.0;

/// A run and its numbers, which are missing where the run did not complete.
#[derive(Debug, Clone, Default)]
pub(super) struct FluidRun {
    /// The method.
    pub(super) method: &'static str,
    /// T* of the start, ε/k_B.
    pub(super) temperature: f64,
    /// Name of the truncation.
    pub(super) truncation: &'static str,
    /// What it is run for, and its step over the limit of its method where it is run past it.
    pub(super) part: &'static str,
    pub(super) past: Option<f64>,
    /// Precision of the pair terms.
    pub(super) precision: Precision,
    /// The step, τ.
    pub(super) dt: f64,
    /// Steps made.
    pub(super) steps: u64,
    /// Why it did not reach its end: method or forces refused to go on, or the energy ran away.
    pub(super) failure: Option<String>,
    /// Slope of the energy, ε/τ per atom.
    pub(super) drift: Option<Estimate>,
    /// RMS of the energy around that slope, ε per atom.
    pub(super) fluctuation: Option<f64>,
    /// Energy at the end less the energy at the start, ε per atom; of a run that ran away too.
    pub(super) change: Option<f64>,
    /// Kinetic temperature less the configurational one Σ⟨F²⟩/⟨∇²U⟩, as a share of T*.
    pub(super) temperature_error: Option<Estimate>,
    /// Largest |Σ m·v| per atom.
    pub(super) momentum: Option<f64>,
    /// Force evaluations per step, Hessian products counted as two.
    pub(super) evaluations_per_step: f64,
}

/// What to run.
#[derive(Clone, Copy)]
pub(super) struct Plan<'a> {
    pub(super) part: &'static str,
    pub(super) past: Option<f64>,
    /// The scene of a point: its method, the split of its forces, their precision.
    pub(super) scene: &'a Scene,
    pub(super) start: &'a Start,
    pub(super) dt: f64,
    pub(super) steps: u64,
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
        let n = state.velocities.len() as f64;
        Some(Self {
            time: state.time,
            energy: (potential + system.kinetic_energy(&state.velocities)) / n,
            temperature: system.temperature(&state.velocities, Momentum::Conserved),
            force_squared: state.forces.iter().map(|f| f.length_squared()).sum(),
            laplacian: state.energetics.laplacian?,
        })
    }
}

/// Runs the plan to its end or to its failure; only a fluid that cannot even be started is an error.
pub(super) fn run(plan: &Plan<'_>) -> Result<FluidRun, StudyError> {
    let Plan { part, past, scene, start, dt, steps } = *plan;
    let temperature = scene.system.temperature;
    let mut result = FluidRun {
        part,
        past,
        method: scene.integrator.method.name(),
        temperature,
        truncation: scene.truncation.kind.spec().name,
        precision: scene.kernel.precision,
        dt,
        ..FluidRun::default()
    };
    let looking = Want { energy: true, laplacian: true, ..Want::NOTHING };
    let every = ((SAMPLE_INTERVAL / dt).round() as u64).max(1);
    let stopped = |step: u64, reason: StepError| {
        let time = significant(step as f64 * dt, 3);
        Some(format!("stopped at step {step} (t = {time}): {reason}"))
    };
    let mut scene = scene.clone();
    scene.integrator.dt = dt;
    let forces = Box::new(start.forces(&scene)?);
    let method = lennard_integrators::build(&scene.integrator.method);
    let mut rig = match Rig::start(method, (start.system(), start.state()), forces, dt, looking) {
        Err(StudyError::Step { source, .. }) => {
            result.failure = stopped(0, source);
            return Ok(result);
        }
        rig => rig?,
    };
    let mut samples: Vec<Sample> = Sample::of(&rig).into_iter().collect();
    let mut momentum = 0.0_f64;
    for n in 1..=steps {
        let due = n % every == 0;
        rig.want = if due { looking } else { Want::NOTHING };
        if let Err(reason) = rig.try_step() {
            result.failure = stopped(n, reason);
            break;
        }
        result.steps = n;
        let Some(sample) = due.then(|| Sample::of(&rig)).flatten() else { continue };
        let now = rig.system.momentum(&rig.state.velocities).length();
        momentum = momentum.max(now / start.len() as f64);
        let change = sample.energy - samples[0].energy;
        // A NaN is as far away as an infinity.
        if change.abs() > RUN_AWAY * 1.5 * temperature || change.is_nan() {
            let [change, time] = [(change, 2), (sample.time, 3)].map(|(x, n)| significant(x, n));
            result.change = Some(sample.energy - samples[0].energy);
            result.failure =
                Some(format!("ran away: {change} ε per atom by step {n} (t = {time})"));
            break;
        }
        samples.push(sample);
    }
    result.evaluations_per_step =
        rig.forces.statistics().evaluations as f64 / result.steps.max(1) as f64;
    if result.failure.is_none() {
        result.momentum = Some(momentum);
        result.summarise(&samples);
    }
    Ok(result)
}

impl FluidRun {
    fn summarise(&mut self, samples: &[Sample]) {
        let energies: Vec<(f64, f64)> = samples.iter().map(|s| (s.time, s.energy)).collect();
        let (drift, fluctuation) = drift_of(&energies);
        (self.drift, self.fluctuation) = (Some(drift), Some(fluctuation));
        self.change = Some(samples[samples.len() - 1].energy - samples[0].energy);
        let size = samples.len() / BLOCKS;
        if size < 2 {
            return;
        }
        let sum = |block: &[Sample], of: fn(&Sample) -> f64| block.iter().map(of).sum::<f64>();
        let difference = |block: &[Sample]| {
            let configurational = sum(block, |s| s.force_squared) / sum(block, |s| s.laplacian);
            let kinetic = sum(block, |s| s.temperature) / block.len() as f64;
            (kinetic - configurational) / self.temperature
        };
        let blocks = samples.chunks_exact(size).take(BLOCKS);
        let differences: Vec<f64> = blocks.map(difference).collect();
        let n = BLOCKS as f64;
        let error = (variance(&differences) / (n - 1.0)).sqrt();
        self.temperature_error = Some(Estimate::new(mean(&differences), error, n));
    }
}
