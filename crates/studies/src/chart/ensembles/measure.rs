//! Running the choices: samples side by side, then costs one after the other.

use std::sync::Mutex;
use std::sync::atomic::Ordering;

use lennard_core::Want;
use lennard_core::stopwatch::{in_turn, shuffled, timed};
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
use crate::chart::{ChartError, ChartOptions, Outcome, Plan, Size};
use crate::jobs::{pool, side_by_side_on};
use crate::lab::{Drift, Failed, Start, Value, modelled_work};
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
    let own = Baths {
        thermostat: thermostat.clone(),
        barostat: control.options.clone(),
    };
    let pressure = control.pressure;
    let store = Store::open(options.folder, scene, options.anew)?;
    progress.update("equilibrating", 0.0);
    let start = Start::equilibrate(scene)?;
    let Grid { all, left_out } = grid(scene, &own, options.size);
    let plan = plan(scene, &start, &all, options);
    store.begin(scene, &plan)?;
    let points: Vec<Mutex<EnsemblePoint>> = (all.into_iter().enumerate())
        .map(|(i, baths)| EnsemblePoint::new(i + 1, baths))
        .map(|fresh| Mutex::new(store.load(&fresh).unwrap_or(fresh)))
        .collect();

    let waiting: Vec<usize> = shuffled(points.len(), scene.system.seed, usize::MAX)
        .into_iter()
        .filter(|i| get(&points[*i]).sampled.is_none())
        .collect();
    let sampled: Vec<Result<(), ChartError>> = side_by_side_on(
        options.workers,
        &waiting,
        |i| {
            if options.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let mut point = get(&points[*i]);
            point.sampled = Some(outcome(sample(scene, &start, &point, plan.time))?);
            store.save(&point)?;
            *slot(&points[*i]) = point;
            Ok(())
        },
        |share| progress.update("sampling", SAMPLES_SHARE * share),
    );
    sampled.into_iter().collect::<Result<Vec<()>, _>>()?;
    time_all(scene, &start, &points, &plan, &store, options, progress)?;

    let points: Vec<EnsemblePoint> = points.iter().map(get).collect();
    let finished = points
        .iter()
        .all(|p| p.sampled.is_some() && p.is_timed(plan.repeats));
    let temperature = measured_stage(scene).temperature;
    let simulation = start.simulation(scene.clone()).map_err(engine)?;
    let units = simulation.system.n_molecules() as f64;
    let missing = missing_freedom(&simulation);
    if finished {
        progress.update("done", 1.0);
    }
    Ok(EnsembleChart {
        schema: SCHEMA,
        scene: scene.name.clone(),
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

fn slot(point: &Mutex<EnsemblePoint>) -> std::sync::MutexGuard<'_, EnsemblePoint> {
    point
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn get(point: &Mutex<EnsemblePoint>) -> EnsemblePoint {
    slot(point).clone()
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
    // Longer than the run that the scene plans would tell more than is asked.
    let measured = scene.stages.iter().filter(|s| s.measure);
    let planned: f64 = measured.map(|s| s.steps as f64 * scene.stage_dt(s)).sum();
    let time = seconds / (a_tau * all.len() as f64);
    let time = time.clamp(SHORTEST, LONGEST.min(planned).max(SHORTEST));
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
    scene.stages = vec![
        stage("settle", settling, false),
        stage("sample", steps, true),
    ];
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
    let moves = simulation
        .stage
        .as_ref()
        .and_then(|s| s.integrator.box_moves());
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

/// A run that failed is a result.
fn outcome<T>(result: Result<T, StudyError>) -> Result<Outcome<T>, StudyError> {
    match result {
        Ok(found) => Ok(Outcome::Found(found)),
        Err(error) => Ok(Outcome::Failed(Failed::from_error(error)?)),
    }
}

/// Times what is not timed often enough, one after the other, each round in another order.
fn time_all(
    scene: &Scene,
    start: &Start,
    points: &[Mutex<EnsemblePoint>],
    plan: &Plan,
    store: &Store,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<(), ChartError> {
    let pool = pool(plan.threads)?;
    let dt = scene.stage_dt(measured_stage(scene));
    let per_step = modelled_work(scene, start, &Settings::of(scene)) * dt;
    let wanted = (plan.timing_seconds / per_step) as u64;
    in_turn(points.len(), plan.repeats, scene.system.seed, |turn| {
        let mut point = get(&points[turn.item]);
        if options.stop.load(Ordering::Relaxed) || point.is_timed(turn.round + 1) {
            return Ok(());
        }
        // The cost of a change of the box is spread over whole intervals.
        let interval = point.baths.barostat.interval().max(1);
        let steps = wanted.max(FEWEST_STEPS).div_ceil(interval) * interval;
        let warm_up = WARM_UP.div_ceil(interval) * interval;
        let timing = || -> Result<f64, StudyError> {
            let staged = staged(scene, &point.baths, warm_up + steps, 1, 1);
            let mut simulation = start.simulation(staged)?;
            take(&mut simulation, warm_up, Want::NOTHING)?;
            let (seconds, taken) = timed(|| take(&mut simulation, steps, Want::NOTHING));
            taken?;
            Ok(seconds / (start.len() as f64 * steps as f64))
        };
        match outcome(pool.install(timing))? {
            Outcome::Found(seconds) => point.timings.push(seconds),
            Outcome::Failed(failed) => point.not_timed = Some(failed.reason),
        }
        store.save(&point)?;
        *slot(&points[turn.item]) = point;
        progress.update("timing", SAMPLES_SHARE + (1.0 - SAMPLES_SHARE) * turn.done);
        Ok(())
    })
}
