//! A2, A5, A7: orders of methods, of starts, of velocity estimates, of local errors, and of the energy.

use glam::DVec2;
use lennard_core::IntegratorSpec;
use lennard_integrators::IntegratorEntry;
use lennard_observables::Table;
use lennard_observables::statistics::Line;
use rayon::prelude::*;

use super::fit::{self, ErrorLine};
use super::groups::{Group, entry, group_of, methods};
use super::oscillator::Spring;
use super::variable_step;
use crate::StudyError;
use crate::claims::Measured;

/// The oscillator, ω = 1 τ⁻¹.
const SPRING: Spring = Spring::Stiffness(1.0);
/// Start (x, v) at ω = 1 τ⁻¹: neither at rest nor at zero, so that no error vanishes by symmetry.
const START: (f64, f64) = (1.0, 0.5);
/// End of the runs, τ.
const END: f64 = 2.0;
/// The coarsest step is END over this number of steps; each further one is half as long.
const COARSEST: u32 = 16;
/// Number of step lengths.
const REFINEMENTS: u32 = 7;
/// Steps after which added errors are looked at.
const SUMMED: [u32; 4] = [2, 3, 5, 30];
/// Errors below this are rounding: 512 steps of a few 10⁻¹⁶ each.
const ROUNDING: f64 = 2e-13;

impl ErrorLine {
    /// The error at each number of steps over the run and each step.
    fn of(
        (kind, name, theory): (&'static str, &str, f64),
        error: impl Fn(u32, f64) -> Result<f64, StudyError>,
    ) -> Result<Self, StudyError> {
        let at = |n: u32| Ok((step(n), error(n, step(n))?));
        let errors = (0..REFINEMENTS).map(|i| at(COARSEST << i));
        let errors = errors.collect::<Result<_, StudyError>>()?;
        Ok(Self { kind, name: name.into(), theory: Some(theory), errors })
    }

    /// The measured order; not a number where the errors are rounding alone.
    pub(super) fn order(&self) -> f64 {
        fit::order(&self.errors, ROUNDING).unwrap_or(f64::NAN)
    }

    /// The group that the line stands for, where it is drawn for one.
    fn group(&self) -> Option<(usize, &'static Group)> {
        let group = group_of(&self.name);
        let stands_for = group.1.members[0].spec.name == self.name;
        Some(group).filter(|_| stands_for && self.kind.starts_with("global"))
    }

    /// Name and measured order.
    fn label(&self) -> String {
        let name = self.group().map_or(&self.name, |group| &group.1.name);
        match self.order() {
            order if order.is_nan() => format!("{name}: rounding"),
            // Adding zero turns −0.00 into 0.00.
            order => format!("{name}: order {:.2}", (100.0 * order).round() / 100.0 + 0.0),
        }
    }

    /// The error at a step on the line of the order of theory through the middle step.
    fn by_theory(&self, at: f64) -> Option<f64> {
        let (h, e) = self.errors[self.errors.len() / 2];
        let theory = self.theory.filter(|_| !self.order().is_nan())?;
        Some(e * (at / h).powf(theory))
    }
}

/// The step of a run of `n` steps, τ.
fn step(n: u32) -> f64 {
    END / f64::from(n)
}

fn exact(t: f64) -> DVec2 {
    let (x, v) = START;
    DVec2::new(x * t.cos() + v * t.sin(), v * t.cos() - x * t.sin())
}

/// (x, v) from time 0 to the end, one per step.
fn path(entry: &IntegratorEntry, start: (f64, f64), steps: u32) -> Result<Vec<DVec2>, StudyError> {
    SPRING.path(entry, start, step(steps), steps)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// The largest error over a run of what `pick` takes of (x, v).
fn error_of(
    entry: &IntegratorEntry,
    start: (f64, f64),
    steps: u32,
    pick: fn(DVec2) -> f64,
) -> Result<f64, StudyError> {
    let run = path(entry, start, steps)?.into_iter().enumerate();
    Ok(largest(run.map(|(i, z)| pick(z) - pick(exact(i as f64 * step(steps))))))
}

/// Measures all orders.
pub(super) fn measure(quick: bool, found: &mut Measured) -> Result<(), StudyError> {
    let methods = methods();
    let of_methods = |kind, pick: fn(DVec2) -> f64, order: fn(&IntegratorSpec) -> u32| {
        let line = |entry: &&'static IntegratorEntry| {
            let subject = (kind, entry.spec.name, f64::from(order(entry.spec)));
            ErrorLine::of(subject, |n, _| error_of(entry, START, n, pick))
        };
        methods.par_iter().map(line).collect::<Result<Vec<_>, StudyError>>()
    };
    let mut lines = of_methods("global position", |z| z.x, |spec| spec.position_order)?;
    lines.extend(of_methods("global velocity", |z| z.y, |spec| spec.velocity_order)?);
    lines.extend(starts()?);
    lines.extend(velocity_estimates()?);
    lines.extend(local()?);
    lines.push(energy(quick, found)?);
    for line in &lines {
        let name = match line.kind {
            "global position" => format!("x under `{}`", line.name),
            "global velocity" => format!("v under `{}`", line.name),
            _ => line.name.clone(),
        };
        found.numbers.add("order", line.order()).of("name", name).theory(line.theory);
    }
    lines.extend(variable_step::measure(found)?);
    accumulation(found)?;
    let difference = equivalence()?;
    found.numbers.add("difference of velocity Verlet from Störmer–Verlet", difference);
    let points = lines.iter().flat_map(|line| line.errors.iter().map(move |at| (line, *at)));
    let points: Vec<_> = points.collect();
    let table = Table::rows_of("orders", &points)
        .column("kind", |(line, _)| line.kind)
        .column("name", |(line, _)| &line.name)
        .column("order by theory", |(line, _)| line.theory)
        .column("order measured", |(line, _)| Some(line.order()).filter(|order| !order.is_nan()))
        .column("h [τ]", |(_, at)| at.0)
        .column("error", |(_, at)| at.1)
        .column("error by theory", |(line, at)| line.by_theory(at.0))
        .column("label", |(line, _)| line.label())
        .column("drawn", |(line, _)| if line.group().is_some() { "yes" } else { "no" })
        .column("index", |(line, _)| line.group().map_or(0, |group| group.0));
    found.tables.push(table.table());
    Ok(())
}

/// x_1 = x_0 + v_0·h + ½·a_0·h², and the same without its last term. The method itself always takes
/// the Taylor start; beginning it with v_0 − ½·a_0·h cancels the term.
fn starts() -> Result<[ErrorLine; 2], StudyError> {
    let stormer = entry("stormer-verlet")?;
    let (x, v) = START;
    let without = |h: f64| (x, v + 0.5 * h * x);
    Ok([
        ErrorLine::of(("start", "x₀ + v₀h + ½a₀h²", 2.0), |n, _| {
            error_of(stormer, START, n, |z| z.x)
        })?,
        ErrorLine::of(("start", "x₀ + v₀h", 1.0), |n, h| {
            error_of(stormer, without(h), n, |z| z.x)
        })?,
    ])
}

fn velocity_estimates() -> Result<[ErrorLine; 3], StudyError> {
    let stormer = entry("stormer-verlet")?;
    // Each estimate from three positions x_{n−1}, x_n, x_{n+1}, and the time, in steps after n, it is for.
    let of = |name, theory, at: f64, from: fn([f64; 3], f64) -> f64| {
        ErrorLine::of(("velocity estimate", name, theory), |n, h| {
            let run = path(stormer, START, n)?;
            Ok(largest(run.windows(3).enumerate().map(|(i, w)| {
                from([w[0].x, w[1].x, w[2].x], h) - exact((i as f64 + 1.0 + at) * h).y
            })))
        })
    };
    Ok([
        of("central, (x₊ − x₋)/2h at t", 2.0, 0.0, |x, h| (x[2] - x[0]) / (2.0 * h))?,
        of("half step, (x₊ − x)/h at t + h/2", 2.0, 0.5, |x, h| (x[2] - x[1]) / h)?,
        of("early, (x₊ − x)/h at t + h", 1.0, 1.0, |x, h| (x[2] - x[1]) / h)?,
    ])
}

fn local() -> Result<[ErrorLine; 4], StudyError> {
    let verlet = entry("velocity-verlet")?;
    let of = |name, theory, error: &dyn Fn(f64) -> Result<f64, StudyError>| {
        ErrorLine::of(("local", name, theory), |_, h| Ok(error(h)?.abs()))
    };
    let x = |t: f64| exact(t).x;
    // One step from the exact state at a generic time.
    let one_step = |h: f64| SPRING.start(verlet, START, h)?.next_point().map(|z| z - exact(h));
    Ok([
        of("x of the recurrence", 4.0, &|h| Ok(x(h) - 2.0 * x(0.0) + x(-h) + x(0.0) * h * h))?,
        of("v of the central difference", 2.0, &|h| Ok((x(h) - x(-h)) / (2.0 * h) - START.1))?,
        of("x of one velocity-Verlet step", 3.0, &|h| Ok(one_step(h)?.x))?,
        of("v of one velocity-Verlet step", 3.0, &|h| Ok(one_step(h)?.y))?,
    ])
}

/// Errors of Störmer–Verlet from two positions of cos t, over the first error. At the crest the local errors of a few
/// steps are equal but for terms of the order (nh)².
fn accumulation(found: &mut Measured) -> Result<(), StudyError> {
    let h = 0.004_f64;
    // The method begins with x + v·h + ½·a·h². This velocity makes that 2·cos 0 − cos h − h².
    let v = (1.0 - 0.5 * h * h - h.cos()) / h;
    let path = SPRING.path(entry("stormer-verlet")?, (1.0, v), h, SUMMED[SUMMED.len() - 1])?;
    let error = |n: u32| path[n as usize].x - (f64::from(n) * h).cos();
    for n in SUMMED {
        let number = found.numbers.add("added local errors", error(n) / error(1)).of("n", n);
        number.theory(f64::from(n * (n + 1) / 2));
    }
    Ok(())
}

/// The energy of velocity Verlet: the order of its oscillation, and its drift over a long run as a
/// share of that oscillation.
fn energy(quick: bool, found: &mut Measured) -> Result<ErrorLine, StudyError> {
    let verlet = entry("velocity-verlet")?;
    let of = |z: DVec2| 0.5 * (z.x * z.x + z.y * z.y);
    let line = ErrorLine::of(("energy", "|E − E₀| of velocity Verlet", 2.0), |n, _| {
        Ok(largest(path(verlet, START, n)?.into_iter().map(|z| of(z) - of(START.into()))))
    })?;
    // The same method with ω = 1 and a long way to go: a step of 0.05 τ.
    let steps = if quick { 20_000 } else { 200_000 };
    let path = SPRING.path(verlet, START, 0.05, steps)?;
    let energies: Vec<_> =
        (0..steps).map(f64::from).zip(path[1..].iter().map(|z| of(*z))).collect();
    let slope = Line::through(&energies).slope();
    let high = energies.iter().map(|e| e.1).fold(f64::NEG_INFINITY, f64::max);
    let low = energies.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
    let drift = (slope * f64::from(steps)).abs() / (high - low);
    found.numbers.add("drift of the energy", drift);
    Ok(line)
}

/// Velocity Verlet beside Störmer–Verlet with the central velocity, over the whole run.
fn equivalence() -> Result<f64, StudyError> {
    let steps = COARSEST << 3;
    let a = path(entry("velocity-verlet")?, START, steps)?;
    let b = path(entry("stormer-verlet")?, START, steps)?;
    Ok(largest(a.iter().zip(&b).flat_map(|(a, b)| (*a - *b).to_array())))
}
