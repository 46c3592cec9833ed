//! A2, A5, A7: orders of methods, of starts, of velocity estimates, of local errors, and of the energy.

use lennard_integrators::IntegratorEntry;
use lennard_observables::statistics::Line;
use rayon::prelude::*;
use serde::Serialize;

use super::fit;
use super::groups::{Group, entry};
use super::oscillator::Spring;
use crate::StudyError;

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

/// An error that falls as a power of the step.
#[derive(Debug, Clone, Serialize)]
pub struct OrderLine {
    /// What errs.
    pub name: String,
    /// The order that theory gives.
    pub theory: f64,
    /// The order measured; `None` where the errors are rounding alone.
    pub measured: Option<f64>,
    /// (h, error).
    pub errors: Vec<(f64, f64)>,
}

/// All orders.
#[derive(Debug, Clone, Serialize)]
pub struct Orders {
    /// Global error of the positions of each method.
    pub positions: Vec<OrderLine>,
    /// Global error of the velocities of each method.
    pub velocities: Vec<OrderLine>,
    /// Störmer–Verlet from the start with and without the acceleration term.
    pub starts: Vec<OrderLine>,
    /// The three velocity estimates from positions.
    pub velocity_estimates: Vec<OrderLine>,
    /// Local errors: the recurrence, the central velocity, one step of velocity Verlet.
    pub local: Vec<OrderLine>,
    /// Steps n, and the error of a position after them over the error after one, under Störmer–Verlet.
    pub accumulation: Vec<(u32, f64)>,
    /// Amplitude of the energy's oscillation under velocity Verlet.
    pub energy: OrderLine,
    /// Drift of that energy over a long run, as a share of its oscillation.
    pub energy_drift_share: f64,
    /// Largest difference between velocity Verlet and Störmer–Verlet with central velocities, in x and v.
    pub velocity_verlet_against_stormer: f64,
}

fn exact(t: f64) -> (f64, f64) {
    let (x, v) = START;
    (x * t.cos() + v * t.sin(), v * t.cos() - x * t.sin())
}

/// (x, v) from time 0 to the end, one per step.
fn path(
    entry: &IntegratorEntry,
    start: (f64, f64),
    steps: u32,
) -> Result<Vec<(f64, f64)>, StudyError> {
    let dt = END / f64::from(steps);
    let mut rig = SPRING.start(entry, start, dt)?;
    let mut path = vec![start];
    for _ in 0..steps {
        let z = rig.next_point()?;
        path.push((z.x, z.y));
    }
    Ok(path)
}

fn step_counts() -> impl Iterator<Item = u32> {
    (0..REFINEMENTS).map(|i| COARSEST << i)
}

/// The largest error over a run as a line against the step.
fn line(
    name: impl Into<String>,
    theory: f64,
    error: impl Fn(u32, f64) -> Result<f64, StudyError>,
) -> Result<OrderLine, StudyError> {
    let errors = step_counts()
        .map(|n| {
            let h = END / f64::from(n);
            Ok((h, error(n, h)?))
        })
        .collect::<Result<Vec<_>, StudyError>>()?;
    Ok(OrderLine { name: name.into(), theory, measured: fit::order(&errors, ROUNDING), errors })
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// The largest error over a run of what `pick` takes of (x, v).
fn error_of(
    entry: &IntegratorEntry,
    start: (f64, f64),
    steps: u32,
    pick: fn((f64, f64)) -> f64,
) -> Result<f64, StudyError> {
    let run = path(entry, start, steps)?;
    let h = END / f64::from(steps);
    Ok(largest(run.iter().enumerate().map(|(i, z)| {
        let truth = exact(i as f64 * h);
        pick(*z) - pick(truth)
    })))
}

/// Measures all orders.
pub(crate) fn measure(groups: &[Group], quick: bool) -> Result<Orders, StudyError> {
    let entries: Vec<&IntegratorEntry> =
        groups.iter().flat_map(|g| g.members.iter().copied()).collect();
    let both: Vec<(OrderLine, OrderLine)> = entries
        .par_iter()
        .map(|e| {
            let x = line(e.spec.name, f64::from(e.spec.position_order), |n, _| {
                error_of(e, START, n, |z| z.0)
            })?;
            let v = line(e.spec.name, f64::from(e.spec.velocity_order), |n, _| {
                error_of(e, START, n, |z| z.1)
            })?;
            Ok((x, v))
        })
        .collect::<Result<_, StudyError>>()?;
    let (positions, velocities) = both.into_iter().unzip();
    let (energy, energy_drift_share) = energy(quick)?;
    Ok(Orders {
        positions,
        velocities,
        starts: starts()?,
        velocity_estimates: velocity_estimates()?,
        local: local()?,
        accumulation: accumulation()?,
        energy,
        energy_drift_share,
        velocity_verlet_against_stormer: equivalence()?,
    })
}

/// x_1 = x_0 + v_0·h + ½·a_0·h², and the same without its last term. The method itself always takes
/// the Taylor start; beginning it with v_0 − ½·a_0·h cancels the term.
fn starts() -> Result<Vec<OrderLine>, StudyError> {
    let stormer = entry("stormer-verlet")?;
    let run = |n: u32, h: f64, with_term: bool| {
        let (x, v) = START;
        let start = (x, if with_term { v } else { v + 0.5 * h * x });
        error_of(stormer, start, n, |z| z.0)
    };
    Ok(vec![
        line("x₀ + v₀h + ½a₀h²", 2.0, |n, h| run(n, h, true))?,
        line("x₀ + v₀h", 1.0, |n, h| run(n, h, false))?,
    ])
}

fn velocity_estimates() -> Result<Vec<OrderLine>, StudyError> {
    let stormer = entry("stormer-verlet")?;
    // Each estimate from three positions x_{n−1}, x_n, x_{n+1}, and the time, in steps after n, it is for.
    let estimate = |n: u32, h: f64, at: f64, from: fn([f64; 3], f64) -> f64| {
        let run = path(stormer, START, n)?;
        Ok(largest(run.windows(3).enumerate().map(|(i, w)| {
            let t = (i as f64 + 1.0 + at) * h;
            from([w[0].0, w[1].0, w[2].0], h) - exact(t).1
        })))
    };
    Ok(vec![
        line("central, (x₊ − x₋)/2h at t", 2.0, |n, h| {
            estimate(n, h, 0.0, |x, h| (x[2] - x[0]) / (2.0 * h))
        })?,
        line("half step, (x₊ − x)/h at t + h/2", 2.0, |n, h| {
            estimate(n, h, 0.5, |x, h| (x[2] - x[1]) / h)
        })?,
        line("early, (x₊ − x)/h at t + h", 1.0, |n, h| {
            estimate(n, h, 1.0, |x, h| (x[2] - x[1]) / h)
        })?,
    ])
}

fn local() -> Result<Vec<OrderLine>, StudyError> {
    let verlet = entry("velocity-verlet")?;
    // One step from the exact state at a generic time.
    let one_step = |h: f64, pick: fn((f64, f64)) -> f64| {
        let z = SPRING.start(verlet, START, h)?.next_point()?;
        Ok((pick((z.x, z.y)) - pick(exact(h))).abs())
    };
    Ok(vec![
        line("x of the recurrence", 4.0, |_, h| {
            let x = |t: f64| exact(t).0;
            Ok((x(h) - 2.0 * x(0.0) + x(-h) + x(0.0) * h * h).abs())
        })?,
        line("v of the central difference", 2.0, |_, h| {
            Ok(((exact(h).0 - exact(-h).0) / (2.0 * h) - START.1).abs())
        })?,
        line("x of one velocity-Verlet step", 3.0, |_, h| one_step(h, |z| z.0))?,
        line("v of one velocity-Verlet step", 3.0, |_, h| one_step(h, |z| z.1))?,
    ])
}

/// Errors of Störmer–Verlet from two positions of cos t, over the first error. At the crest the local errors of a few
/// steps are equal but for terms of the order (nh)².
fn accumulation() -> Result<Vec<(u32, f64)>, StudyError> {
    let h = 0.004_f64;
    // The method begins with x + v·h + ½·a·h². This velocity makes that 2·cos 0 − cos h − h².
    let v = (1.0 - 0.5 * h * h - h.cos()) / h;
    let mut rig = SPRING.start(entry("stormer-verlet")?, (1.0, v), h)?;
    let errors = (1..=SUMMED[SUMMED.len() - 1]).map(|n| {
        let x = rig.next_point()?.x;
        Ok(x - (f64::from(n) * h).cos())
    });
    let errors = errors.collect::<Result<Vec<f64>, StudyError>>()?;
    let over_first = |n: u32| (n, errors[n as usize - 1] / errors[0]);
    Ok(SUMMED.map(over_first).to_vec())
}

/// The energy of velocity Verlet: the order of its oscillation, and its drift over a long run as a
/// share of that oscillation.
fn energy(quick: bool) -> Result<(OrderLine, f64), StudyError> {
    let verlet = entry("velocity-verlet")?;
    let of = |z: &(f64, f64)| 0.5 * (z.0 * z.0 + z.1 * z.1);
    let swing = |run: &[(f64, f64)]| largest(run.iter().map(|z| of(z) - of(&START)));
    let order =
        line("|E − E₀| of velocity Verlet", 2.0, |n, _| Ok(swing(&path(verlet, START, n)?)))?;
    // The same method with ω = 1 and a long way to go: a step of 0.05 τ.
    let dt = 0.05;
    let steps = if quick { 20_000 } else { 200_000 };
    let mut rig = SPRING.start(verlet, START, dt)?;
    let mut energies = Vec::with_capacity(steps);
    for n in 0..steps {
        let z = rig.next_point()?;
        energies.push((n as f64, of(&(z.x, z.y))));
    }
    let slope = Line::through(&energies).slope();
    let (low, high) = energies
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(e.1), b.max(e.1)));
    Ok((order, (slope * steps as f64).abs() / (high - low)))
}

/// Velocity Verlet beside Störmer–Verlet with the central velocity, over the whole run.
fn equivalence() -> Result<f64, StudyError> {
    let steps = COARSEST << 3;
    let a = path(entry("velocity-verlet")?, START, steps)?;
    let b = path(entry("stormer-verlet")?, START, steps)?;
    Ok(largest(a.iter().zip(&b).flat_map(|(a, b)| [a.0 - b.0, a.1 - b.1])))
}
