//! The tables of the study, as CSV and on the page.

use std::f64::consts::PI;

use lennard_observables::{Cell, Table};

use super::collisions::Bouncing;
use super::comparison::{Convergence, LARGEST_STEP, WayResults};
use super::maps::{DAMPING, theory};
use super::study::MechanicsMeasurements;
use crate::report::{Drawn, Given};

/// In figures against ωh, s = ∞ stands here.
const AT_INFINITY: f64 = 60.0;

/// What the text of the page names: the tables of the files with columns that figures need, and the tables of the page.
pub(super) fn given(found: &MechanicsMeasurements) -> Given {
    let mut tables: Vec<Table> = csv(found).into_iter().map(|t| extended(found, t)).collect();
    tables.extend(by_theory(found));
    tables.extend([ways(found), solved(found), damped(found), cradles(found), drifts(found)]);
    Given { tables, words: vec![("ways", found.ways.len().to_string())], lists: Vec::new() }
}

/// A table with the columns that are drawn alone.
fn extended(found: &MechanicsMeasurements, table: Table) -> Table {
    let rates = &found.relaxing.rates;
    let balls = found.collisions.bouncing.iter();
    match table.name.as_str() {
        "ways" => {
            let cost = |w: &WayResults| -> Vec<f64> {
                w.points.iter().map(|p| w.cost[0] / p.dt).collect()
            };
            table.and("cost of a time", found.ways.iter().flat_map(cost))
        }
        "rates" => table
            .and("chain", rates.iter().map(|r| r.chain()))
            .and("sweeps measured", rates.iter().map(|r| sweeps(r.measured))),
        "spook-map" => {
            table.and("place", found.maps.points.iter().map(|p| p.phase.min(AT_INFINITY)))
        }
        "penalty" => {
            table.and("size of the gain", found.collisions.stiff.iter().map(|hit| hit.gain.abs()))
        }
        "bounces" => {
            let name = |b: &Bouncing| format!("{}, e = {}", b.rule, b.restitution);
            table.and("ball", balls.flat_map(|b| vec![name(b); b.path.len()]))
        }
        _ => table,
    }
}

/// Curves of theory, and the largest step of each way.
fn by_theory(found: &MechanicsMeasurements) -> [Table; 4] {
    let bonds: Vec<f64> = (2..=100).map(f64::from).collect();
    let angle = |n: &f64| PI / (n + 1.0);
    let dense = |k: u32| 0.1 * 400.0_f64.powf(f64::from(k) / 300.0);
    let map: Vec<(f64, f64)> =
        DAMPING.iter().flat_map(|damping| (0..=300).map(move |k| (*damping, dense(k)))).collect();
    let reached: Vec<(&WayResults, f64)> =
        found.ways.iter().filter_map(|w| Some((w, w.points.last()?.position_error))).collect();
    // Through the stiffest of the explicit springs.
    let stiffest = reached.iter().find(|(way, _)| way.name == "spring, k = 64000");
    let law: Vec<(f64, f64)> = stiffest
        .and_then(|(way, error)| Some((*error, way.largest_step?)))
        .map_or(Vec::new(), |(error, step)| {
            [1.0, 256.0].map(|more: f64| (error * more, step * more.sqrt())).into()
        });
    [
        Table::rows_of("rates by theory", &bonds)
            .column("bonds", |n| *n)
            .column("plain", |n| sweeps(angle(n).cos().powi(2)))
            .column("best", |n| sweeps(2.0 / (1.0 + angle(n).sin()) - 1.0))
            .table(),
        Table::rows_of("spook-map by theory", &map)
            .column("tau/h", |(damping, _)| *damping)
            .column("omega h", |(_, s)| *s)
            .column("radius", |(damping, s)| theory(*s, *damping).radius())
            .table(),
        Table::rows_of("limits", &reached)
            .column("way", |(way, _)| &way.name)
            .column("smallest error", |(_, error)| *error)
            .column("largest step", |(way, _)| way.largest_step.unwrap_or(LARGEST_STEP))
            .table(),
        Table::rows_of("limits by theory", &law)
            .column("error", |(error, _)| *error)
            .column("step", |(_, step)| *step)
            .table(),
    ]
}

/// Sweeps of a rate for a factor of 10⁻¹².
fn sweeps(rate: f64) -> f64 {
    -12.0 * 10.0_f64.ln() / rate.ln()
}

/// All tables with every digit.
pub(super) fn csv(found: &MechanicsMeasurements) -> Vec<Table> {
    let ways: Vec<_> =
        found.ways.iter().flat_map(|w| w.points.iter().map(move |p| (w, p))).collect();
    let relaxing = &found.relaxing;
    let solved: Vec<_> =
        found.solved.iter().flat_map(|s| s.errors.iter().map(move |e| (s, e))).collect();
    let collisions = &found.collisions;
    let bounces: Vec<_> =
        collisions.bouncing.iter().flat_map(|b| b.path.iter().map(move |p| (b, p))).collect();
    vec![
        Table::rows_of("ways", &ways)
            .column("way", |(w, _)| &w.name)
            .column("dt [tau]", |(_, p)| p.dt)
            .column("position error [sigma]", |(_, p)| p.position_error)
            .column("energy RMS [epsilon]", |(_, p)| p.energy_rms)
            .column("energy change [epsilon]", |(_, p)| p.energy_change)
            .column("strain", |(_, p)| p.strain)
            .column("cost [ns per bond and step]", |(w, _)| w.cost[0])
            .table(),
        Table::rows_of("model-errors", &found.model_errors)
            .column("stiffness [epsilon/sigma^2]", |m| m.0)
            .column("distance from rigid [sigma]", |m| m.1)
            .table(),
        Table::rows_of("rates", &relaxing.rates)
            .column("bonds", |r| r.bonds)
            .column("angle [rad]", |r| r.angle)
            .column("over-relaxation", |r| r.over_relaxation)
            .column("rate by theory", |r| r.theory)
            .column("rate measured", |r| r.measured)
            .column("sweeps to 1e-12 by theory", |r| r.sweeps)
            .table(),
        Table::rows_of("tolerances", &relaxing.tolerances)
            .column("dt [tau]", |t| t.dt)
            .column("tolerance", |t| t.tolerance)
            .column("energy RMS [epsilon]", |t| t.energy_rms)
            .column("bound [epsilon]", |t| t.bound)
            .column("sweeps per step", |t| t.sweeps)
            .table(),
        Table::rows_of("rotor", &relaxing.slowing)
            .column("step", |s| s.step)
            .column("angle by theory [rad]", |s| s.theory)
            .column("angle measured [rad]", |s| s.measured)
            .table(),
        Table::rows_of("solved", &solved)
            .column("problem", |(s, _)| s.problem)
            .column("way", |(s, _)| s.way)
            .column("dt", |(_, e)| e.0)
            .column("position error", |(_, e)| e.1)
            .table(),
        Table::rows_of("spook-map", &found.maps.points)
            .column("omega h", |p| p.phase)
            .column("tau/h", |p| p.damping)
            .column("radius by theory", |p| p.theory)
            .column("radius measured", |p| p.measured)
            .table(),
        Table::rows_of("penalty", &collisions.stiff)
            .column("omega h", |s| s.phase)
            .column("mean gain", |s| s.gain)
            .column("RMS", |s| s.rms)
            .column("depth over v/omega", |s| s.depth)
            .table(),
        Table::rows_of("bounces", &bounces)
            .column("rule", |(b, _)| b.rule)
            .column("restitution", |(b, _)| b.restitution)
            .column("time [tau]", |(_, p)| p.0)
            .column("height [sigma]", |(_, p)| p.1)
            .table(),
        Table::rows_of("drifts", &found.drifts)
            .column("way", |d| d.way)
            .column("density [1/sigma^3]", |d| d.density)
            .column("dt [tau]", |d| d.dt)
            .column("drift [epsilon/tau per molecule]", |d| d.drift)
            .column("error of the drift", |d| d.error)
            .column("RMS [epsilon per molecule]", |d| d.rms)
            .column("-h <T r Omega^2>", |d| d.law)
            .table(),
        Table::rows_of("states", &found.states)
            .column("density [1/sigma^3]", |s| s.density)
            .column("T of half steps [epsilon/k_B]", |s| s.temperature)
            .measured("u [epsilon per molecule]", |s| Some(s.energy))
            .measured("p [epsilon/sigma^3]", |s| Some(s.pressure))
            .column("u by Lisal", |s| s.lisal.0)
            .column("p by Lisal", |s| s.lisal.1)
            .column("u by Mecke", |s| s.mecke.0)
            .column("p by Mecke", |s| s.mecke.1)
            .table(),
        Table::rows_of("wall-pressure", &found.pressure.points)
            .column("time [tau]", |p| p.time)
            .column("P of walls", |p| p.of_walls)
            .column("P of virial", |p| p.of_virial)
            .column("P of virial less boundary term", |p| p.with_boundary)
            .table(),
    ]
}

/// Each way in a line.
fn ways(found: &MechanicsMeasurements) -> Table {
    let caption = format!(
        "Order of the position error, where it falls as a power of h, and RMS of the energy at the step nearest to 0.0025 τ. The largest stable step is for a rotor with Ω = 2 τ⁻¹ \
         that also vibrates, and was looked for up to {LARGEST_STEP} τ. The time is the fastest of a whole step without pair forces, per bond."
    );
    let near = |w: &super::comparison::WayResults| {
        let off = |p: &&super::comparison::AtStep| (p.dt / 0.0025).ln().abs();
        let nearest = w.points.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map(|p| p.energy_rms)
    };
    Table::rows_of("ways-in-a-line", &found.ways)
        .caption(caption)
        .column("Way", |w| &w.name)
        .column("Order", |w| match w.convergence {
            Convergence::Order(order) => Cell::rounded(order, 3),
            Convergence::Model => Cell::words("error of the model"),
            Convergence::Unsettled => Cell::words("no power of h"),
        })
        .column("RMS of E [ε]", |w| Cell::rounded(near(w), 3))
        .column("Largest stable step [τ]", |w| match w.largest_step {
            Some(step) => Cell::rounded(step, 3),
            None => Cell::words(format!("none up to {LARGEST_STEP}")),
        })
        .column("Dumbbell [ns per bond]", |w| Cell::rounded(w.cost[0], 3))
        .column("Chain of 10 [ns per bond]", |w| Cell::rounded(w.cost[1], 3))
        .table()
}

/// Problems with known solutions.
fn solved(found: &MechanicsMeasurements) -> Table {
    Table::rows_of("solved-in-a-line", &found.solved)
        .caption("Largest error of a position at the end, at the smallest step.")
        .column("Problem", |s| s.problem)
        .column("Way", |s| s.way)
        .column("Step", |s| Cell::rounded(s.errors.last().map(|e| e.0), 3))
        .column("Error", |s| Cell::rounded(s.errors.last().map(|e| e.1), 3))
        .column("Order", |s| Cell::rounded(s.order, 3))
        .table()
}

/// Restitution of damped springs.
fn damped(found: &MechanicsMeasurements) -> Table {
    Table::rows_of("damped-springs", &found.collisions.damped)
        .caption("Soft walls with a dashpot at ωh = 0.1, over all phases of the step.")
        .column("Law", |d| d.law)
        .column("e set", |d| Cell::rounded(d.set, 3))
        .column("mean e", |d| Cell::rounded(d.mean, 5))
        .column("farthest hit", |d| Cell::rounded(d.farthest, 2))
        .table()
}

/// Rows of balls.
fn cradles(found: &MechanicsMeasurements) -> Table {
    let row = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(|v| format!("{v:.4}")).collect();
        Cell::figures(words.join(", "))
    };
    Table::rows_of("cradles", &found.collisions.cradles)
        .caption("Equal balls in a row that touch; the first has speed 1.")
        .column("Rule", |c| c.rule)
        .column("Velocities after", |c| row(&c.velocities))
        .column("Known", |c| row(&c.known))
        .table()
}

/// Drifts of fluids.
fn drifts(found: &MechanicsMeasurements) -> Table {
    Table::rows_of("drifts-in-a-line", &found.drifts)
        .caption(
            "Fluids of 108 dumbbells at constant energy. The error is of the slope of ten means.",
        )
        .column("Way", |d| d.way)
        .column("ρ [σ⁻³]", |d| Cell::rounded(d.density, 3))
        .column("h [τ]", |d| Cell::rounded(d.dt, 3))
        .column("drift [ε/τ per molecule]", |d| {
            if d.error.is_finite() {
                Cell::measured(d.drift, d.error)
            } else {
                Cell::words("failed")
            }
        })
        .column("RMS [ε per molecule]", |d| Cell::rounded(d.rms, 3))
        .table()
}
