//! Runs under chosen baths: what a run samples of the volume, and what density and variance of V should be.

use std::ops::ControlFlow;

use lennard_core::{Estimate, Want};
use lennard_engine::{
    Action, EngineError, Follower, Operation, Schedule, Simulation, Trigger, measured_stage,
};
use lennard_integrators::dof_of_centers;
use lennard_observables::statistics;
use lennard_scene::{Scene, model_kind};

use super::types::{ChartedPoint, Ensemble, Reference, Sampled};
use crate::StudyError;
use crate::lab::{Drift, ShortStage, Workbench};
use crate::settings::Settings;

/// Time between two looks at the volume, τ.
const SAMPLE_INTERVAL: f64 = 0.04;
/// Each choice gets used to itself for this share of its time before it is sampled.
const SETTLING_SHARE: f64 = 0.1;

/// Runs a choice of baths for `time` τ after a while of settling. Choices are independent runs: `number` shifts the seed.
pub(super) fn sample(
    bench: &Workbench,
    settings: &Settings,
    number: usize,
    time: f64,
) -> Result<Sampled, StudyError> {
    let dt = bench.stage_dt(settings);
    let steps = |time: f64| (time / dt).ceil().max(1.0) as u64;
    let every = steps(SAMPLE_INTERVAL);
    let (settling, sampled) = (steps(SETTLING_SHARE * time), steps(time));
    let stages = [
        ShortStage { steps: settling, measure: false },
        ShortStage { steps: sampled, measure: true },
    ];
    let bench = bench.with_seed(3000 + number as u64);
    let mut simulation = bench.simulation(settings, &stages, every)?;
    let mut volumes = Volumes::new(every, settling);
    simulation.run(&mut volumes)?;
    let volumes = volumes.found;
    let units = simulation.system.n_molecules() as f64;
    let densities: Vec<f64> = volumes.iter().map(|v| units / v).collect();
    let missing = missing_freedom(&simulation);
    let stage = measured_stage(&simulation.scene);
    let held = stage.barostat.as_ref().map_or(f64::NAN, |c| c.pressure);
    let thermodynamics = simulation.thermodynamics();
    let rows = thermodynamics.series();
    let value = |series: &[f64]| statistics::estimate_stationary(series);
    let (pressure, density) = (value(&rows.pressure), value(&densities));
    let conservation = thermodynamics.conservation();
    let moves = simulation.stage.as_ref().and_then(|s| s.integrator.box_moves());
    Ok(Sampled {
        time: sampled as f64 * dt,
        temperature: value(&rows.temperature_of_positions),
        pressure,
        pressure_off: Estimate {
            mean: pressure.mean - held - missing * density.mean * stage.temperature,
            ..pressure
        },
        density,
        volume: value(&volumes),
        variance: variance(&volumes),
        drift: Drift {
            slope: conservation.energy_drift_per_atom_per_tau,
            standard_error: conservation.energy_drift_standard_error,
        },
        acceptance: moves.filter(|m| m.tried > 0).map(|m| m.acceptance()),
    })
}

/// Follows a run and keeps its volume after a step from which on it counts.
struct Volumes {
    every: u64,
    from: u64,
    schedule: Schedule,
    /// σ³.
    found: Vec<f64>,
}

impl Volumes {
    /// Looks every so many steps, after the first `from`.
    fn new(every: u64, from: u64) -> Self {
        let look = Operation::new(Action::Call, Trigger::Every(every)).wanting(Want::NOTHING);
        Self { every, from, schedule: Schedule::empty().with(look), found: Vec::new() }
    }
}

impl Follower for Volumes {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let step = simulation.state.step;
        if step.is_multiple_of(self.every) && step > self.from {
            self.found.push(simulation.state.cell.volume());
        }
        Ok(ControlFlow::Continue(()))
    }
}

/// The variance of a correlated series with its standard error: the mean square about the mean, over 1 − 1/n for n independent
/// samples.
fn variance(series: &[f64]) -> Estimate {
    let mean = statistics::estimate_stationary(series);
    let squares: Vec<f64> = series.iter().map(|x| (x - mean.mean).powi(2)).collect();
    let found = statistics::estimate_stationary(&squares);
    let n = mean.n_effective.max(2.0);
    let unbiased = n / (n - 1.0);
    Estimate::new(unbiased * found.mean, unbiased * found.standard_error, found.n_effective)
}

/// The ensemble of the scene of a workbench, with the reference that its finished points are compared with.
pub(super) fn ensemble(bench: &Workbench, points: &[ChartedPoint]) -> Result<Ensemble, StudyError> {
    let scene = bench.scene();
    let stage = measured_stage(scene);
    let (temperature, pressure) =
        (stage.temperature, stage.barostat.as_ref().map_or(f64::NAN, |c| c.pressure));
    let simulation = bench.start().simulation(scene.clone())?;
    let units = simulation.system.n_molecules() as f64;
    let missing = missing_freedom(&simulation);
    let reference = reference(scene, units, missing, temperature, pressure, points);
    Ok(Ensemble { temperature, pressure, reference })
}

/// 1 − n_dof/3N of the centres of mass: by how much of ρT the mean pressure is above P₀.
fn missing_freedom(simulation: &Simulation) -> f64 {
    let n = simulation.system.n_molecules() as f64;
    let n_dof = dof_of_centers(&simulation.system, simulation.view().n_dof());
    1.0 - n_dof / (3.0 * n)
}

/// The reference of a scene with `units` molecules or particles. `missing` is 1 − n_dof/3N.
///
/// The equation of state gives ρ at P₀ + missing·ρT, and var V = T·V·κ_T. Without an equation that covers the state, both are the
/// means of all runs, weighted by their independent samples.
fn reference(
    scene: &Scene,
    units: f64,
    missing: f64,
    temperature: f64,
    pressure: f64,
    points: &[ChartedPoint],
) -> Option<Reference> {
    let of_runs = |why: &str| {
        let all: Vec<_> = points.iter().filter_map(ChartedPoint::sampled).collect();
        let density = together(all.iter().map(|s| s.density))?;
        let variance = together(all.iter().map(|s| s.variance))?;
        Some(Reference {
            density: density.0,
            density_error: Some(density.1),
            variance: variance.0,
            variance_error: Some(variance.1),
            source: format!("the mean of all runs here: {why}"),
        })
    };
    let equation = match lennard_literature::equation_of_state_for(model_kind(scene)) {
        Ok(equation) => equation,
        Err(none) => return of_runs(&none.to_string()),
    };
    let Some(first) = equation.density(pressure, temperature) else {
        return of_runs("the equation of state covers no such state");
    };
    let shifted = pressure + missing * first * temperature;
    let density = equation.density(shifted, temperature).unwrap_or(first);
    if !equation.phase(density, temperature).is_stable() {
        return of_runs("the equation of state calls this state unstable");
    }
    let state = equation.at(density, temperature);
    let compressibility = 1.0 / (density * state.dp_drho);
    Some(Reference {
        density,
        density_error: None,
        variance: temperature * (units / density) * compressibility,
        variance_error: None,
        source: equation.spec().name.clone(),
    })
}

/// The mean of values, each as heavy as its number of independent samples, with its standard error. The errors themselves are no good
/// weights: a variance that came out small by chance has a small error too.
fn together(values: impl Iterator<Item = Estimate>) -> Option<(f64, f64)> {
    let (mut weights, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for value in values.filter(|v| v.standard_error.is_finite() && v.n_effective > 0.0) {
        let weight = value.n_effective;
        weights += weight;
        sum += weight * value.mean;
        squares += (weight * value.standard_error).powi(2);
    }
    (weights > 0.0).then(|| (sum / weights, squares.sqrt() / weights))
}

#[cfg(test)]
mod tests {
    use lennard_core::random::Streams;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn the_mean_of_runs_trusts_the_long_ones() {
        let value = Estimate::new;
        let (mean, error) =
            together([value(1.0, 1.0, 10.0), value(2.0, 0.5, 40.0)].into_iter()).unwrap();
        assert!((mean - 1.8).abs() < 1e-12 && (error - 500.0_f64.sqrt() / 50.0).abs() < 1e-12);
        assert!(together([value(1.0, f64::NAN, 10.0)].into_iter()).is_none());
    }

    #[test]
    fn the_variance_of_a_correlated_series_is_within_its_error() {
        // xᵢ = 0.9·xᵢ₋₁ + noise: a variance of 1/(1 − 0.81), and some 19 samples for each independent one.
        let noise = Streams::new(8).noise("series");
        let mut x = 0.0;
        let series: Vec<f64> = (0..40_000)
            .map(|i| {
                let random: f64 = StandardNormal.sample(&mut noise.at(i, 0));
                x = 0.9 * x + random;
                x
            })
            .collect();
        let found = variance(&series);
        let exact = 1.0 / (1.0 - 0.81);
        assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?}");
        // √(2/n) for n ≈ 40000·(1 − 0.81)/(1 + 0.81) squares.
        assert!((0.01..0.06).contains(&(found.standard_error / exact)), "{found:?}");
        // The bias of a short series is taken out: without it the mean would be 1 − 19/200 of the truth.
        let parts: Vec<f64> = series.chunks(200).map(|part| variance(part).mean).collect();
        let mean = statistics::mean(&parts);
        assert!((mean / exact - 1.0).abs() < 0.05, "{mean}");
    }
}
