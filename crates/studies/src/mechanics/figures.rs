//! The figures of the study: a row for each, with the table that has its numbers.

use std::f64::consts::PI;

use lennard_core::Table;

use super::comparison::{LARGEST_STEP, WayResults};
use super::maps::{DAMPING, theory};
use super::study::MechanicsMeasurements;
use super::tables;
use crate::report::{Axis, Columns, Dash, FigureRow, Guide, Look, Picture, Series, Symbol};

/// A vertical line in figures against ωh for s = ∞ stands here.
const AT_INFINITY: f64 = 60.0;

fn disc(_: usize) -> Look {
    Look::Points(Symbol::Disc)
}

fn ring(_: usize) -> Look {
    Look::Points(Symbol::Ring)
}

fn dashed(_: usize) -> Look {
    Look::Line(Dash::Dashed)
}

fn dotted(_: usize) -> Look {
    Look::Line(Dash::Dotted)
}

/// All figures.
pub(super) fn drawn(found: &MechanicsMeasurements) -> Vec<Picture> {
    let tables = drawn_tables(found);
    let table = |name: &str| tables.iter().find(|table| table.name == name).cloned();
    let rows = [bonds(found), relaxation(), walls(found), fluids()].concat();
    rows.into_iter().filter_map(|row| row.draw(table)).collect()
}

/// The tables of the study with columns that are drawn alone.
fn drawn_tables(found: &MechanicsMeasurements) -> Vec<Table> {
    let drift_of = |way: &str| -> Vec<f64> {
        let at_one_step = |d: &super::fluid::FluidDrift| d.way == way && d.dt == 0.002;
        let drift = |d| if at_one_step(d) { d.drift } else { f64::NAN };
        found.drifts.iter().map(drift).collect()
    };
    let relaxing = &found.relaxing;
    let sweeps_if = |is_drawn: fn(&super::relaxing::Rate) -> bool| -> Vec<f64> {
        let sweeps = |r| if is_drawn(r) { sweeps(r.measured) } else { f64::NAN };
        relaxing.rates.iter().map(sweeps).collect()
    };
    let points = found.ways.iter().flat_map(|w| w.points.iter().map(|p| w.cost[0] / p.dt));
    let with = |table: Table, name: &str, numbers: Vec<f64>| table.with(name, "", numbers);
    let extended = |table: Table| match table.name.as_str() {
        "ways" => with(table, "cost of a time", points.clone().collect()),
        "rates" => {
            let straight = sweeps_if(|r| r.angle == 0.0 && r.over_relaxation == 1.0);
            let table = with(table, "sweeps on straight chains", straight);
            with(table, "sweeps with over-relaxation", sweeps_if(|r| r.over_relaxation != 1.0))
        }
        "spook-map" => {
            let places = found.maps.points.iter().map(|p| p.phase.min(AT_INFINITY));
            with(table, "place", places.collect())
        }
        "penalty" => {
            let sizes = found.collisions.stiff.iter().map(|hit| hit.gain.abs());
            with(table, "size of the gain", sizes.collect())
        }
        "drifts" => {
            let new = "relaxation, new direction";
            let is_new = |d: &super::fluid::FluidDrift| d.way == new && d.dt == 0.002;
            let law = found.drifts.iter().map(|d| if is_new(d) { d.law } else { f64::NAN });
            let table = with(table, "law", law.collect());
            let table = with(table, "new direction", drift_of(new));
            with(table, "direct", drift_of("direct"))
        }
        _ => table,
    };
    tables::csv(found).into_iter().map(extended).collect()
}

/// Sweeps of a rate for a factor of 10⁻¹².
fn sweeps(rate: f64) -> f64 {
    -12.0 * 10.0_f64.ln() / rate.ln()
}

/// Errors of each way against the step and against the cost, and the largest steps.
fn bonds(found: &MechanicsMeasurements) -> Vec<FigureRow<'static>> {
    let of_ways = |x, y| vec![Columns::new("{}", [x, y], Look::joined).by("way")];
    let row = |name, title, x, y| FigureRow {
        name,
        title,
        x: Axis::logarithmic(x),
        y: Axis::logarithmic(y),
        table: "ways",
        ..FigureRow::default()
    };
    let error = "error of a position / σ";
    vec![
        FigureRow {
            columns: of_ways("dt", "position error"),
            caption: "Two dumbbells that meet, at t = 2.5 τ, against rigid dumbbells in high precision. \
                      Springs end at the error of their model, which falls as 1/k; a line ends where a run fails."
                .into(),
            ..row("ways-error", "Bonds held in each way: error", "h / τ", error)
        },
        FigureRow {
            columns: of_ways("dt", "energy RMS"),
            caption: "RMS of the energy on the same run. SPOOK publishes velocities half a step behind: its RMS falls as h alone."
                .into(),
            ..row("ways-energy", "Bonds held in each way: energy", "h / τ", "RMS of E − E(0) / ε")
        },
        FigureRow {
            columns: of_ways("cost of a time", "position error"),
            caption: "The same errors against what a bond costs for a time of 1 τ: kick, drift and bond, without pair forces. \
                      Costs are the fastest of repeated blocks."
                .into(),
            ..row(
                "ways-cost",
                "Bonds held in each way: error against cost",
                "ns per bond and τ of motion",
                error,
            )
        },
        FigureRow {
            theory: largest_steps(found),
            caption: format!(
                "The largest stable step of a rotor that vibrates, against the error that is left at the smallest step. \
                 Half the error of an explicit spring costs √2 times the steps. Marks at {LARGEST_STEP} τ had no limit up to there."
            ),
            ..row(
                "ways-limit",
                "Bonds held in each way: largest step",
                "error at the smallest step / σ",
                "largest stable step / τ",
            )
        },
    ]
}

/// The smallest error that a way reaches, and the largest step that it bears, with the law of springs.
fn largest_steps(found: &MechanicsMeasurements) -> Vec<Series> {
    let of = |way: &WayResults| {
        let smallest = way.points.last()?;
        Some((smallest.position_error, way.largest_step.unwrap_or(LARGEST_STEP)))
    };
    let ways = found.ways.iter().enumerate();
    let marks = ways.map(|(i, way)| Series::new(&way.name, Look::marks(i), i, of(way)));
    // Through the stiffest of the explicit springs.
    let stiffest = found.ways.iter().find(|way| way.name == "spring, k = 64000");
    let law = stiffest.and_then(of).map(|(error, step)| {
        let points = [1.0, 256.0].map(|more: f64| (error * more, step * more.sqrt()));
        Series::new("springs: error ∝ h²", dashed(0), found.ways.len(), points)
    });
    marks.chain(law).collect()
}

/// Sweeps, tolerances, the rotor that slows down, and the map of SPOOK.
fn relaxation() -> Vec<FigureRow<'static>> {
    let against_bonds = |name, look, color, rate: fn(f64) -> f64| {
        let points = (2..=100).map(|n| (f64::from(n), sweeps(rate(PI / f64::from(n + 1)))));
        Series::new(name, look, color, points)
    };
    let tolerance = |y, name| Columns::new(name, ["tolerance", y], Look::joined).by("dt");
    let dense = |k: u32| 0.1 * 400.0_f64.powf(f64::from(k) / 300.0);
    let map = |(i, damping): (usize, &f64)| {
        let points = (0..=300).map(dense).map(|s| (s, theory(s, *damping).radius()));
        Series::new("", Look::line(i), i, points)
    };
    vec![
        FigureRow {
            name: "sweeps",
            title: "Sweeps of relaxation against the length of a chain",
            x: Axis::logarithmic("bonds n"),
            y: Axis::logarithmic("sweeps for a factor of 10⁻¹²"),
            table: "rates",
            theory: vec![
                against_bonds("cos²(π/(n + 1))", Look::line(0), 0, |a| a.cos().powi(2)),
                against_bonds("best over-relaxation", dashed(1), 1, |a| {
                    2.0 / (1.0 + a.sin()) - 1.0
                }),
            ],
            columns: vec![
                Columns::new("measured", ["bonds", "sweeps on straight chains"], disc),
                Columns::new(
                    "measured, near the best ω",
                    ["bonds", "sweeps with over-relaxation"],
                    ring,
                )
                .at(1),
            ],
            caption: "Sweeps over a straight chain. The direct solve needs one to five iterations at any length."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "tolerance-energy",
            title: "Energy against the tolerance",
            x: Axis::logarithmic("tolerance"),
            y: Axis::logarithmic("RMS of E − E(0) / ε"),
            table: "tolerances",
            columns: vec![
                tolerance("energy RMS", "h = {} τ"),
                Columns::new("", ["tolerance", "bound"], dotted).by("dt"),
            ],
            caption: "Two dumbbells that meet, with relaxation. With a loose tolerance a shorter step does not help. Dotted: ½μ·(tol·r/h)² of both bonds, \
                      which velocities would have that kept the corrections; the velocity stage here is exact and takes most of it off."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "tolerance-sweeps",
            title: "Sweeps against the tolerance",
            x: Axis::logarithmic("tolerance"),
            y: Axis::linear("sweeps per step"),
            table: "tolerances",
            columns: vec![tolerance("sweeps per step", "h = {} τ")],
            caption: "Sweeps per step on the same runs.".into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "rotor",
            title: "A rotor under projection along the new bond",
            x: Axis::logarithmic("step n"),
            y: Axis::logarithmic("angle per step / rad"),
            table: "rotor",
            columns: vec![
                Columns::new("α₀/√(1 + 2α₀²n)", ["step", "angle by theory"], Look::line),
                Columns::new("measured", ["step", "angle measured"], disc),
            ],
            caption: "A free dumbbell at α₀ = 0.1. Along the old bond it turns by the same angle for ever."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "spook-amplification",
            title: "Amplification of SPOOK on a damped spring",
            x: Axis::logarithmic("ωh").from_to(0.1, 100.0),
            y: Axis::linear("spectral radius of the one-step map").from_to(0.0, 1.1),
            table: "spook-map",
            theory: DAMPING.iter().enumerate().map(map).collect(),
            columns: vec![
                Columns::new("τ = {} h", ["place", "radius measured"], Look::marks).by("tau/h"),
            ],
            guides: vec![Guide::Vertical(AT_INFINITY, "ε = 0".into())],
            caption: "Lines: [[1 − q, p], [−q, p]] with p = γ(s² + 4)/(s² + 4γ), q = 4γs²/(s² + 4γ). Marks: three states of a run. Marks on the \
                      vertical line are ε = 0; there τ = 2h has the smallest radius, 1/3."
                .into(),
        },
    ]
}

/// Springs of walls, bouncing balls, and the pressure between walls.
fn walls(found: &MechanicsMeasurements) -> Vec<FigureRow<'static>> {
    let phase = || Axis::linear("ωh").from_to(0.0, 2.0);
    let balls = found.collisions.bouncing.iter().filter(|ball| ball.rule != "billiard");
    let path = |(i, ball): (usize, &super::collisions::Bouncing)| {
        let name = format!("{}, e = {}", ball.rule, ball.restitution);
        Series::new(name, Look::line(i), i, ball.path.iter().copied())
    };
    let pressure = |name, column, look| Columns::new(name, ["time", column], look);
    vec![
        FigureRow {
            name: "penalty-energy",
            title: "A penalty force that is too strong",
            x: phase(),
            y: Axis::logarithmic("change of the energy per hit").from_to(1e-8, 10.0),
            table: "penalty",
            columns: vec![
                Columns::new("mean gain", ["omega h", "size of the gain"], Look::joined),
                Columns::new("RMS of the change", ["omega h", "RMS"], Look::joined).at(1),
            ],
            caption: "Hits of an undamped spring under velocity Verlet, over all phases of the step. The gain is not monotonic: \
                      near ωh = 1 half a period is three steps."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "penalty-depth",
            title: "Depth of a penalty contact",
            x: phase(),
            y: Axis::linear("greatest depth over v/ω"),
            table: "penalty",
            columns: vec![
                Columns::new("measured", ["omega h", "depth over v/omega"], Look::joined),
            ],
            guides: vec![Guide::Horizontal(1.0, "theory".into())],
            caption: "How deep a particle gets, over v/ω = v·√(m/k). A wall of thickness D holds particles with v < ω·D alone: that is the weak end."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "bounces",
            title: "A bouncing ball",
            x: Axis::linear("t / τ").from_to(0.0, 12.0),
            y: Axis::linear("height / σ").from_to(0.0, 1.3),
            table: "bounces",
            theory: balls.enumerate().map(path).collect(),
            caption: "Dropped from 1 σ with g = 1, h = 0.01 τ. Under the event rule heights fall as e²ⁿ; a mirror gains energy; a projection keeps none."
                .into(),
            ..FigureRow::default()
        },
        FigureRow {
            name: "wall-pressure",
            title: "Pressure on hard walls and pressure of the virial",
            x: Axis::logarithmic("t / τ"),
            y: Axis::linear("P / ε σ⁻³"),
            table: "wall-pressure",
            columns: vec![
                pressure("virial", "P of virial", |_| Look::Line(Dash::Solid)).at(1),
                pressure("virial less boundary term", "P of virial less boundary term", dashed).at(2),
                pressure("walls", "P of walls", disc),
            ],
            caption: "108 atoms between hard walls (ρ = 0.6, T = 1.5), from the momentum of hits and from speeds and forces. \
                      With the boundary term both are one number at each step."
                .into(),
            ..FigureRow::default()
        },
    ]
}

/// Fluids of dumbbells: the drift of their energy, and the equations of state.
fn fluids() -> Vec<FigureRow<'static>> {
    let drift = |name, column, look| Columns::new(name, ["density", column], look);
    let state = |name, title, y, [measured, lisal, mecke]: [&'static str; 3]| {
        FigureRow {
        name,
        title,
        x: Axis::linear("ρ / molecules per σ³"),
        y: Axis::linear(y),
        table: "states",
        columns: vec![
            Columns::new("Lísal 2004", ["density", lisal], Look::joined).at(1),
            Columns::new("Mecke 1997", ["density", mecke], Look::joined).at(2),
            Columns::new("measured", ["density", measured], disc),
        ],
        caption: "Rigid dumbbells, L = 0.67 σ, at T near 2.4, with the tail correction; the equations at the measured temperature of half steps."
            .into(),
        ..FigureRow::default()
    }
    };
    vec![
        FigureRow {
            name: "drift-density",
            title: "Drift of the energy against density",
            x: Axis::linear("ρ / molecules per σ³"),
            y: Axis::linear("drift / ε per τ and molecule"),
            table: "drifts",
            columns: vec![
                drift("relaxation, new direction", "new direction", Look::joined),
                drift("−h·⟨T_b·r·Ω²⟩", "law", dashed).at(2),
                drift("direct", "direct", Look::joined).at(1),
            ],
            guides: vec![Guide::Horizontal(0.0, String::new())],
            caption: "Fluids of dumbbells (L = 0.67 σ, T near 2, h = 0.002 τ) at constant energy. The projection cools a gas and heats a dense liquid: \
                      where its line crosses zero, a single state point would prove nothing."
                .into(),
            ..FigureRow::default()
        },
        state("states-energy", "Energy of dumbbells", "u / ε per molecule", ["u", "u by Lisal", "u by Mecke"]),
        state("states-pressure", "Pressure of dumbbells", "p / ε σ⁻³", ["p", "p by Lisal", "p by Mecke"]),
    ]
}
