//! Running the points: errors side by side, then costs one after the other. Each is stored as soon as it is known.

use std::sync::atomic::Ordering;

use lennard_core::parallel::pool;
use lennard_engine::stopwatch::{in_turn, shuffled};
use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_scene::Scene;

use super::grid::{COMMON_STEPS, Grid, grid};
use super::store::Store;
use super::types::{Chart, ChartOptions, ChartedPoint, Errors, Lengths, Size, Tightest, cost_by};
use super::{panels, peers};
use crate::jobs::side_by_side_on;
use crate::lab::{self, Failed, Slopes, Workbench, modelled_work};
use crate::settings::{Settings, truncation_is_free};
use crate::sweep::Sweep;
use crate::{Progress, StudyError};

/// Name and version of the schema of [`Chart`].
const SCHEMA: &str = lennard_io::schema!("chart", 4);

/// Length of the trajectories that are compared, τ: before chaos takes over.
const SHORT_TIME: f64 = 0.25;
/// Shortest and longest runs, τ.
const LENGTHS: (f64, f64) = (2.0, 200.0);
/// The tightest run is that much longer: all others are compared with it.
const TIGHT_FACTOR: f64 = 2.0;
/// Share of all work that is done when every point is measured, for the progress.
const MEASURED_SHARE: f64 = 0.85;
/// Length of the runs of the whole grid of settings, τ.
const FULL_TIME: f64 = 20.0;

/// Everything there is to measure, or as much as was done when it was stopped.
pub(super) fn all(
    scene: &Scene,
    study: &Sweep,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Chart, StudyError> {
    let store = Store::open(options.folder, scene, options.anew)?;
    progress.update("equilibrating", 0.0);
    let bench = Workbench::new(scene)?;
    let mut grid = grid(&bench, study);
    let tightest = with_tightest(&mut grid, &bench)?;
    let plan = lengths(&bench, &grid, tightest, options);
    store.begin(scene, &plan)?;
    let tight = against_tightest(&bench, &grid, tightest, plan.time)?;

    let fresh = (1..).zip(&grid.settings);
    let fresh = fresh.map(|(number, settings)| ChartedPoint::new(number, settings.clone()));
    let known = fresh.map(|fresh| store.load(&fresh).unwrap_or(fresh));
    let mut points: Vec<ChartedPoint> = known.collect();
    let work = Work { bench: &bench, store: &store, options, plan: &plan };
    work.measure(&mut points, &tight, progress)?;
    work.time(&mut points, progress)?;
    let is_finished = |p: &ChartedPoint| p.is_measured() && p.is_timed(plan.repeats);
    let finished = points.iter().all(is_finished);

    let mut remarks = Vec::new();
    if options.with_peers && finished {
        progress.update("other engines", 0.99);
        match peers::of_lammps(&bench, &plan, &tight.slopes, &points) {
            Ok(found) => points.extend(found),
            Err(reason) => remarks.push(format!("LAMMPS is left out: {reason}")),
        }
    }
    let mut chart = Chart {
        schema: SCHEMA,
        scene: scene.name.to_string(),
        atoms: bench.start().len(),
        density: bench.start().density(),
        finished,
        against: tight,
        cost_by: cost_by(&points),
        points,
        left_out: grid.left_out,
        remarks,
        panels: Vec::new(),
        command: options.command.clone(),
        plan,
    };
    chart.panels = panels::panels(&bench, &chart)?;
    if finished {
        progress.update("done", 1.0);
    }
    Ok(chart)
}

/// The work on the points of a chart.
struct Work<'a> {
    bench: &'a Workbench,
    store: &'a Store,
    options: &'a ChartOptions<'a>,
    plan: &'a Lengths,
}

impl Work<'_> {
    /// Measures the errors of points that have none yet, side by side, in a shuffled order.
    fn measure(
        &self,
        points: &mut [ChartedPoint],
        tight: &Tightest,
        progress: &mut dyn Progress,
    ) -> Result<(), StudyError> {
        let order = shuffled(points.len(), self.seed(), usize::MAX).into_iter();
        let waiting: Vec<usize> = order.filter(|i| !points[*i].is_measured()).collect();
        let measured = side_by_side_on(
            self.options.workers,
            &waiting,
            |i| {
                let mut point = points[*i].clone();
                if !self.is_stopped() {
                    let is_tightest = *i == tight.tightest;
                    let time = if is_tightest { self.plan.tight_time } else { self.plan.time };
                    point.errors = Some(self.errors(&point.settings, time, &tight.slopes)?);
                    self.store.save(&point)?;
                }
                Ok(point)
            },
            |share| progress.update("measuring errors", MEASURED_SHARE * share),
        );
        let measured: Vec<ChartedPoint> =
            measured.into_iter().collect::<Result<_, StudyError>>()?;
        waiting.into_iter().zip(measured).for_each(|(i, point)| points[i] = point);
        Ok(())
    }

    /// All errors of some settings.
    fn errors(
        &self,
        settings: &Settings,
        time: f64,
        slopes: &Slopes,
    ) -> Result<Errors, StudyError> {
        let (bench, short_time) = (self.bench, self.plan.short_time);
        Ok(Errors {
            forces: bench.force_errors(settings)?,
            measured: Failed::or(bench.measure(settings, time, slopes))?,
            trajectory: Failed::or(bench.trajectory_error(settings, short_time))?,
            reversibility: Failed::or(bench.reversibility(settings, short_time))?,
        })
    }

    /// Times what is not timed often enough, one after the other, each round in another order.
    fn time(
        &self,
        points: &mut [ChartedPoint],
        progress: &mut dyn Progress,
    ) -> Result<(), StudyError> {
        let pool = pool(self.plan.threads)?;
        in_turn(points.len(), self.plan.repeats, self.seed(), |turn| {
            let point = &mut points[turn.item];
            if self.is_stopped() || point.is_timed(turn.round + 1) {
                return Ok(());
            }
            pool.install(|| self.one_timing(point))?;
            self.store.save(point)?;
            let left = 1.0 - MEASURED_SHARE;
            progress.update("timing", MEASURED_SHARE + left * turn.done);
            Ok(())
        })
    }

    fn one_timing(&self, point: &mut ChartedPoint) -> Result<(), StudyError> {
        let timing = self.bench.timing(&point.settings, self.plan.timing_seconds);
        match Failed::or(timing)? {
            Ok(timing) => {
                if point.pair_forces_per_atom_tau.is_none() {
                    let evaluations = timing.evaluations_per_tau;
                    point.pair_forces_per_atom_tau =
                        Some(self.bench.pair_forces(&point.settings, evaluations)?);
                }
                point.timings.push(timing);
            }
            Err(failed) => point.not_timed = Some(failed),
        }
        Ok(())
    }

    fn seed(&self) -> u64 {
        self.bench.scene().system.seed
    }

    fn is_stopped(&self) -> bool {
        self.options.stop.load(Ordering::Relaxed)
    }
}

/// What the errors of settings are measured against.
fn against_tightest(
    bench: &Workbench,
    grid: &Grid,
    tightest: usize,
    time: f64,
) -> Result<Tightest, StudyError> {
    let scene = bench.scene();
    let slopes = bench.slopes(&grid.settings[tightest], time)?;
    let untruncated = if truncation_is_free(scene) { Some(bench.untruncated()?) } else { None };
    let system = bench.start().system();
    Ok(Tightest {
        step_of_fastest: lab::rough_stable_dt(scene, system.species(), slopes.temperature, 1.0),
        slopes,
        reach: untruncated.map(|u| u.reach),
        left_out_of_forces: untruncated.map(|u| u.left_out),
        tightest,
    })
}

/// Adds the settings by which all others are judged, and gives their place.
fn with_tightest(grid: &mut Grid, bench: &Workbench) -> Result<usize, StudyError> {
    if grid.settings.len() < 2 {
        return Err(nothing_to_compare(grid));
    }
    let base = Settings::of(bench.scene());
    let widest = grid.settings.iter().map(|s| s.truncation.r_cut).fold(0.0, f64::max);
    let shortest = grid
        .settings
        .iter()
        .filter(|s| s.integrator == base.integrator)
        .map(|s| s.dt)
        .fold(base.dt, f64::min);
    let tight = Settings {
        dt: shortest,
        precision: Precision::Double,
        list: ListMode::Auto,
        skin: None,
        ..base.clone()
    };
    // The plain cutoff with its tail stands for the whole potential; a fluid with surfaces has no tail.
    let tails = grid.settings.iter().any(|s| s.truncation.tail_correction);
    let tight = if truncation_is_free(bench.scene()) {
        tight.with_truncation(TruncationKind::Cut, widest, tails)
    } else {
        tight
    };
    bench.check(&tight)?;
    if let Some(there) = grid.settings.iter().position(|s| *s == tight) {
        return Ok(there);
    }
    grid.settings.push(tight);
    Ok(grid.settings.len() - 1)
}

fn nothing_to_compare(grid: &Grid) -> StudyError {
    let why: String = grid.left_out.iter().map(|l| format!("\n  {}: {}", l.what, l.why)).collect();
    let found = grid.settings.len();
    StudyError::Settings {
        label: "there is nothing to compare".to_owned(),
        reason: format!("{found} of the settings around this scene can run{why}"),
    }
}

/// How long everything runs: a function of the scene and the grid, never of a clock.
fn lengths(bench: &Workbench, grid: &Grid, tightest: usize, options: &ChartOptions<'_>) -> Lengths {
    let scene = bench.scene();
    let work = |s: &Settings| modelled_work(scene, bench.start(), s);
    let a_tau: f64 = grid.settings.iter().map(work).sum();
    let quick = options.size == Size::Quick;
    // Seconds of one thread, by the model of costs, that all measuring runs of a chart together may take.
    let a_tau = a_tau + (TIGHT_FACTOR - 1.0) * work(&grid.settings[tightest]);
    let (time, timing_seconds) = match options.size {
        Size::Quick => (5.0 / a_tau, 0.02),
        Size::Default => (130.0 / a_tau, 0.03),
        Size::Full => (FULL_TIME, 0.03),
    };
    // No longer than the run that the scene plans: that would tell more than is asked.
    let (shortest, longest) = LENGTHS;
    let time = time.clamp(shortest, longest.min(scene.measured_time()).max(shortest));
    let unit = COMMON_STEPS * scene.integrator.dt;
    Lengths {
        size: options.size,
        points: grid.settings.len(),
        time,
        tight_time: TIGHT_FACTOR * time,
        short_time: unit * (SHORT_TIME / unit).round().max(1.0),
        repeats: if quick { 3 } else { 5 },
        timing_seconds,
        threads: options.threads,
        cpu: lennard_io::cpu_name(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::LeftOut;

    #[test]
    fn an_empty_grid_is_refused_and_says_why() {
        let grid = Grid {
            settings: Vec::new(),
            left_out: vec![LeftOut {
                what: "cutoffs of 2 σ".into(),
                why: "the box is small".into(),
            }],
        };
        let text = nothing_to_compare(&grid).to_string();
        assert!(text.contains("0 of the settings") && text.contains("the box is small"), "{text}");
    }
}
