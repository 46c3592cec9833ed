//! Bonds held in each way: error, cost and largest stable step, on two dumbbells that meet.

use std::time::Duration;

use lennard_core::{DVec3, Want};
use lennard_engine::stopwatch::repeated;
use lennard_integrators::BondOptions;
use lennard_observables::{Cell, Table};

use super::bodies::{Bodies, RunSummary, distance, strain};
use super::bodies::{MIDPOINT, Way, ways};
use crate::StudyError;
use crate::claims::Measured;
use crate::lab::Rig;
use crate::report::Drawn;
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
const LARGEST_STEP: f64 = 4.0;
/// Dumbbells, and chains of ten bonds, on which costs are measured.
const MOLECULES: [(usize, usize); 2] = [(2, 500), (11, 50)];
/// A way to hold bonds with what it showed.
struct WayResults {
    name: String,
    /// Each step at which it ran to the end, the largest error of a position there against rigid dumbbells in σ, and the run.
    points: Vec<(f64, f64, RunSummary)>,
    /// The order of the position error at the smallest steps, or why it has none.
    order: Result<f64, &'static str>,
    /// Largest stable step on a vibrating rotor with Ω = 2 τ⁻¹; `None` where all up to 4 τ are stable.
    largest_step: Option<f64>,
    /// Nanoseconds of a whole step without pair forces, per bond: dumbbells, and chains of ten bonds.
    cost: [f64; 2],
}

/// Measures every way.
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let steps: &[u32] = &[125, 250, 500, 1000, 2000, 4000, 8000];
    let steps = if quick { &steps[1..5] } else { steps };
    let found =
        ways().iter().map(|way| of_way(way, steps, quick)).collect::<Result<Vec<_>, _>>()?;
    for way in &found {
        let order = way.order.unwrap_or(f64::NAN);
        all.numbers.add("order of a bond", order).of("way", &way.name);
    }
    let limit = |name: &str| {
        let way = found.iter().find(|w| w.name == name);
        way.map_or(f64::NAN, |w| w.largest_step.unwrap_or(f64::INFINITY))
    };
    // The rotor turns with Ω = 2 τ⁻¹.
    all.numbers.add("largest Ωh of a rigid rotor", 2.0 * limit("direct"));
    for (name, k) in [("spring, k = 1000", 1e3_f64), ("spring, k = 64000", 6.4e4)] {
        let largest = limit(name) * (2.0 * k).sqrt();
        all.numbers.add("largest ωh of an explicit spring", largest).of("k", k);
    }
    for (name, k) in MIDPOINT {
        let largest = 2.0 * (2.0 * k).sqrt() * limit(name).powi(2);
        all.numbers.add("largest Ω·ω·h² of a midpoint spring", largest).of("k", k);
    }
    tables(&found, all);
    Ok(())
}

fn tables(found: &[WayResults], all: &mut Measured) {
    let points: Vec<_> = found.iter().flat_map(|w| w.points.iter().map(move |p| (w, p))).collect();
    let ways = Table::rows_of("ways", &points)
        .column("way", |(w, _)| &w.name)
        .column("dt [tau]", |(_, p)| p.0)
        .column("position error [sigma]", |(_, p)| p.1)
        .column("energy RMS [epsilon]", |(_, p)| p.2.rms)
        .column("energy change [epsilon]", |(_, p)| p.2.change)
        .column("strain", |(_, p)| p.2.strain)
        .column("cost [ns per bond and step]", |(w, _)| w.cost[0])
        .table();
    let cost_of_time = points.iter().map(|(w, p)| w.cost[0] / p.0);
    all.given.tables.push(ways.clone().and("cost of a time", cost_of_time));
    let caption = format!(
        "Order of the position error, where it falls as a power of h, and RMS of the energy at the step nearest to 0.0025 τ. The largest stable step is for a rotor with Ω = 2 τ⁻¹ \
         that also vibrates, and was looked for up to {LARGEST_STEP} τ. The time is the fastest of a whole step without pair forces, per bond."
    );
    let near = |w: &WayResults| {
        let off = |p: &&(f64, f64, RunSummary)| (p.0 / 0.0025).ln().abs();
        let nearest = w.points.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map(|p| p.2.rms)
    };
    let in_a_line = Table::rows_of("ways-in-a-line", found)
        .caption(caption)
        .column("Way", |w| &w.name)
        .column("Order", |w| w.order.map_or_else(Cell::words, |order| Cell::rounded(order, 3)))
        .column("RMS of E [ε]", |w| Cell::rounded(near(w), 3))
        .column("Largest stable step [τ]", |w| match w.largest_step {
            Some(step) => Cell::rounded(step, 3),
            None => Cell::words(format!("none up to {LARGEST_STEP}")),
        })
        .column("Dumbbell [ns per bond]", |w| Cell::rounded(w.cost[0], 3))
        .column("Chain of 10 [ns per bond]", |w| Cell::rounded(w.cost[1], 3))
        .table();
    all.word("ways", in_a_line.rows().to_string());
    all.tables.extend([ways, in_a_line]);
    let reached: Vec<(&WayResults, f64)> =
        found.iter().filter_map(|w| Some((w, w.points.last()?.1))).collect();
    // The law goes through the stiffest of the explicit springs.
    let stiffest = reached.iter().find(|(way, _)| way.name == "spring, k = 64000");
    let law: Vec<(f64, f64)> = stiffest
        .and_then(|(way, error)| Some((*error, way.largest_step?)))
        .map_or(Vec::new(), |(error, step)| {
            [1.0, 256.0].map(|more: f64| (error * more, step * more.sqrt())).into()
        });
    let limits = Table::rows_of("limits", &reached)
        .column("way", |(way, _)| &way.name)
        .column("smallest error", |(_, error)| *error)
        .column("largest step", |(way, _)| way.largest_step.unwrap_or(LARGEST_STEP));
    let by_theory = Table::rows_of("limits by theory", &law)
        .column("error", |(error, _)| *error)
        .column("step", |(_, step)| *step);
    all.given.tables.extend([limits.table(), by_theory.table()]);
}

/// The order of an error at the smallest steps, or why it has none. `errors` are (step, error), and `between` is the distance
/// between the last two runs.
fn order(bonds: &BondOptions, errors: &[(f64, f64)], between: f64) -> Result<f64, &'static str> {
    let unsettled = "no power of h";
    let [.., a, b, c] = errors else {
        return Err(unsettled);
    };
    let (coarse, fine) = (slope(*a, *b), slope(*b, *c));
    // An error ∝ h^p is at most 1/(2^p − 1) of what the last halving of the step changed. Springs end at another model.
    if matches!(bonds, BondOptions::Spring(_)) && between < 0.5 * c.1 {
        Err("error of the model")
    } else if (coarse - fine).abs() < 0.25 {
        Ok(fine)
    } else {
        Err(unsettled)
    }
}

fn of_way(way: &Way, steps: &[u32], quick: bool) -> Result<WayResults, StudyError> {
    let case = Bodies::two_dumbbells()?;
    let mut points = Vec::new();
    let (mut last, mut between) = (Vec::new(), f64::NAN);
    for steps in steps {
        let Ok(end) = case.run(&way.bonds, END, *steps)? else {
            continue;
        };
        between = distance(&end.positions, &last);
        let position_error = distance(&end.positions, &KNOWN);
        if position_error < 1.0 {
            points.push((END / f64::from(*steps), position_error, end.clone()));
        }
        last = end.positions;
    }
    let errors: Vec<_> = points.iter().map(|p| (p.0, p.1)).collect();
    let budget = Duration::from_millis(if quick { 2 } else { 100 });
    let [dumbbells, chains] = MOLECULES.map(|(sites, n)| cost(way, sites, n, budget));
    Ok(WayResults {
        name: way.name.clone(),
        points,
        order: order(&way.bonds, &errors, between),
        largest_step: largest_step(&way.bonds, if quick { 500 } else { 5000 })?,
        cost: [dumbbells?, chains?],
    })
}

/// Nanoseconds of a step per bond, the fastest of repeated blocks, on molecules that turn slowly and do not interact.
fn cost(way: &Way, sites: usize, n: usize, budget: Duration) -> Result<f64, StudyError> {
    const BLOCK: usize = 10;
    let mut case = Bodies::stretching(sites - 1, 1.0)?;
    let one = case.x.clone();
    let turn = |r: &DVec3| 0.5 * DVec3::new(-r.y, r.x, 0.0);
    let apart = |m: usize| DVec3::new(0.0, 0.0, 5.0 * m as f64);
    case.x = (0..n).flat_map(|m| one.iter().map(move |r| *r + apart(m))).collect();
    case.v = (0..n).flat_map(|_| one.iter().map(turn)).collect();
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

/// The largest stable step by bisection, τ: at which a rotor that also vibrates by 10⁻³ keeps its bond within a half for so many
/// steps.
fn largest_step(bonds: &BondOptions, steps: u32) -> Result<Option<f64>, StudyError> {
    let mut case = Bodies::rotor(2.0)?;
    case.x[1].x += 1e-3;
    let is_stable = |dt: f64| {
        let holds = |rig: &mut Rig| rig.try_step().is_ok() && strain(rig) <= 0.5;
        case.start(bonds, dt).is_ok_and(|mut rig| (0..steps).all(|_| holds(&mut rig)))
    };
    if is_stable(LARGEST_STEP) {
        return Ok(None);
    }
    let (mut stable, mut unstable) = (1e-4, LARGEST_STEP);
    // The first unstable step of a ladder, so that islands of stability beyond it do not count.
    let mut dt = stable;
    while dt < LARGEST_STEP {
        if !is_stable(dt) {
            unstable = dt;
            break;
        }
        stable = dt;
        dt *= 1.15;
    }
    for _ in 0..14 {
        let middle = (stable * unstable).sqrt();
        if is_stable(middle) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    Ok(Some(stable))
}
