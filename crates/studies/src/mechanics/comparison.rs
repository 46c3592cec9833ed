//! Bonds held in each way: error, cost and largest stable step, on two dumbbells that meet.

use std::time::Duration;

use lennard_core::{DVec3, Want};
use lennard_engine::stopwatch::repeated;
use lennard_integrators::BondOptions;
use serde::Serialize;

use super::bodies::{Bodies, BodyForces, distance, strain};
use super::ways::{Way, ways};
use crate::StudyError;
use crate::stability::fit::slope;

/// End of the run, τ.
const END: f64 = 2.5;
/// Positions there by a Runge–Kutta method of order 8 with a tolerance of 2.3e-14, σ.
const KNOWN: [DVec3; 4] = [
    DVec3::new(-1.641155205379, 0.029260398615, -0.335),
    DVec3::new(-1.641155205379, 0.029260398615, 0.335),
    DVec3::new(1.941570057551, -0.177503160982, 0.0),
    DVec3::new(1.340740353207, 0.118982363753, 0.0),
];
/// The largest step at which a limit is looked for, τ.
pub(crate) const LARGEST_STEP: f64 = 4.0;
/// Dumbbells, and chains of ten bonds, on which costs are measured.
const MOLECULES: [(usize, usize); 2] = [(2, 500), (11, 50)];

/// A way at one step.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct AtStep {
    /// h, τ.
    pub dt: f64,
    /// Largest error of a position at the end against rigid dumbbells, σ.
    pub position_error: f64,
    /// RMS of E − E(0), ε.
    pub energy_rms: f64,
    /// E at the end less E(0), ε.
    pub energy_change: f64,
    /// Largest | |d|/r − 1 |.
    pub strain: f64,
}

/// What the error of a position does at the smallest steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convergence {
    /// It falls as this power of the step.
    Order(f64),
    /// It is the distance of another model, which no step makes smaller.
    Model,
    /// It falls as no single power: a tolerance is left, or two powers meet.
    Unsettled,
}

impl Convergence {
    /// From the last (step, error), and from the distance between the last two runs.
    fn of(bonds: &BondOptions, errors: &[(f64, f64)], between: f64) -> Self {
        let [.., a, b, c] = errors else {
            return Self::Unsettled;
        };
        let (coarse, fine) = (slope(*a, *b), slope(*b, *c));
        // An error ∝ h^p is at most 1/(2^p − 1) of what the last halving of the step changed.
        if matches!(bonds, BondOptions::Spring(_)) && between < 0.5 * c.1 {
            Self::Model
        } else if (coarse - fine).abs() < 0.25 {
            Self::Order(fine)
        } else {
            Self::Unsettled
        }
    }

    /// The order, where there is one.
    #[must_use]
    pub fn order(self) -> Option<f64> {
        match self {
            Self::Order(order) => Some(order),
            Self::Model | Self::Unsettled => None,
        }
    }
}

/// A way to hold bonds with what it showed.
#[derive(Debug, Clone, Serialize)]
pub struct WayResults {
    /// Name.
    pub name: String,
    /// At each step at which it ran to the end.
    pub points: Vec<AtStep>,
    /// What the position error does at the smallest steps.
    pub convergence: Convergence,
    /// Largest stable step on a vibrating rotor with Ω = 2 τ⁻¹; `None` where all up to 4 τ are stable.
    pub largest_step: Option<f64>,
    /// Nanoseconds of a whole step without pair forces, per bond: dumbbells, and chains of ten bonds.
    pub cost: [f64; 2],
}

/// Measures every way.
pub(crate) fn measure(quick: bool) -> Result<Vec<WayResults>, StudyError> {
    let all: &[u32] = &[125, 250, 500, 1000, 2000, 4000, 8000];
    let steps = if quick { &all[1..5] } else { all };
    ways().iter().map(|way| of_way(way, steps, quick)).collect()
}

fn of_way(way: &Way, steps: &[u32], quick: bool) -> Result<WayResults, StudyError> {
    let case = Bodies::two_dumbbells();
    let mut points = Vec::new();
    let (mut last, mut between) = (Vec::new(), f64::NAN);
    for steps in steps {
        let Ok(end) = case.run(&way.bonds, END, *steps)? else {
            continue;
        };
        between = distance(&end.positions, &last);
        let position_error = distance(&end.positions, &KNOWN);
        if position_error < 1.0 {
            points.push(AtStep {
                dt: END / f64::from(*steps),
                position_error,
                energy_rms: end.rms,
                energy_change: end.change,
                strain: end.strain,
            });
        }
        last = end.positions;
    }
    let errors: Vec<_> = points.iter().map(|p| (p.dt, p.position_error)).collect();
    let budget = Duration::from_millis(if quick { 2 } else { 100 });
    let [dumbbells, chains] = MOLECULES.map(|(sites, n)| cost(way, sites, n, budget));
    Ok(WayResults {
        name: way.name.clone(),
        points,
        convergence: Convergence::of(&way.bonds, &errors, between),
        largest_step: largest_step(&way.bonds, if quick { 500 } else { 5000 })?,
        cost: [dumbbells?, chains?],
    })
}

/// Nanoseconds of a step per bond, the fastest of repeated blocks, on molecules that turn slowly and do not interact.
fn cost(way: &Way, sites: usize, n: usize, budget: Duration) -> Result<f64, StudyError> {
    const BLOCK: usize = 10;
    let mut case = Bodies::stretching(sites - 1, 1.0);
    let one = case.x.clone();
    let turn = |r: &DVec3| 0.5 * DVec3::new(-r.y, r.x, 0.0);
    let apart = |m: usize| DVec3::new(0.0, 0.0, 5.0 * m as f64);
    case.x = (0..n).flat_map(|m| one.iter().map(move |r| *r + apart(m))).collect();
    case.v = (0..n).flat_map(|_| one.iter().map(turn)).collect();
    case.forces = BodyForces { sites, ..BodyForces::default() };
    let mut rig = case.start(&way.bonds, 0.002)?;
    rig.want = Want::NOTHING;
    let mut failed = None;
    let spread = repeated(budget, 1000, || {
        for _ in 0..BLOCK {
            failed = failed.take().or(rig.try_step().err());
        }
    });
    // A way that gives up on a chain has no cost there.
    let seconds = if failed.is_some() { f64::NAN } else { spread.lowest };
    Ok(seconds / (BLOCK * n * (sites - 1)) as f64 * 1e9)
}

/// Whether a rotor that also vibrates by 10⁻³ keeps its bond within a half for so many steps.
fn is_stable(bonds: &BondOptions, dt: f64, steps: u32) -> Result<bool, StudyError> {
    let mut case = Bodies::rotor(2.0);
    case.x[1].x += 1e-3;
    let Ok(mut rig) = case.start(bonds, dt) else {
        return Ok(false);
    };
    for _ in 0..steps {
        if rig.try_step().is_err() || !strain(&rig).is_finite() || strain(&rig) > 0.5 {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The largest stable step by bisection, τ.
fn largest_step(bonds: &BondOptions, steps: u32) -> Result<Option<f64>, StudyError> {
    if is_stable(bonds, LARGEST_STEP, steps)? {
        return Ok(None);
    }
    let (mut stable, mut unstable) = (1e-4, LARGEST_STEP);
    // The first unstable step of a ladder, so that islands of stability beyond it do not count.
    let mut dt = stable;
    while dt < LARGEST_STEP {
        if !is_stable(bonds, dt, steps)? {
            unstable = dt;
            break;
        }
        stable = dt;
        dt *= 1.15;
    }
    for _ in 0..14 {
        let middle = (stable * unstable).sqrt();
        if is_stable(bonds, middle, steps)? {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    Ok(Some(stable))
}
