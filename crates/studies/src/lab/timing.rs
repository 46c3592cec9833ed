//! What settings cost: wall time of the main loop, and force evaluations.

use lennard_core::{Part, Want};
use lennard_engine::stopwatch::{Spread, in_turn, timed};
use lennard_engine::{measured_stage, take};
use lennard_forcefield::ListMode;
use lennard_integrators::IntegratorOptions;
use lennard_scene::Scene;
use serde::{Deserialize, Serialize};

use super::start::Start;
use super::workbench::{Failed, ShortStage, Workbench, failed_forces};
use crate::StudyError;
use crate::settings::Settings;
use lennard_core::parallel::pool;

/// Seconds for one particle and one neighbor on an ordinary processor; only plans are made with it.
const SECONDS_PER_NEIGHBOR: f64 = 1.5e-9;
/// Seconds for one particle and step besides the forces, in such plans.
const SECONDS_PER_PARTICLE: f64 = 1.5e-8;
/// Evaluations per step of a method that iterates, in such plans.
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

/// A [`Spread`] as JSON of a cost names its range.
#[derive(Serialize)]
#[serde(remote = "Spread")]
struct LowAndHigh {
    median: f64,
    #[serde(rename = "low")]
    lowest: f64,
    #[serde(rename = "high")]
    highest: f64,
    repeats: usize,
}

/// What settings cost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Wall time for each particle and simulated τ, s.
    #[serde(with = "LowAndHigh")]
    pub wall: Spread,
    /// Force evaluations for each simulated τ.
    pub evaluations_per_tau: f64,
    /// Pair forces (each pair within the cutoff once) for each particle and simulated τ: the evaluations weighted with
    /// how much each is.
    pub pair_forces_per_atom_tau: f64,
}

impl Cost {
    /// From repeated timings and the pair forces of a step; `None` where there is no timing.
    pub(crate) fn of(timings: &[Timing], pair_forces_per_atom_tau: f64) -> Option<Self> {
        Some(Self {
            wall: Spread::of(timings.iter().map(|t| t.seconds_per_atom_tau))?,
            evaluations_per_tau: timings.first()?.evaluations_per_tau,
            pair_forces_per_atom_tau,
        })
    }
}

/// Seconds that a simulated τ of these settings takes by a simple model, on one thread of an ordinary processor.
/// Plans that must not depend on a clock use it.
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
    let ratio = scene.stage_dt(measured_stage(scene)) / scene.integrator.dt;
    n * evaluations * (neighbors.min(n) * SECONDS_PER_NEIGHBOR + SECONDS_PER_PARTICLE)
        / (settings.dt * ratio)
}

impl Workbench {
    /// Times the engine's main loop under these settings, from the start on, with the scene's heat bath and without
    /// observables or output. The timing lasts about `seconds` by the model of [`modelled_work`].
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit or the run fails ([`Failed::or`] tells which).
    pub fn timing(&self, settings: &Settings, seconds: f64) -> Result<Timing, StudyError> {
        let dt = self.stage_dt(settings);
        let per_step = modelled_work(self.scene(), self.start(), settings) * dt;
        let steps = ((seconds / per_step) as u64).clamp(FEWEST_STEPS, MOST_STEPS);
        let stage = ShortStage { steps: WARM_UP + steps, measure: false };
        let mut simulation = self.simulation(settings, &[stage], 1)?;
        take(&mut simulation, WARM_UP, Want::NOTHING)?;
        let before = simulation.forces.statistics().evaluations;
        let (elapsed, taken) = timed(|| take(&mut simulation, steps, Want::NOTHING));
        taken?;
        let evaluations = simulation.forces.statistics().evaluations - before;
        let time = steps as f64 * dt;
        Ok(Timing {
            seconds_per_atom_tau: elapsed / (self.start().len() as f64 * time),
            evaluations_per_tau: evaluations as f64 / time,
            steps,
        })
    }

    /// Pair forces (each pair once) for each particle and simulated τ, where a τ takes `evaluations_per_tau`
    /// evaluations. The pairs are counted at the start.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit.
    pub(crate) fn pair_forces(
        &self,
        settings: &Settings,
        evaluations_per_tau: f64,
    ) -> Result<f64, StudyError> {
        let mut forces = self.forces(settings)?;
        let mut pairs = |part: Part| -> Result<f64, StudyError> {
            let found = self.start().evaluate(&mut forces, part, Want::ENERGY);
            let (energies, _) = found.map_err(|source| failed_forces(settings, source))?;
            Ok(energies.pairs.unwrap_or_default() as f64 / self.start().len() as f64)
        };
        let all = pairs(Part::All)?;
        let IntegratorOptions::Respa(options) = &settings.integrator else {
            return Ok(all * evaluations_per_tau);
        };
        let inner = f64::from(options.inner_steps);
        let near = pairs(Part::Near)?;
        Ok(evaluations_per_tau * (all + inner * near) / (1.0 + inner))
    }
}

/// Times each of these settings on `threads` threads `repeats` times, `seconds` each by the model; the settings take turns
/// in an order that `seed` shuffles.
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
    in_turn(settings.len(), repeats, seed, |turn| {
        let i = turn.item;
        if let Ok(so_far) = &mut timings[i] {
            match Failed::or(pool.install(|| bench.timing(&settings[i], seconds)))? {
                Ok(timing) => so_far.push(timing),
                Err(failed) => timings[i] = Err(failed),
            }
        }
        Ok::<(), StudyError>(())
    })?;
    let cost = |(settings, timings): (&Settings, Result<Vec<Timing>, Failed>)| {
        let timings = match timings {
            Ok(timings) => timings,
            Err(failed) => return Ok(Err(failed)),
        };
        let evaluations = timings.first().map_or(f64::NAN, |t| t.evaluations_per_tau);
        let pairs = bench.pair_forces(settings, evaluations)?;
        Ok(Cost::of(&timings, pairs)
            .ok_or_else(|| Failed { reason: "it was not timed".into(), step: None }))
    };
    settings.iter().zip(timings).map(cost).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::bench;

    #[test]
    fn evaluations_are_those_that_a_method_declares() {
        let (bench, base) = bench(&[("stage.equilibrate.steps", "50")]);
        let run = |s: &Settings| bench.timing(s, 1e-6).unwrap();
        let verlet = run(&base);
        assert!((verlet.evaluations_per_tau - 250.0).abs() < 1e-6);
        assert!(verlet.seconds_per_atom_tau > 0.0);
        let respa = base.with_integrator(IntegratorOptions::Respa(Default::default()));
        assert!((run(&respa).evaluations_per_tau - 1250.0).abs() < 1e-6);
        // ρ = 0.8442: (2π/3)·ρ·2.5³ = 27.6 pairs per atom; the near force sees fewer.
        let all = bench.pair_forces(&base, 1.0).unwrap();
        assert!((25.0..30.0).contains(&all), "{all}");
        let split = bench.pair_forces(&respa, 5.0).unwrap();
        assert!(all < split && split < 3.5 * all, "{split}");
        let blown = Settings { dt: 0.1, ..base };
        let failed = costs(&bench, &[blown], 1, 1, 1e-6, 1).unwrap();
        assert!(failed[0].as_ref().unwrap_err().reason.contains("failed at step"));
    }
}
