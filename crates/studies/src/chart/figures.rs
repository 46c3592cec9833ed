//! The diagrams as figures: cost along, error up, both logarithmic.

use std::collections::BTreeSet;

use crate::report::{
    Dash, FailedPoint, Figure, Guide, Look, Picture, Point, Series, Symbol, plus_minus, significant,
};
use lennard_forcefield::{Precision, TruncationKind};

use super::panels::{Axis, Mark, Panel};
use super::{Chart, ChartedPoint, tables};

/// Colour of the front and of legend entries that are about symbols.
const DARK: usize = 6;

/// Both figures of a panel; none where it has nothing to show.
pub(super) fn of(chart: &Chart, panel: &Panel) -> Vec<Picture> {
    let has_value = |m: &Mark| m.error.is_some_and(|e| e != 0.0);
    if !panel.marks.iter().any(has_value) {
        return Vec::new();
    }
    [Axis::Wall, Axis::Forces].map(|axis| figure(chart, panel, axis)).into()
}

/// File stem of a figure.
fn name(panel: &Panel, axis: Axis) -> String {
    match axis {
        Axis::Wall => format!("{}-wall", panel.name),
        Axis::Forces => format!("{}-forces", panel.name),
    }
}

/// Costs are drawn in µs.
fn cost(mark: &Mark, axis: Axis) -> f64 {
    match axis {
        Axis::Wall => 1e6 * mark.wall,
        Axis::Forces => mark.pair_forces,
    }
}

fn figure(chart: &Chart, panel: &Panel, axis: Axis) -> Picture {
    let x = match axis {
        Axis::Wall => "wall time / (µs per atom and τ)",
        Axis::Forces => "pair forces per atom and τ",
    };
    let mut figure = Figure::new(
        name(panel, axis),
        panel.title,
        crate::report::Axis::logarithmic(x),
        crate::report::Axis::logarithmic(panel.label),
    );
    if let Some(floor) = panel.floor {
        figure = figure.guided(Guide::UpTo(floor, panel.floor_words.into()));
    }
    figure = figure.with(front_line(panel, axis));
    let (mut groups, mut methods) = (BTreeSet::new(), BTreeSet::new());
    for mark in &panel.marks {
        let Some(point) = chart.points.iter().find(|p| p.number == mark.number) else {
            continue;
        };
        let group = group(point);
        groups.insert(group);
        methods.insert(method(chart, point));
        figure = figure.with(one(chart, point, mark, axis, group));
    }
    let entry = |name: &str, symbol, color| Series::entry(name, Look::Points(symbol), color);
    for group in groups {
        figure = figure.with(entry(GROUPS[group], Symbol::Disc, group));
    }
    for (symbol, name) in methods {
        figure = figure.with(entry(&name, SYMBOLS[symbol], DARK));
    }
    let caption = match axis {
        Axis::Wall => panel.about.clone(),
        Axis::Forces => {
            "The same against the number of pair forces, which depends on no machine.".into()
        }
    };
    Picture::new(figure, caption, format!("{}.csv", panel.name))
}

const GROUPS: [&str; 7] = [
    "cut, with tail",
    "cut, without tail",
    "shifted",
    "force-shifted",
    "switched",
    "another engine",
    "another truncation",
];

fn group(point: &ChartedPoint) -> usize {
    let t = &point.settings.truncation;
    match t.kind {
        _ if point.engine.is_some() => 5,
        TruncationKind::Cut if t.tail_correction => 0,
        TruncationKind::Cut => 1,
        TruncationKind::Shift => 2,
        TruncationKind::ForceShift => 3,
        TruncationKind::Switch => 4,
        _ => 6,
    }
}

const SYMBOLS: [Symbol; 8] = [
    Symbol::Ring,
    Symbol::Disc,
    Symbol::Square,
    Symbol::Triangle,
    Symbol::Diamond,
    Symbol::Wedge,
    Symbol::Plus,
    Symbol::Frame,
];

/// Index of the symbol and what it stands for: the method, or mixed precision whatever the method.
fn method(chart: &Chart, point: &ChartedPoint) -> (usize, String) {
    if point.settings.precision == Precision::Mixed {
        return (0, "mixed precision".into());
    }
    let mut names: Vec<&str> = Vec::new();
    for p in &chart.points {
        let name = p.settings.integrator.name();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let own = point.settings.integrator.name();
    let place = names.iter().position(|n| *n == own).unwrap_or(0);
    // The last symbol stands for all that come after the seventh.
    let symbol = (place + 1).min(SYMBOLS.len() - 1);
    let name = if place + 1 > SYMBOLS.len() - 1 { "other methods" } else { own };
    (symbol, name.to_owned())
}

/// One point, or one failure.
fn one(chart: &Chart, point: &ChartedPoint, mark: &Mark, axis: Axis, color: usize) -> Series {
    let x = cost(mark, axis);
    let note = note(chart, mark);
    let look = Look::Points(SYMBOLS[method(chart, point).0]);
    let Some(error) = mark.error else {
        let failed = FailedPoint { x, note: Some(note) };
        return Series::entry("", look, color).with_noted_failures(vec![failed]);
    };
    let shown = Point {
        x,
        y: error.abs(),
        error: mark.standard_error,
        note: Some(note),
        x_range: mark
            .wall_range
            .filter(|_| axis == Axis::Wall)
            .map(|(low, high)| (1e6 * low, 1e6 * high)),
        label: label(point, mark, axis),
        link: None,
    };
    Series::new("", look, color, vec![shown])
}

/// The label beside a mark: a name for the scene's own settings and the usual ones, a number on the front.
fn label(point: &ChartedPoint, mark: &Mark, axis: Axis) -> Option<String> {
    match point {
        _ if point.number == 1 => Some("scene".into()),
        _ if point.engine.is_none() && point.settings.are_usual() => Some("usual".into()),
        _ => mark.on_front(axis).then(|| mark.number.to_string()),
    }
}

/// The note that appears when a reader points at a mark.
fn note(chart: &Chart, mark: &Mark) -> String {
    let value = match (mark.error, mark.standard_error, &mark.failure) {
        (Some(e), Some(se), _) => format!("error {}", plus_minus(e, se)),
        (Some(e), None, _) => format!("error {}", significant(e, 3)),
        (None, _, Some(why)) => format!("failed: {why}"),
        (None, _, None) => "no value".into(),
    };
    let wall = significant(1e6 * mark.wall, 3);
    let range = mark.wall_range.map_or_else(
        || "estimated".into(),
        |(low, high)| format!("{} to {}", significant(1e6 * low, 3), significant(1e6 * high, 3)),
    );
    format!(
        "{}: {}\n{value}\n{wall} µs per atom and τ ({range}), {} pair forces",
        mark.number,
        tables::label(chart, mark.number),
        significant(mark.pair_forces, 3)
    )
}

/// The front as a staircase: what can be had for so much.
fn front_line(panel: &Panel, axis: Axis) -> Series {
    let mut front: Vec<&Mark> = panel.marks.iter().filter(|m| m.on_front(axis)).collect();
    front.sort_by(|a, b| a.cost(axis).total_cmp(&b.cost(axis)));
    let floor = panel.floor.unwrap_or(0.0);
    let mut line: Vec<(f64, f64)> = Vec::new();
    for mark in front {
        let (x, y) = (cost(mark, axis), mark.error.unwrap_or(f64::NAN).abs().max(floor));
        if let Some((_, above)) = line.last() {
            line.push((x, *above));
        }
        line.push((x, y));
    }
    Series::new("Pareto front", Look::Line(Dash::Dashed), DARK, line)
}
