//! Any property against what the sweep changes, with the equation of state where there is one.

use std::collections::BTreeSet;

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol};
use lennard_literature::{EquationOfState, Property, equation_of_state_for, property};
use lennard_observables::quantities::{Mark, axis, has_mark};
use lennard_scene::study::{SHORT_KEYS, ShortKey};

use super::averaged::{Averaged, averaged};
use super::blocks::StudyPoints;
use crate::compare::{capital, quantity_words};
use crate::sweep::{Setting, SettingValue};

/// Most series of one figure.
const MOST_SERIES: usize = 6;
/// Points of a line.
const STEPS: usize = 120;

/// Every primary property against the key with the most values, but for those that other readings have drawn.
pub(super) fn pictures(study: &StudyPoints<'_>) -> Vec<Picture> {
    let is_drawn = |name: &str| study.drawn.iter().any(|drawn| drawn == name);
    let points = averaged(study.swept);
    let Some(key) = swept_axis(&points) else {
        return Vec::new();
    };
    let label = short_key(&key).map_or(&*key, |short| short.label);
    let groups = series_of(&points, &key);
    if groups.len() > MOST_SERIES {
        return Vec::new();
    }
    let mut names: Vec<(&str, &str)> = Vec::new();
    let rows = study.swept.iter().filter_map(|p| p.compared.as_ref());
    for row in rows.flat_map(|c| &c.rows).filter(|row| row.primary) {
        let name = (row.quantity.as_str(), row.unit.as_str());
        if !names.contains(&name) && !is_drawn(name.0) && is_worth_drawing(name.0, &key) {
            names.push(name);
        }
    }
    let model = study.sweep.points.first().map(|p| lennard_scene::model_kind(&p.scene));
    let judged = study.swept.iter().filter_map(|p| p.compared.as_ref());
    let has_equation = judged.into_iter().any(|c| c.equation.is_some());
    let equation =
        model.filter(|_| has_equation).and_then(|model| equation_of_state_for(model).ok());
    names.into_iter().filter_map(|name| picture(name, (&key, label), &groups, equation)).collect()
}

/// The temperature is what was asked for, and densities of slabs have a figure of their own.
fn is_worth_drawing(quantity: &str, key: &str) -> bool {
    let temperature = quantity.starts_with("temperature") && key != "dt";
    !temperature && !has_mark(quantity, Mark::Coexisting)
}

/// The short name of a key, where it has one.
fn short_key(key: &str) -> Option<&'static ShortKey> {
    SHORT_KEYS.iter().find(|short| short.name == key)
}

/// The key with the most numbers, of two or more: short names first.
fn swept_axis(points: &[Averaged<'_>]) -> Option<String> {
    let values = |key: &str| -> usize {
        let bits = points.iter().filter_map(|p| p.setting(key));
        bits.map(f64::to_bits).collect::<BTreeSet<u64>>().len()
    };
    let others = points.iter().flat_map(|p| p.settings).map(|s| s.key.as_str());
    let keys = || SHORT_KEYS.iter().map(|short| short.name).chain(others.clone());
    let most = keys().map(values).max()?;
    let axis = keys().find(|key| values(key) == most)?;
    (most >= 2).then(|| axis.to_owned())
}

/// Points that differ in one key alone, in the order of the sweep, each sorted by this key.
pub(super) fn series_of<'a, 'b>(
    points: &'a [Averaged<'b>],
    key: &str,
) -> Vec<Vec<&'a Averaged<'b>>> {
    let others = |p: &Averaged<'b>| -> Vec<&'b Setting> {
        p.settings.iter().filter(|s| s.key != key).collect()
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
    let in_words = |s: &Setting| match (short_key(&s.key), &s.value) {
        (Some(short), value) => format!("{} = {value}", short.symbol),
        (None, SettingValue::Number(value)) => format!("{} = {value}", s.key),
        (None, SettingValue::Words(words)) => words.clone(),
    };
    let shared: Vec<String> =
        point.settings.iter().filter(|s| s.key != key).map(in_words).collect();
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
    let mut figure = Figure::new(
        format!("{quantity}_over_{key}"),
        capital(&words),
        Axis::linear(label),
        Axis::linear(axis(&words, unit)),
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
