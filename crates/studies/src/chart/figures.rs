//! The diagrams as figures: cost along, error up.

use std::collections::BTreeSet;

use lennard_engine::stopwatch::BUSY;
use lennard_forcefield::{Precision, TruncationKind};

use super::panels::front;
use super::types::{Axis, Chart, ChartedPoint, Mark, Panel};
use crate::lists::unique;
use crate::report::{
    self, Dash, Figure, Guide, Look, Picture, Point, Series, Symbol, plus_minus, significant,
};

/// Colour of the front and of legend entries that are about symbols.
const DARK: usize = 6;

/// The picture that comes first: the errors of P, U and forces against cost, each with its front.
/// `None` where nothing is known yet.
pub(super) fn overview(chart: &Chart) -> Option<Picture> {
    let by = chart.cost_by;
    let shown: Vec<(&Panel, &str)> =
        chart.panels.iter().filter_map(|p| Some((p, p.in_overview.as_deref()?))).collect();
    let names: Vec<&str> = shown.iter().map(|(_, name)| *name).collect();
    let mut figure = Figure::new(
        "overview",
        "Errors against cost",
        report::Axis::logarithmic(cost_label(chart, by)),
        report::Axis::logarithmic(format!("error: {}", names.join(", "))),
    );
    for (color, (panel, name)) in shown.into_iter().enumerate() {
        let floor = panel.floor.unwrap_or(0.0);
        let marks: Vec<&Mark> = (panel.marks.iter())
            .filter(|m| chart.is_comparable(m.number) && m.error.is_some())
            .collect();
        let on_front: Vec<&Mark> = front(&marks, by, floor).into_iter().map(|i| marks[i]).collect();
        let size = |m: &Mark| m.error.unwrap_or(f64::NAN).abs();
        let points = marks.iter().map(|m| point(chart, m, by, size(m), None));
        let look = Look::Points(SYMBOLS[color + 1]);
        figure = figure
            .with(staircase(String::new(), &on_front, by, floor, color))
            .with(Series::new(name, look, color, points.collect::<Vec<_>>()));
    }
    let own = chart.panels.iter().find_map(|panel| panel.mark(1));
    if let Some(own) = own {
        figure = figure.guided(Guide::Vertical(cost(own, by), "scene".into()));
    }
    figure = figure.with(Series::entry("front", Look::Line(Dash::Dashed), DARK));
    let scatter = chart.scatter();
    let counted = match by {
        Axis::Wall => String::new(),
        Axis::Forces => format!(
            " Timings of the same settings differ by {:.0} %: cost is counted in pair forces, which depend on no clock. Only settings of the \
             scene's own precision and kind of list are drawn, since a pair force costs the same there.",
            100.0 * scatter
        ),
    };
    let busy = match by {
        Axis::Wall if scatter > BUSY => {
            " Clocks were disturbed: bars along the cost say by how much."
        }
        _ => "",
    };
    let caption = format!(
        "Left is cheap and low is right. \"scene\" marks the cost of the scene's own settings. Dashed lines are the fronts: nothing left of them \
         errs as little. Bars are one standard error: what lies within its bar of zero is not told from zero.{counted}{busy}"
    );
    (!figure.is_empty()).then(|| Picture::new(figure, caption, "points.csv"))
}

/// The figures of a panel, by both costs; none where there is nothing to show.
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

fn cost_label(chart: &Chart, axis: Axis) -> &'static str {
    match axis {
        Axis::Wall => "wall time / (µs per atom and τ)",
        Axis::Forces if chart.cost_by == Axis::Forces => {
            "pair forces per atom and τ (clocks were disturbed)"
        }
        Axis::Forces => "pair forces per atom and τ",
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
    let [x, y] = [cost_label(chart, axis), &panel.label].map(report::Axis::logarithmic);
    let mut figure = Figure::new(name(panel, axis), &panel.title, x, y);
    if let Some(floor) = panel.floor {
        figure = figure.guided(Guide::UpTo(floor, panel.floor_words.into()));
    }
    let mut on_front: Vec<&Mark> = panel.marks.iter().filter(|m| m.on_front(axis)).collect();
    on_front.sort_by(|a, b| a.cost(axis).total_cmp(&b.cost(axis)));
    let floor = panel.floor.unwrap_or(0.0);
    figure = figure.with(staircase("Pareto front".into(), &on_front, axis, floor, DARK));
    let (mut groups, mut methods) = (BTreeSet::new(), BTreeSet::new());
    for mark in &panel.marks {
        let Some(charted) = chart.point(mark.number) else {
            continue;
        };
        let (group, (symbol, method)) = (group(charted), method(chart, charted));
        groups.insert(group);
        let look = Look::Points(SYMBOLS[symbol]);
        figure = figure.with(match mark.error {
            Some(error) => {
                let label = label(charted, mark, axis);
                Series::new("", look, group, vec![point(chart, mark, axis, error.abs(), label)])
            }
            None => {
                let (x, note) = (cost(mark, axis), Some(note(chart, mark)));
                Series::entry("", look, group).with_failures([Point {
                    x,
                    note,
                    ..Point::default()
                }])
            }
        });
        methods.insert((symbol, method));
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

/// What colours stand for: ways to end the potential.
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
    let names = unique(chart.points.iter().map(|p| p.settings.integrator.name()));
    let own = point.settings.integrator.name();
    let place = names.iter().position(|n| *n == own).unwrap_or(0);
    // The last symbol stands for all that come after the seventh.
    let symbol = (place + 1).min(SYMBOLS.len() - 1);
    let name = if place + 1 > SYMBOLS.len() - 1 { "other methods" } else { own };
    (symbol, name.to_owned())
}

/// A mark as a point of a figure; `y` is its error as it is drawn.
fn point(chart: &Chart, mark: &Mark, axis: Axis, y: f64, label: Option<String>) -> Point {
    let range = mark.wall_range.filter(|_| axis == Axis::Wall);
    Point {
        x: cost(mark, axis),
        y,
        error: mark.standard_error,
        note: Some(note(chart, mark)),
        x_range: range.map(|(low, high)| (1e6 * low, 1e6 * high)),
        label,
        link: None,
    }
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
        chart.label(mark.number),
        significant(mark.pair_forces, 3)
    )
}

/// The front as a staircase: what can be had for so much. The marks stand in the order of their cost.
fn staircase(name: String, front: &[&Mark], axis: Axis, floor: f64, color: usize) -> Series {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for mark in front {
        let (x, y) = (cost(mark, axis), mark.error.unwrap_or(f64::NAN).abs().max(floor));
        if let Some((_, above)) = line.last() {
            line.push((x, *above));
        }
        line.push((x, y));
    }
    Series::new(name, Look::Line(Dash::Dashed), color, line)
}
