//! Running the points: errors side by side, then costs one after the other.

use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_scene::Scene;

use super::grid::{COMMON_STEPS, Grid, Size, grid};
use super::point::{ChartedPoint, Errors, Outcome};
use super::store::Store;
use super::workshop::Workshop;
use super::{Chart, ChartError, ChartOptions, Plan, SCHEMA, bounded, panels, peers};
use crate::lab::{self, Workbench, modelled_work};
use crate::settings::{Settings, truncation_is_free};
use crate::{Progress, StudyError};

/// About this long are they, τ: before chaos takes over.
const SHORT_TIME: f64 = 0.25;
/// Shortest and longest runs that measure, τ.
const SHORTEST: f64 = 2.0;
const LONGEST: f64 = 200.0;
/// The tightest run is that much longer: all others are compared with it.
const TIGHT_FACTOR: f64 = 2.0;
/// Seconds of one thread, by the model, that all measuring runs of a chart together may take.
const QUICK_SECONDS: f64 = 5.0;
const DEFAULT_SECONDS: f64 = 130.0;
/// Length of the runs of the whole grid, τ.
const FULL_TIME: f64 = 20.0;
/// Share of the work that is done when errors are known, for the progress.
const ERRORS_SHARE: f64 = 0.85;

/// Everything there is to measure, or as much as was done when it was stopped.
pub(super) fn all(
    scene: &Scene,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Chart, ChartError> {
    let store = Store::open(options.folder, scene, options.anew)?;
    progress.update("equilibrating", 0.0);
    let bench = Workbench::new(scene)?;
    let mut grid = grid(&bench, options.size);
    let tightest = with_tightest(&mut grid, &bench)?;
    let plan = plan(&bench, &grid, tightest, options);
    store.begin(scene, &plan)?;
    let slopes = bench.slopes(&grid.settings[tightest], plan.time)?;
    let untruncated = if truncation_is_free(scene) { Some(bench.untruncated()?) } else { None };

    let fresh = grid.settings.iter().enumerate();
    let fresh = fresh.map(|(i, settings)| ChartedPoint::new(i + 1, settings.clone()));
    let workshop = Workshop::new(fresh, scene, &store, options, &plan, ERRORS_SHARE);
    workshop.measure("measuring errors", progress, |point| {
        let time = if point.number == tightest + 1 { plan.tight_time } else { plan.time };
        point.errors = Some(errors(&bench, &point.settings, time, &plan, &slopes)?);
        Ok(())
    })?;
    workshop.time(progress, |point| {
        match Outcome::of(bench.timing(&point.settings, plan.timing_seconds))? {
            Outcome::Found(timing) => {
                if point.pair_forces_per_atom_tau.is_none() {
                    let evaluations = timing.evaluations_per_tau;
                    point.pair_forces_per_atom_tau =
                        Some(bench.pair_forces(&point.settings, evaluations)?);
                }
                point.timings.push(timing);
            }
            Outcome::Failed(failed) => point.not_timed = Some(failed),
        }
        Ok(())
    })?;

    let (mut points, finished) = workshop.close();
    let mut remarks = Vec::new();
    if options.with_peers && finished {
        progress.update("other engines", 0.99);
        match peers::of_lammps(&bench, &plan, &slopes, &points) {
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
        step_of_fastest: lab::rough_stable_dt(
            scene,
            bench.start().system().species(),
            slopes.temperature,
            1.0,
        ),
        slopes,
        reach: untruncated.map(|u| u.reach),
        left_out_of_forces: untruncated.map(|u| u.left_out),
        points,
        tightest,
        left_out: grid.left_out,
        remarks,
        panels: Vec::new(),
        plan,
    };
    chart.panels = panels::panels(&bench, &chart)?;
    if finished {
        progress.update("done", 1.0);
    }
    Ok(chart)
}

/// Adds the settings by which all others are judged, and gives their place.
fn with_tightest(grid: &mut Grid, bench: &Workbench) -> Result<usize, ChartError> {
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

fn nothing_to_compare(grid: &Grid) -> ChartError {
    let why = grid.left_out.iter().map(|l| format!("\n  {}: {}", l.what, l.why)).collect();
    ChartError::NothingToCompare { found: grid.settings.len(), why }
}

/// How long everything runs: a function of the scene and the grid.
fn plan(bench: &Workbench, grid: &Grid, tightest: usize, options: &ChartOptions<'_>) -> Plan {
    let work = |s: &Settings| modelled_work(bench.scene(), bench.start(), s);
    let a_tau: f64 = grid.settings.iter().map(work).sum::<f64>()
        + (TIGHT_FACTOR - 1.0) * work(&grid.settings[tightest]);
    let (time, repeats, timing_seconds) = match options.size {
        Size::Quick => (QUICK_SECONDS / a_tau, 3, 0.02),
        Size::Default => (DEFAULT_SECONDS / a_tau, 5, 0.03),
        Size::Full => (FULL_TIME, 5, 0.03),
    };
    let time = bounded(bench.scene(), time, SHORTEST, LONGEST);
    let unit = COMMON_STEPS * bench.scene().integrator.dt;
    Plan {
        size: options.size,
        points: grid.settings.len(),
        time,
        tight_time: TIGHT_FACTOR * time,
        short_time: unit * (SHORT_TIME / unit).round().max(1.0),
        repeats,
        timing_seconds,
        threads: options.threads,
        cpu: lennard_io::cpu_name(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// All errors of some settings.
fn errors(
    bench: &Workbench,
    settings: &Settings,
    time: f64,
    plan: &Plan,
    slopes: &crate::lab::Slopes,
) -> Result<Errors, StudyError> {
    Ok(Errors {
        forces: bench.force_errors(settings)?,
        measured: Outcome::of(bench.measure(settings, time, slopes))?,
        trajectory: Outcome::of(bench.trajectory_error(settings, plan.short_time))?,
        reversibility: Outcome::of(bench.reversibility(settings, plan.short_time))?,
    })
}

#[cfg(test)]
mod tests {
    use super::super::grid::LeftOut;
    use super::*;

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
