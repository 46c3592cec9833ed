//! Displacement and energy against time, at the stiffnesses of the manual's study.

use std::f64::consts::PI;

use glam::DVec2;
use lennard_integrators::IntegratorEntry;
use lennard_observables::{Cell, Table, Tone};
use rayon::prelude::*;

use super::amplification::{mean_growth, theory};
use super::groups::{group_of, groups, methods};
use super::map::StepMap;
use super::oscillator::{Excursion, Spring, excursion, measured_map};
use crate::StudyError;
use crate::claims::Measured;
use crate::report::significant;

/// Mass of the study, m.
pub(super) const MASS: f64 = 1.0;
/// Step of the study, τ.
pub(super) const STEP: f64 = 0.0167;
/// Displacement at the start, σ; the velocity is zero.
const START: f64 = 1.0;
/// Steps of the long runs. Just outside the limit SPOOK turns by a quarter of a circle less 3·10⁻⁵ per step.
/// After so many steps, each half of the run has a sample close to a crest.
const LONG_RUN: u32 = 100_000;
/// |x| at which a long run counts as diverging, σ.
const DIVERGED: f64 = 1e12;
/// |x| in σ at which a line that leaves its figure is not followed any further.
const OUT_OF_SIGHT: f64 = 2e4;

/// A stiffness, k = {k} ε/σ².
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    title: &'static str,
    k: f64,
    omega_h: f64,
    /// Steps of the figures.
    steps: usize,
}

/// The finite stiffnesses.
fn cases() -> [Case; 4] {
    let scale = MASS / (STEP * STEP);
    let case = |name, title, k: f64, steps| Case {
        name,
        title,
        k,
        omega_h: (k / MASS).sqrt() * STEP,
        steps,
    };
    [
        case("k-100", "k = 100 ε/σ²", 100.0, 300),
        case("k-inside", "k = 4m/h² − 1", 4.0 * scale - 1.0, 400),
        case("k-outside", "k = 4m/h² + 1", 4.0 * scale + 1.0, 400),
        case("k-aliasing", "k = 4π²m/h²", 4.0 * PI * PI * scale, 100),
    ]
}

/// A short run, for the figures.
struct Short {
    case: Case,
    method: &'static str,
    /// x in σ and ½kx² + ½mv² in ε, from time 0, one per step; ends early where the method stopped.
    points: Vec<(f64, f64)>,
    /// The last point that is in sight.
    sight: usize,
}

impl Short {
    fn run(case: Case, entry: &IntegratorEntry) -> Result<Self, StudyError> {
        let mut rig = Spring::Stiffness(case.k).start(entry, (START, 0.0), STEP)?;
        let point = |z: DVec2| (z.x, 0.5 * case.k * z.x * z.x + 0.5 * MASS * z.y * z.y);
        let mut points = vec![point(DVec2::new(START, 0.0))];
        while points.len() <= case.steps && rig.try_step().is_ok() {
            points.push(point(rig.point()));
        }
        let sight = points.iter().position(|(x, _)| x.abs() > OUT_OF_SIGHT);
        let sight = sight.unwrap_or(points.len() - 1);
        Ok(Self { case, method: entry.spec.name, points, sight })
    }

    /// The time at which the method stopped, if it did.
    fn stopped(&self) -> Option<f64> {
        let end = self.points.len() - 1;
        (end < self.case.steps).then_some(end as f64 * STEP)
    }
}

/// A long run.
struct Long {
    case: Case,
    method: &'static str,
    /// The declared map in units of the step, so that x and v·h have the same size.
    map: StepMap,
    measured: StepMap,
    far: Excursion,
}

impl Long {
    fn run(case: Case, entry: &IntegratorEntry) -> Result<Self, StudyError> {
        Ok(Self {
            case,
            method: entry.spec.name,
            map: theory(entry, case.omega_h),
            measured: measured_map(entry, case.omega_h / STEP, STEP)?,
            far: excursion(entry, Spring::Stiffness(case.k), STEP, LONG_RUN, DIVERGED)?,
        })
    }

    /// The amplitude by theory, σ; `None` where it grows, shrinks or has real eigenvalues.
    fn amplitude(&self) -> Option<f64> {
        let is_neutral = (self.map.radius() - 1.0).abs() < 1e-9;
        self.map.amplitude(START, 0.0).filter(|_| is_neutral)
    }

    /// The period of a map over the true one.
    fn period(&self, map: StepMap) -> Option<f64> {
        map.phase().map(|phase| self.case.omega_h / phase)
    }

    /// The growth of halves; `None` where the run diverged.
    fn growth(&self) -> Option<f64> {
        Some(self.far.growth).filter(|growth| growth.is_finite())
    }

    /// Adds the numbers that judge claims.
    fn judge(&self, entry: &IntegratorEntry, found: &mut Measured) -> Result<(), StudyError> {
        let mut add = |key, measured, theory: Option<f64>| {
            let number = found.numbers.add(key, measured).theory(theory);
            let number = number.of("case", self.case.name).of("title", self.case.title);
            // The amplitude of SPOOK just outside the limit of symplectic Euler, where (ωh)² = 4 + h².
            number.of("method", self.method).of("swing", (2.0 + 0.25 * STEP * STEP).sqrt());
        };
        let period = self.period(self.measured).unwrap_or(f64::NAN);
        add("period", period, self.period(self.map));
        add("growth of halves", self.growth().unwrap_or(f64::INFINITY), None);
        add("amplitude", self.far.largest, self.amplitude());
        // Elsewhere a run that grows leaves the range of numbers within these steps.
        if self.case.name == "k-100" {
            add("growth per step", mean_growth(entry, self.case.omega_h)?, Some(self.map.radius()));
        }
        Ok(())
    }
}

/// Runs all cases: a short run of each group for the figures, and a long run of each method.
pub(super) fn measure(found: &mut Measured) -> Result<(), StudyError> {
    let methods = methods();
    let (mut short, mut long) = (Vec::new(), Vec::new());
    for case in cases() {
        let runs = groups().par_iter().map(|group| Short::run(case, group.members[0]));
        let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
        // Large swings come first: small ones are drawn over them.
        let size = |r: &Short| r.points.iter().fold(0.0_f64, |m, (x, _)| m.max(x.abs()));
        runs.sort_by(|a, b| size(b).total_cmp(&size(a)));
        short.extend(runs);
        let runs = methods.par_iter().map(|entry| Long::run(case, entry));
        let runs = runs.collect::<Result<Vec<_>, _>>()?;
        for (entry, run) in methods.iter().zip(&runs) {
            run.judge(entry, found)?;
        }
        let caption = format!(
            "{} = {} ε/σ², ωh = {:.6}, over {LONG_RUN} steps. The amplitude by theory is the amplitude of the one-step \
             map; the measured one is the largest |x|.",
            case.title,
            significant(case.k, 7),
            case.omega_h,
        );
        let shown = fates(case.name, &runs).without(&["k", "omega h"]);
        found.given.tables.push(Table { caption, ..shown });
        long.extend(runs);
    }
    found.tables.push(fates("stiffnesses", &long));
    let steps = short.iter().flat_map(|run| (0..run.points.len()).map(move |n| (run, n)));
    let in_sight = |run: &Short, n: usize, y: f64| Some(y).filter(|_| n <= run.sight);
    let steps: Vec<_> = steps.collect();
    let table = Table::rows_of("displacement", &steps)
        .column("case", |(run, _)| run.case.name)
        .column("title", |(run, _)| run.case.title)
        .column("omega h", |(run, _)| Cell::figures(format!("{:.6}", run.case.omega_h)))
        .column("group", |(run, _)| group_of(run.method).1.name.as_str())
        .column("index", |(run, _)| group_of(run.method).0)
        .column("time [τ]", |(_, n)| *n as f64 * STEP)
        .column("x [σ]", |(run, n)| run.points[*n].0)
        .column("energy [ε]", |(run, n)| run.points[*n].1)
        .column("x in sight", |(run, n)| in_sight(run, *n, run.points[*n].0))
        .column("energy in sight", |(run, n)| in_sight(run, *n, run.points[*n].1 / run.points[0].1))
        .column("stopped", |(run, n)| run.stopped().filter(|_| *n == 0));
    found.curves.push(table.table());
    Ok(())
}

/// The fate of each method.
fn fates(name: &str, runs: &[Long]) -> Table {
    Table::rows_of(name, runs)
        .column("k [ε/σ²]", |r| r.case.k)
        .column("omega h", |r| r.case.omega_h)
        .column("method", |r| r.method)
        .column("fate", |r| {
            let (fate, tone) = match r.growth() {
                None => ("diverges", Tone::Bad),
                Some(g) if g > 1.001 => ("grows", Tone::Bad),
                Some(g) if g < 0.9 => ("dies away", Tone::Careful),
                Some(_) => ("bounded", Tone::Good),
            };
            Cell::words(fate).toned(tone)
        })
        .column("radius by theory", |r| Cell::rounded(r.map.radius(), 6))
        .column("amplitude by theory [σ]", |r| Cell::rounded(r.amplitude(), 7))
        .column("amplitude measured [σ]", |r| {
            Cell::rounded(Some(r.far.largest).filter(|x| x.is_finite()), 7)
        })
        .column("growth of halves", Long::growth)
        .column("period ratio by theory", |r| Cell::rounded(r.period(r.map), 6))
        .column("period ratio measured", |r| Cell::rounded(r.period(r.measured), 6))
        .table()
}
