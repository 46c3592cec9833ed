//! Running the choices: samples side by side, then costs one after the other.

use lennard_core::Want;
use lennard_core::stopwatch::timed;
use lennard_engine::{measured_stage, take};
use lennard_integrators::dof_of_centers;
use lennard_observables::statistics;
use lennard_scene::{Scene, Stage};

use super::found::{EnsembleChart, SCHEMA};
use super::grid::{Grid, grid, pressure_of, with_baths};
use super::point::{Baths, EnsemblePoint, Sampled};
use super::reference::reference;
use super::series::{Volumes, variance};
use crate::chart::store::Store;
use crate::chart::workshop::Workshop;
use crate::chart::{ChartError, ChartOptions, Outcome, Plan, Size, bounded};
use crate::lab::{Drift, Start, Value, modelled_work};
use crate::settings::Settings;
use crate::{Progress, StudyError};

/// Time between two looks at the volume, τ.
const SAMPLE_INTERVAL: f64 = 0.04;
/// Each choice gets used to itself for this share of its time before it is sampled.
const SETTLING_SHARE: f64 = 0.1;
/// Shortest and longest time that is sampled, τ.
const SHORTEST: f64 = 10.0;
const LONGEST: f64 = 4000.0;
/// Seconds of one thread, by the model of costs, that all runs together may take.
const QUICK_SECONDS: f64 = 6.0;
const DEFAULT_SECONDS: f64 = 240.0;
const FULL_SECONDS: f64 = 2400.0;
/// Steps before the clock starts, and the fewest that are timed: whole intervals of every barostat.
const WARM_UP: u64 = 200;
const FEWEST_STEPS: u64 = 200;
/// Share of the work that is done when samples are taken, for the progress.
const SAMPLES_SHARE: f64 = 0.9;

/// Everything there is to measure, or as much as was done when it was stopped.
pub(super) fn all(
    scene: &Scene,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<EnsembleChart, ChartError> {
    let engine = |error| ChartError::Study(StudyError::Engine(error));
    let (control, thermostat) = pressure_of(scene).map_err(|e| engine(e.into()))?;
    let own = Baths { thermostat: thermostat.clone(), barostat: control.options.clone() };
    let pressure = control.pressure;
    let store = Store::open(options.folder, scene, options.anew)?;
    progress.update("equilibrating", 0.0);
    let start = Start::equilibrate(scene)?;
    let Grid { all, left_out } = grid(scene, &own, options.size);
    let plan = plan(scene, &start, &all, options);
    store.begin(scene, &plan)?;
    let fresh = all.into_iter().enumerate();
    let fresh = fresh.map(|(i, baths)| EnsemblePoint::new(i + 1, baths));
    let workshop = Workshop::new(fresh, scene, &store, options, &plan, SAMPLES_SHARE);
    workshop.measure("sampling", progress, |point| {
        point.sampled = Some(Outcome::of(sample(scene, &start, point, plan.time))?);
        Ok(())
    })?;
    let wanted = steps_timed(scene, &start, &plan);
    workshop.time(progress, |point| {
        match Outcome::of(timing(scene, &start, &point.baths, wanted))? {
            Outcome::Found(seconds) => point.timings.push(seconds),
            Outcome::Failed(failed) => point.not_timed = Some(failed),
        }
        Ok(())
    })?;

    let (points, finished) = workshop.close();
    let temperature = measured_stage(scene).temperature;
    let simulation = start.simulation(scene.clone()).map_err(engine)?;
    let units = simulation.system.n_molecules() as f64;
    let missing = missing_freedom(&simulation);
    if finished {
        progress.update("done", 1.0);
    }
    Ok(EnsembleChart {
        schema: SCHEMA,
        scene: scene.name.to_string(),
        atoms: start.len(),
        temperature,
        pressure,
        reference: reference(scene, units, missing, temperature, pressure, &points),
        plan,
        finished,
        points,
        left_out,
    })
}

/// 1 − n_dof/3N of the centres of mass: by how much of ρT the mean pressure is above P₀.
fn missing_freedom(simulation: &lennard_engine::Simulation) -> f64 {
    let n = simulation.system.n_molecules() as f64;
    let n_dof = dof_of_centers(&simulation.system, simulation.view().n_dof());
    1.0 - n_dof / (3.0 * n)
}

/// How long everything runs: a function of the scene and the choices, never of a clock.
fn plan(scene: &Scene, start: &Start, all: &[Baths], options: &ChartOptions<'_>) -> Plan {
    let a_tau = modelled_work(scene, start, &Settings::of(scene));
    let (seconds, repeats) = match options.size {
        Size::Quick => (QUICK_SECONDS, 3),
        Size::Default => (DEFAULT_SECONDS, 5),
        Size::Full => (FULL_SECONDS, 5),
    };
    let time = seconds / (a_tau * all.len() as f64);
    let time = bounded(scene, time, SHORTEST, LONGEST);
    Plan {
        size: options.size,
        points: all.len(),
        time,
        tight_time: time,
        short_time: 0.0,
        repeats,
        timing_seconds: 0.05,
        threads: options.threads,
        cpu: lennard_io::cpu_name(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// The scene with these baths, in two stages of so many steps; the second is measured.
fn staged(scene: &Scene, baths: &Baths, settling: u64, steps: u64, every: u64) -> Scene {
    let mut scene = with_baths(scene, baths);
    let measured = measured_stage(&scene).clone();
    scene.observables.clear();
    scene.output.thermo_every = every;
    scene.output.trajectory_every = None;
    let stage = |name: &str, steps: u64, measure: bool| Stage {
        name: name.into(),
        steps,
        measure,
        ..measured.clone()
    };
    scene.stages = vec![stage("settle", settling, false), stage("sample", steps, true)];
    scene
}

fn sample(
    scene: &Scene,
    start: &Start,
    point: &EnsemblePoint,
    time: f64,
) -> Result<Sampled, StudyError> {
    let dt = scene.stage_dt(measured_stage(scene));
    let steps = |time: f64| (time / dt).ceil().max(1.0) as u64;
    let every = steps(SAMPLE_INTERVAL);
    let (settling, sampled) = (steps(SETTLING_SHARE * time), steps(time));
    let mut staged = staged(scene, &point.baths, settling, sampled, every);
    // Choices are independent runs.
    staged.system.seed = staged.system.seed.wrapping_add(3000 + point.number as u64);
    let mut simulation = start.simulation(staged)?;
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
    let value = |series: &[f64]| Value::from(statistics::estimate_stationary(series));
    let (pressure, density) = (value(&rows.pressure), value(&densities));
    let conservation = thermodynamics.conservation();
    let moves = simulation.stage.as_ref().and_then(|s| s.integrator.box_moves());
    Ok(Sampled {
        time: sampled as f64 * dt,
        temperature: value(&rows.temperature_of_positions),
        pressure,
        pressure_off: Value {
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

/// Steps that take the wanted time by the model of costs.
fn steps_timed(scene: &Scene, start: &Start, plan: &Plan) -> u64 {
    let dt = scene.stage_dt(measured_stage(scene));
    let per_step = modelled_work(scene, start, &Settings::of(scene)) * dt;
    ((plan.timing_seconds / per_step) as u64).max(FEWEST_STEPS)
}

/// The wall time of `wanted` steps or a few more with these baths, s for each particle and step.
fn timing(scene: &Scene, start: &Start, baths: &Baths, wanted: u64) -> Result<f64, StudyError> {
    // The cost of a change of the box is spread over whole intervals.
    let interval = baths.barostat.interval().max(1);
    let steps = wanted.div_ceil(interval) * interval;
    let warm_up = WARM_UP.div_ceil(interval) * interval;
    let mut simulation = start.simulation(staged(scene, baths, warm_up + steps, 1, 1))?;
    take(&mut simulation, warm_up, Want::NOTHING)?;
    let (seconds, taken) = timed(|| take(&mut simulation, steps, Want::NOTHING));
    taken?;
    Ok(seconds / (start.len() as f64 * steps as f64))
}
