//! What settings cost: wall time of the main loop, and force evaluations.

use std::time::Instant;

use lennard_core::random::Streams;
use lennard_core::{Configuration, ForceTerm, Part as ForcePart, Want};
use lennard_engine::{
    Action, EngineError, Follower, Operation, Schedule, Simulation, Trigger, Verdict,
};
use lennard_forcefield::ListMode;
use lennard_integrators::IntegratorOptions;
use lennard_scene::Scene;
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

use super::workbench::{Failed, Part, Workbench};
use super::{Settings, Start};
use crate::StudyError;
use crate::jobs::pool;

/// Seconds for one particle and one neighbor on an ordinary processor; only plans are made with it.
const SECONDS_PER_NEIGHBOR: f64 = 1.5e-9;
/// Seconds for one particle and step besides the forces, in such plans.
const SECONDS_PER_PARTICLE: f64 = 1.5e-8;
/// Evaluations a step of a method that iterates, in such plans.
const EVALUATIONS_OF_ITERATION: f64 = 25.0;
/// Steps before the clock starts: the first list is built, caches are warm.
const WARM_UP: u64 = 20;
/// Fewest and most steps that are timed.
const FEWEST_STEPS: u64 = 60;
const MOST_STEPS: u64 = 20_000;

/// One timing of the main loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Wall time for each particle and simulated τ, s.
    pub seconds_per_atom_tau: f64,
    /// Force evaluations for each simulated τ; near and far parts count as one each.
    pub evaluations_per_tau: f64,
    /// Steps timed.
    pub steps: u64,
}

/// Repeats of one timing whose range is above this share of their median were disturbed: the machine was busy.
pub const BUSY: f64 = 0.2;

/// Median and range of repeated timings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
    /// How many there are.
    pub repeats: usize,
}

impl Spread {
    /// Of these values; `None` where there is none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let [low, median, high] = lowest_median_highest(values)?;
        Some(Self {
            median,
            low,
            high,
            repeats: values.len(),
        })
    }

    /// The range over the median.
    #[must_use]
    pub fn scatter(&self) -> f64 {
        (self.high - self.low) / self.median
    }
}

/// The smallest of these values, the middle one (the mean of the two in the middle where their number is even) and
/// the largest; `None` where there is none.
pub(crate) fn lowest_median_highest(values: &[f64]) -> Option<[f64; 3]> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let (lowest, highest) = (*sorted.first()?, *sorted.last()?);
    Some([lowest, 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]), highest])
}

/// What settings cost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Wall time for each particle and simulated τ, s.
    pub wall: Spread,
    /// Force evaluations for each simulated τ.
    pub evaluations_per_tau: f64,
    /// Pair forces (each pair within the cutoff once) for each particle and simulated τ: the evaluations weighted with
    /// how much each is.
    pub pair_forces_per_atom_tau: f64,
}

impl Cost {
    /// From repeated timings and the pair forces of a step; `None` where there is no timing.
    #[must_use]
    pub fn of(timings: &[Timing], pair_forces_per_atom_tau: f64) -> Option<Self> {
        let walls: Vec<f64> = timings.iter().map(|t| t.seconds_per_atom_tau).collect();
        Some(Self {
            wall: Spread::of(&walls)?,
            evaluations_per_tau: timings.first()?.evaluations_per_tau,
            pair_forces_per_atom_tau,
        })
    }
}

/// Seconds that a simulated τ of these settings takes by a simple model, on one thread of an ordinary processor: for
/// plans that must not depend on a clock.
#[must_use]
pub fn modelled_work(scene: &Scene, start: &Start, settings: &Settings) -> f64 {
    let n = start.len() as f64;
    let neighbors = match settings.list {
        ListMode::Direct => n - 1.0,
        ListMode::Auto | ListMode::Verlet => {
            let r_list = settings.truncation.r_cut + settings.skin.unwrap_or(0.3);
            4.0 / 3.0 * std::f64::consts::PI * start.density() * r_list.powi(3)
        }
    };
    let declared = f64::from(settings.integrator.spec().force_evaluations);
    let evaluations = match (&settings.integrator, settings.split) {
        (IntegratorOptions::Respa(o), Some(split)) => {
            let near = (split.r_split / settings.truncation.r_cut).powi(3).min(1.0);
            1.0 + f64::from(o.inner_steps) * near
        }
        _ if declared == 0.0 => EVALUATIONS_OF_ITERATION,
        _ => declared,
    };
    let ratio = scene.stage_dt(super::start::measured_stage(scene)) / scene.integrator.dt;
    n * evaluations * (neighbors.min(n) * SECONDS_PER_NEIGHBOR + SECONDS_PER_PARTICLE)
        / (settings.dt * ratio)
}

/// Starts the clock after the warm-up.
struct Stopwatch {
    schedule: Schedule,
    from: Option<(Instant, u64)>,
}

impl Follower for Stopwatch {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        if simulation.state.step == WARM_UP {
            let evaluations = simulation.forces.statistics().evaluations;
            self.from = Some((Instant::now(), evaluations));
        }
        Ok(Verdict::Continue)
    }
}

impl Workbench {
    /// Times the engine's main loop under these settings, from the start on, with the scene's heat bath and without
    /// observables or output, for about `seconds` by the model of [`modelled_work`].
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit or the run fails ([`Failed::from_error`] tells which).
    pub fn timing(&self, settings: &Settings, seconds: f64) -> Result<Timing, StudyError> {
        let dt = self.stage_dt(settings);
        let a_step = modelled_work(self.scene(), self.start(), settings) * dt;
        let steps = ((seconds / a_step) as u64).clamp(FEWEST_STEPS, MOST_STEPS);
        let part = Part {
            steps: WARM_UP + steps,
            measure: false,
            bath: true,
        };
        let mut simulation = self.simulation(settings, &[part], 1)?;
        let mut watch = Stopwatch {
            schedule: Schedule::empty().with(Operation::new(Action::Call, Trigger::At(WARM_UP))),
            from: None,
        };
        simulation.run(&mut watch)?;
        let (from, before) = watch.from.expect("the run is longer than its warm-up");
        let elapsed = from.elapsed().as_secs_f64();
        let evaluations = simulation.forces.statistics().evaluations - before;
        let time = steps as f64 * dt;
        Ok(Timing {
            seconds_per_atom_tau: elapsed / (self.start().len() as f64 * time),
            evaluations_per_tau: evaluations as f64 / time,
            steps,
        })
    }

    /// Pair forces (each pair once) for each particle and simulated τ, where a τ takes so many evaluations. The pairs
    /// are those of the start.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit.
    pub fn pair_forces(
        &self,
        settings: &Settings,
        evaluations_per_tau: f64,
    ) -> Result<f64, StudyError> {
        let mut provider = self.forces(settings)?;
        let mut pairs = |part: ForcePart| -> Result<f64, StudyError> {
            let mut out = vec![glam::DVec3::ZERO; self.start().len()];
            let at = Configuration::at_rest(&self.start().cell, &self.start().positions);
            let found = provider
                .evaluate(at, part, Want::ENERGY, &mut out)
                .map_err(|source| StudyError::Force {
                    label: settings.label(),
                    source,
                })?;
            Ok(found.pairs.unwrap_or_default() as f64 / self.start().len() as f64)
        };
        let all = pairs(ForcePart::All)?;
        let IntegratorOptions::Respa(options) = &settings.integrator else {
            return Ok(all * evaluations_per_tau);
        };
        let inner = f64::from(options.inner_steps);
        let near = pairs(ForcePart::Near)?;
        Ok(evaluations_per_tau * (all + inner * near) / (1.0 + inner))
    }
}

/// Times every one of these settings on so many threads `repeats` times, one after the other, each round in another
/// order, `seconds` each by the model; the shuffling is that of `seed`.
///
/// # Errors
/// [`StudyError`] where settings do not fit or threads cannot be started; a run that fails is a result.
pub fn costs(
    bench: &Workbench,
    settings: &[Settings],
    threads: usize,
    repeats: usize,
    seconds: f64,
    seed: u64,
) -> Result<Vec<Result<Cost, Failed>>, StudyError> {
    let pool = pool(threads)?;
    let mut timings: Vec<Result<Vec<Timing>, Failed>> = vec![Ok(Vec::new()); settings.len()];
    for round in 0..repeats {
        for i in shuffled(settings.len(), seed, round) {
            let Ok(so_far) = &mut timings[i] else {
                continue;
            };
            match pool.install(|| bench.timing(&settings[i], seconds)) {
                Ok(timing) => so_far.push(timing),
                Err(error) => timings[i] = Err(Failed::from_error(error)?),
            }
        }
    }
    let mut found = Vec::new();
    for (settings, timings) in settings.iter().zip(timings) {
        found.push(match timings {
            Err(failed) => Err(failed),
            Ok(timings) => {
                let evaluations = timings.first().map_or(f64::NAN, |t| t.evaluations_per_tau);
                let pairs = bench.pair_forces(settings, evaluations)?;
                Cost::of(&timings, pairs).ok_or_else(|| Failed {
                    reason: "it was not timed".into(),
                    step: None,
                })
            }
        });
    }
    Ok(found)
}

/// The numbers from 0 to n − 1 in an order that seed and round decide.
pub(crate) fn shuffled(n: usize, seed: u64, round: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut random = Streams::new(seed).sequential(&format!("order-{round}"));
    order.shuffle(&mut random);
    order
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;

    #[test]
    fn the_median_lies_in_the_middle_and_the_order_is_shuffled() {
        let spread = Spread::of(&[3.0, 1.0, 2.0, 10.0]).unwrap();
        assert_eq!((spread.low, spread.median, spread.high), (1.0, 2.5, 10.0));
        assert!(Spread::of(&[]).is_none());
        let (a, b) = (shuffled(50, 1, 0), shuffled(50, 1, 1));
        assert_ne!(a, b);
        assert_eq!(a, shuffled(50, 1, 0));
        let mut sorted = b;
        sorted.sort_unstable();
        assert_eq!(sorted, (0..50).collect::<Vec<_>>());
    }

    #[test]
    fn evaluations_are_those_that_a_method_declares() {
        let scene = scene(&[("stage.equilibrate.steps", "50")]);
        let bench = Workbench::new(&scene).unwrap();
        let base = Settings::of(&scene);
        let run = |s: &Settings| bench.timing(s, 1e-6).unwrap();
        let verlet = run(&base);
        assert!((verlet.evaluations_per_tau - 250.0).abs() < 1e-6);
        assert!(verlet.seconds_per_atom_tau > 0.0);
        let respa = base.with_integrator(IntegratorOptions::Respa(Default::default()));
        assert!((run(&respa).evaluations_per_tau - 1250.0).abs() < 1e-6);
        // ρ = 0.8442: (2π/3)·ρ·2.5³ = 27.6 pairs an atom; the near force sees fewer.
        let all = bench.pair_forces(&base, 1.0).unwrap();
        assert!((25.0..30.0).contains(&all), "{all}");
        let split = bench.pair_forces(&respa, 5.0).unwrap();
        assert!(all < split && split < 3.5 * all, "{split}");
        let blown = Settings { dt: 0.1, ..base };
        let failed = costs(&bench, &[blown], 1, 1, 1e-6, 1).unwrap();
        assert!(
            failed[0]
                .as_ref()
                .unwrap_err()
                .reason
                .contains("failed at step")
        );
    }
}
