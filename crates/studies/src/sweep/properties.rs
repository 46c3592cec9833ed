//! Any property against what the sweep changes, with the equation of state where there is one.

use std::collections::BTreeSet;

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol};
use lennard_literature::{EquationOfState, Property, equation_of_state_for, property};

use super::averaged::{Averaged, averaged};
use super::{Sweep, SweepRecord};
use crate::compare::quantity_words;

/// Most series of one figure.
const MOST_SERIES: usize = 6;
/// Points of a line.
const STEPS: usize = 120;

/// The keys of a sweep in words of an axis, with the symbol of a legend.
const AXES: [(&str, &str, &str); 7] = [
    ("density", "density ρ / σ⁻³", "ρ"),
    ("temperature", "T / (ε/k_B)", "T"),
    ("n_atoms", "number of particles N", "N"),
    ("n_molecules", "number of molecules M", "M"),
    ("bond_length", "bond length L / σ", "L"),
    ("r_cut", "cutoff r_cut / σ", "r_cut"),
    ("dt", "time step dt / τ", "dt"),
];

/// Every primary property against the key with the most values; `drawn` are names of figures that are there already.
pub(super) fn pictures(sweep: &Sweep, record: &SweepRecord, drawn: &[&str]) -> Vec<Picture> {
    let points = averaged(&record.points);
    let Some((key, label, _)) = swept_axis(&points) else {
        return Vec::new();
    };
    let groups = series_of(&points, key);
    if groups.len() > MOST_SERIES {
        return Vec::new();
    }
    let mut names: Vec<(&str, &str)> = Vec::new();
    let rows = record.points.iter().filter_map(|p| p.compared.as_ref());
    for row in rows.flat_map(|c| &c.rows).filter(|row| row.primary) {
        let name = (row.quantity.as_str(), row.unit.as_str());
        if !names.contains(&name) && !drawn.contains(&name.0) && is_worth_drawing(name.0, key) {
            names.push(name);
        }
    }
    let model = sweep.points.first().map(|p| lennard_scene::model_kind(&p.scene));
    let judged = record.points.iter().filter_map(|p| p.compared.as_ref());
    let has_equation = judged.into_iter().any(|c| c.equation.is_some());
    let equation =
        model.filter(|_| has_equation).and_then(|model| equation_of_state_for(model).ok());
    names.into_iter().filter_map(|name| picture(name, (key, label), &groups, equation)).collect()
}

/// The temperature is what was asked for, and densities of slabs have a figure of their own.
fn is_worth_drawing(quantity: &str, key: &str) -> bool {
    let temperature = quantity.starts_with("temperature") && key != "dt";
    let coexisting = ["liquid_density", "vapor_density"].contains(&quantity);
    !temperature && !coexisting
}

/// The key with the most values, of two or more.
fn swept_axis(points: &[Averaged<'_>]) -> Option<(&'static str, &'static str, &'static str)> {
    let values = |key: &str| -> usize {
        let bits = points.iter().filter_map(|p| p.setting(key));
        bits.map(f64::to_bits).collect::<BTreeSet<u64>>().len()
    };
    let most = AXES.iter().map(|(key, ..)| values(key)).max()?;
    let axis = AXES.iter().find(|(key, ..)| values(key) == most)?;
    (most >= 2).then_some(*axis)
}

/// Points that differ in one key alone, in the order of the sweep, each sorted by this key.
pub(super) fn series_of<'a, 'b>(
    points: &'a [Averaged<'b>],
    key: &str,
) -> Vec<Vec<&'a Averaged<'b>>> {
    let others = |p: &Averaged<'_>| -> Vec<(&'static str, u64)> {
        let others = p.settings.iter().filter(|s| s.key != key);
        others.map(|s| (s.key, s.value.to_bits())).collect()
    };
    let mut groups: Vec<Vec<&Averaged<'_>>> = Vec::new();
    for point in points.iter().filter(|p| p.setting(key).is_some()) {
        match groups.iter_mut().find(|g| others(g[0]) == others(point)) {
            Some(group) => group.push(point),
            None => groups.push(vec![point]),
        }
    }
    for group in &mut groups {
        let value = |p: &Averaged<'_>| p.setting(key).unwrap_or(f64::NAN);
        group.sort_by(|a, b| value(a).total_cmp(&value(b)));
    }
    groups
}

/// What the points of a series share, "ρ = 0.7, N = 500"; "measured" where they share nothing that was chosen.
pub(super) fn label_of(point: &Averaged<'_>, key: &str) -> String {
    let shared: Vec<String> = point
        .settings
        .iter()
        .filter(|s| s.key != key)
        .map(|s| {
            let symbol = AXES.iter().find(|(name, ..)| *name == s.key);
            format!("{} = {}", symbol.map_or(s.key, |(.., symbol)| symbol), s.value)
        })
        .collect();
    match shared.is_empty() {
        true => "measured".to_owned(),
        false => shared.join(", "),
    }
}

fn picture(
    (quantity, unit): (&str, &str),
    (key, label): (&str, &str),
    groups: &[Vec<&Averaged<'_>>],
    equation: Option<&'static dyn EquationOfState>,
) -> Option<Picture> {
    let words = quantity_words(quantity);
    let y = match unit.is_empty() {
        true => words.clone(),
        false => format!("{words} / {}", in_brackets(unit)),
    };
    let mut figure = Figure::new(
        format!("{quantity}_over_{key}"),
        capital(&words),
        Axis::linear(label),
        Axis::linear(y),
    );
    let mut has_line = false;
    for (color, group) in groups.iter().enumerate() {
        let marks: Vec<Point> = group
            .iter()
            .filter_map(|p| {
                let mean = p.mean(quantity)?;
                Some(Point {
                    error: Some(mean.error),
                    note: Some(p.name()),
                    link: p.page(),
                    ..Point::from((p.setting(key)?, mean.value))
                })
            })
            .collect();
        if marks.len() < 2 {
            continue;
        }
        let curve = equation.zip(property(quantity));
        let curve = curve.and_then(|(e, property)| line(e, property, key, group));
        if let Some(curve) = curve.filter(|c| !c.is_empty()) {
            has_line = true;
            figure = figure.with(Series::new("", Look::Line(Dash::Solid), color, curve));
        }
        let look = Look::Points(Symbol::cycle(color));
        figure = figure.with(Series::new(label_of(group[0], key), look, color, marks));
    }
    let name = equation.map_or("", |e| e.spec().name.as_str());
    let caption = match has_line {
        true => format!(
            "Bars are one standard error; seeds of one state are averaged. Lines are {name}."
        ),
        false => "Bars are one standard error; seeds of one state are averaged.".to_owned(),
    };
    (!figure.is_empty()).then(|| Picture::new(figure, caption, "table.csv"))
}

/// The equation along a series, where it covers the state and the state is a single phase; a gap elsewhere.
fn line(
    equation: &dyn EquationOfState,
    property: &Property,
    key: &str,
    group: &[&Averaged<'_>],
) -> Option<Vec<Point>> {
    let planned = &group[0].points[0].planned;
    let (from, to) = (group.first()?.setting(key)?, group.last()?.setting(key)?);
    let state = |x: f64| match key {
        "density" => Some((x, planned.temperature)),
        "temperature" => Some((planned.density, x)),
        _ => None,
    };
    state(from)?;
    let points = (0..=STEPS).filter_map(|i| {
        let x = from + (to - from) * f64::from(i as u32) / STEPS as f64;
        let (density, temperature) = state(x)?;
        let stable = equation.phase(density, temperature).is_stable();
        let y = match stable {
            true => (property.of)(&equation.at(density, temperature)),
            // Not a number breaks the line.
            false => f64::NAN,
        };
        Some(Point::from((x, y)))
    });
    let points: Vec<Point> = points.collect();
    points.iter().any(|p| p.y.is_finite()).then_some(points)
}

/// A unit that holds a stroke, in brackets.
fn in_brackets(unit: &str) -> String {
    match unit.contains('/') {
        true => format!("({unit})"),
        false => unit.to_owned(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}
