//! Any property against what the sweep changes, with the equation of state where there is one.

use std::collections::BTreeSet;

use lennard_literature::{EquationOfState, Property, equation_of_state_for, property};
use lennard_observables::Estimate;
use lennard_observables::quantities::{Mark, Quantity, axis, has_mark, quantity_of};
use lennard_scene::study::{SHORT_KEYS, ShortKey};

use super::blocks::Blocks;
use crate::compare::{Row, capital, quantity_words};
use crate::lab::mean_of;
use crate::lists::{grouped, unique};
use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol};
use crate::sweep::StudyPoints;
use crate::sweep::{Setting, SettingValue, SweptPoint};

/// Most series of one figure.
const MOST_SERIES: usize = 6;
/// Points of a line.
const STEPS: usize = 120;

/// Every primary property against the key with the most values, but for those that other readings have drawn.
pub(super) fn pictures(study: &StudyPoints<'_>) -> Vec<Picture> {
    let is_drawn = |name: &str| study.drawn.contains(&name);
    let points = averaged(study.swept);
    let Some(key) = swept_axis(&points) else {
        return Vec::new();
    };
    let groups = series_of(&points, &key);
    let place = Place::of(&points, &key);
    if groups.len() > MOST_SERIES {
        return Vec::new();
    }
    let rows = study.swept.iter().filter_map(|p| p.compared.as_ref()).flat_map(|c| &c.rows);
    let shown = rows.filter(|row| {
        row.primary && !is_drawn(&row.quantity) && is_worth_drawing(&row.quantity, &key)
    });
    let names = unique(shown.map(|row| (row.quantity.as_str(), row.unit.as_str())));
    let equation = equation(study);
    let drawn = names.into_iter().filter_map(|(quantity, unit)| {
        let name = format!("{quantity}_over_{key}");
        picture(name, (quantity, unit), &place, &groups, equation)
    });
    drawn.collect()
}

/// One quantity against one key, for points that differ in this key alone and have `fewest` values of it or more; `None` where there
/// are no such points, or too many series of them.
pub(super) fn along(
    study: &StudyPoints<'_>,
    key: &str,
    quantity: &Quantity,
    fewest: usize,
) -> Option<Picture> {
    let points = averaged(study.swept);
    let measured = |p: &&Averaged<'_>| p.mean(quantity.key).is_some();
    let mut groups = series_of(&points, key);
    groups.retain(|group| group.iter().filter(|p| measured(p)).count() >= fewest);
    if groups.is_empty() || groups.len() > MOST_SERIES {
        return None;
    }
    let (place, equation) = (Place::of(&points, key), equation(study));
    let name = (quantity.key, quantity.unit);
    picture(quantity.key.to_owned(), name, &place, &groups, equation)
}

/// The equation of state of the model, where any point stands beside it.
fn equation(study: &StudyPoints<'_>) -> Option<&'static dyn EquationOfState> {
    let model = study.sweep.points.first().map(|p| lennard_scene::model_kind(&p.scene));
    let judged = study.swept.iter().filter_map(|p| p.compared.as_ref());
    let has_equation = judged.into_iter().any(|c| c.equation.is_some());
    model.filter(|_| has_equation).and_then(|model| equation_of_state_for(model).ok())
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

/// Where points lie along the key that a sweep changes.
struct Place<'a> {
    key: &'a str,
    /// The values of a key that has words, in the order of the sweep; empty where it has numbers.
    words: Vec<String>,
}

impl<'a> Place<'a> {
    fn of(points: &[Averaged<'_>], key: &'a str) -> Self {
        let words = points.iter().filter_map(|p| match p.value(key)? {
            SettingValue::Words(word) => Some(word.clone()),
            SettingValue::Number(_) => None,
        });
        Self { key, words: unique(words) }
    }

    fn axis(&self) -> Axis {
        let label = short_key(self.key).map_or(self.key, |short| short.label);
        match self.words.is_empty() {
            true => Axis::linear(label),
            false => Axis::of_words(label, self.words.clone()),
        }
    }

    fn at(&self, point: &Averaged<'_>) -> Option<f64> {
        match point.value(self.key)? {
            SettingValue::Number(number) => Some(*number),
            SettingValue::Words(word) => {
                self.words.iter().position(|known| known == word).map(|at| at as f64)
            }
        }
    }
}

/// The key with the most numbers, of two or more: short names first. Where no key has two numbers, the key with the most words.
fn swept_axis(points: &[Averaged<'_>]) -> Option<String> {
    let values = |key: &str| -> (usize, usize) {
        let all = points.iter().filter_map(|p| p.value(key));
        let (numbers, words): (BTreeSet<String>, BTreeSet<String>) =
            all.map(ToString::to_string).partition(|value| value.parse::<f64>().is_ok());
        match numbers.len() {
            0 | 1 => (0, words.len()),
            n => (n, 0),
        }
    };
    let others = points.iter().flat_map(|p| p.settings).map(|s| s.key.as_str());
    let keys = || SHORT_KEYS.iter().map(|short| short.name).chain(others.clone());
    let most = keys().map(values).max()?;
    let axis = keys().find(|key| values(key) == most)?;
    (most >= (0, 2)).then(|| axis.to_owned())
}

/// Points that differ in one key alone, in the order of the sweep, each sorted by this key.
pub(super) fn series_of<'a, 'b>(
    points: &'a [Averaged<'b>],
    key: &str,
) -> Vec<Vec<&'a Averaged<'b>>> {
    let others = |p: &Averaged<'b>| -> Vec<&'b Setting> {
        p.settings.iter().filter(|s| s.key != key).collect()
    };
    let value = |p: &Averaged<'b>| p.setting(key).unwrap_or(f64::NAN);
    let chosen = points.iter().filter(|p| p.value(key).is_some());
    let groups = grouped(chosen.map(|p| (others(p), p))).into_iter();
    let sorted = |(_, mut group): (Vec<&Setting>, Vec<&'a Averaged<'b>>)| {
        group.sort_by(|a, b| value(a).total_cmp(&value(b)));
        group
    };
    groups.map(sorted).collect()
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
    name: String,
    (quantity, unit): (&str, &str),
    place: &Place<'_>,
    groups: &[Vec<&Averaged<'_>>],
    equation: Option<&'static dyn EquationOfState>,
) -> Option<Picture> {
    let words = quantity_words(quantity);
    let value = Axis::linear(axis(&words, unit));
    // Words have room at the side.
    let is_across = !place.words.is_empty();
    let (x, y) = if is_across { (value, place.axis()) } else { (place.axis(), value) };
    let mut figure = Figure::new(name, capital(&words), x, y);
    let mut has_line = false;
    for (color, group) in groups.iter().enumerate() {
        let mark = |p: &&Averaged<'_>| match is_across {
            true => p.mark_across(quantity, place.at(p)?),
            false => p.mark(place.at(p)?, quantity),
        };
        let marks: Vec<Point> = group.iter().filter_map(mark).collect();
        if marks.len() < 2 {
            continue;
        }
        let curve = equation.zip(property(quantity));
        let curve = curve.and_then(|(e, property)| line(e, property, place.key, group));
        if let Some(curve) = curve.filter(|c| !c.is_empty()) {
            has_line = true;
            figure = figure.with(Series::new("", Look::Line(Dash::Solid), color, curve));
        }
        let look = Look::Points(Symbol::cycle(color));
        figure = figure.with(Series::new(label_of(group[0], place.key), look, color, marks));
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

/// From so many seeds on, their scatter is an error of its own.
const FEWEST_SEEDS: usize = 4;

/// Points with the same settings, whatever their seeds.
pub(super) struct Averaged<'a> {
    /// What was chosen for these points, without the seed.
    pub settings: &'a [Setting],
    /// The points.
    pub points: Vec<&'a SweptPoint>,
}

/// The points of a sweep, seeds together, in the order of the sweep.
pub(super) fn averaged(points: &[SweptPoint]) -> Vec<Averaged<'_>> {
    let all = grouped(points.iter().map(|point| (point.settings.as_slice(), point)));
    all.into_iter().map(|(settings, points)| Averaged { settings, points }).collect()
}

impl Averaged<'_> {
    /// The number that was chosen for a key.
    pub(crate) fn setting(&self, key: &str) -> Option<f64> {
        match self.value(key)? {
            SettingValue::Number(number) => Some(*number),
            SettingValue::Words(_) => None,
        }
    }

    /// What was chosen for a key.
    pub fn value(&self, key: &str) -> Option<&SettingValue> {
        self.settings.iter().find(|s| s.key == key).map(|s| &s.value)
    }

    /// The mean of a quantity over the seeds; `None` where no run has measured it.
    ///
    /// Its error is √Σs²/n of the printed errors, or the scatter of the seeds where it is larger and there are four seeds or more.
    /// Runs without an error are left out where others have one; where no run has one, the mean is no result.
    pub(crate) fn mean(&self, quantity: &str) -> Option<Estimate> {
        let rows = self.points.iter().filter_map(|p| p.row(quantity));
        let mut all: Vec<Estimate> = rows.map(Row::mean).collect();
        if all.iter().any(|one| one.standard_error.is_finite()) {
            all.retain(|one| one.standard_error.is_finite());
        }
        (!all.is_empty()).then(|| of_seeds(&all))
    }

    /// A mark at a mean over the seeds, with its error, its name and its page; `None` where no run has measured it.
    pub(crate) fn mark(&self, x: f64, quantity: &str) -> Option<Point> {
        let mean = self.mean(quantity)?;
        Some(Point {
            error: Some(mean.standard_error),
            note: Some(self.name()),
            link: self.page(),
            ..Point::from((x, mean.mean))
        })
    }

    /// The same mark with the mean along the abscissa, and its error too where it has one.
    pub(crate) fn mark_across(&self, quantity: &str, y: f64) -> Option<Point> {
        let mark = self.mark(f64::NAN, quantity)?;
        let error = mark.error.filter(|error| error.is_finite());
        Some(Point {
            x: mark.y,
            y,
            x_range: error.map(|error| (mark.y - error, mark.y + error)),
            error: mark.error.filter(|_| error.is_none()),
            ..mark
        })
    }

    /// The mean measured temperature, ε/k_B; `None` where no run has ended.
    pub fn temperature(&self) -> Option<f64> {
        let measured: Vec<f64> = self
            .points
            .iter()
            .filter_map(|p| Some(p.compared.as_ref()?.state.temperature))
            .collect();
        (!measured.is_empty()).then(|| measured.iter().sum::<f64>() / measured.len() as f64)
    }

    /// The name of the first of the points, and how many there are.
    pub fn name(&self) -> String {
        let first = &self.points[0].name;
        match self.points.len() {
            1 => first.clone(),
            n => format!("{first} and {} more seeds", n - 1),
        }
    }

    /// The page of the first of the points.
    pub(crate) fn page(&self) -> Option<String> {
        self.points.iter().find_map(|p| p.page.clone())
    }
}

/// The mean of values of several seeds.
fn of_seeds(values: &[Estimate]) -> Estimate {
    let mean = mean_of(values);
    let n = values.len() as f64;
    let squares: f64 = values.iter().map(|one| (one.mean - mean.mean).powi(2)).sum();
    let scatter = (squares / (n * (n - 1.0))).sqrt();
    let is_scatter = values.len() >= FEWEST_SEEDS && scatter > mean.standard_error;
    Estimate { standard_error: if is_scatter { scatter } else { mean.standard_error }, ..mean }
}

/// Fewest densities that make an isotherm.
const FEWEST_DENSITIES: usize = 3;

/// P(ρ) for each temperature with several densities.
pub(super) fn isotherms(study: &StudyPoints<'_>) -> Blocks {
    let pressure = quantity_of("pressure");
    let drawn = pressure.and_then(|p| along(study, "density", p, FEWEST_DENSITIES));
    Blocks::of_figures(drawn)
}

#[cfg(test)]
mod tests {
    use super::tests_of_averaged::point;
    use super::*;
    use crate::sweep::SweptPoint;

    #[test]
    fn a_key_of_words_is_an_axis_where_no_key_has_two_numbers() {
        let words = |kind: &str| Setting {
            key: "truncation.kind".into(),
            value: SettingValue::Words(kind.into()),
        };
        let at =
            |kind: &str, dt: f64| point(kind, vec![words(kind), crate::testing::chosen("dt", dt)]);
        let axis = |points: &[SweptPoint]| swept_axis(&averaged(points));
        let points = [at("shift", 0.004), at("cut", 0.004)];
        assert_eq!(axis(&points).as_deref(), Some("truncation.kind"));
        assert_eq!(axis(&points[..1]), None);
        let numbers = [at("shift", 0.004), at("cut", 0.004), at("cut", 0.002)];
        assert_eq!(axis(&numbers).as_deref(), Some("dt"));
        // Words stand in the order of the study.
        let points = averaged(&points);
        let place = Place::of(&points, "truncation.kind");
        assert_eq!(points.iter().map(|p| place.at(p)).collect::<Vec<_>>(), [Some(0.0), Some(1.0)]);
        assert_eq!(place.axis().words, ["shift", "cut"]);
        assert_eq!(series_of(&points, "truncation.kind").len(), 1);
    }
}

#[cfg(test)]
pub(super) mod tests_of_averaged {
    use super::*;

    /// A point of these settings that has not been run.
    pub(crate) fn point(name: &str, settings: Vec<Setting>) -> SweptPoint {
        let planned = crate::compare::StateOfMatter::new(0.5, 1.0, None);
        SweptPoint::not_run(name, settings, planned)
    }

    #[test]
    fn the_error_of_seeds_is_the_printed_one_or_their_scatter_where_it_is_larger() {
        let of = |pairs: &[[f64; 2]]| {
            let estimates = pairs.iter().map(|[mean, error]| Estimate::new(*mean, *error, 10.0));
            of_seeds(&estimates.collect::<Vec<_>>())
        };
        let two = of(&[[1.0, 0.3], [2.0, 0.4]]);
        assert_eq!(two.mean, 1.5);
        assert!((two.standard_error - 0.25).abs() < 1e-15);
        // Four seeds scatter by far more than they print.
        let four = of(&[[0.0, 0.1], [2.0, 0.1], [0.0, 0.1], [2.0, 0.1]]);
        assert!((four.standard_error - (4.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        let quiet = of(&[[1.0, 0.1]; 4]);
        assert!((quiet.standard_error - 0.05).abs() < 1e-15);
        // Without a printed error the scatter makes no result.
        assert!(
            of(&[[0.0, f64::NAN], [1.0, f64::NAN], [0.0, f64::NAN], [1.0, f64::NAN]])
                .standard_error
                .is_nan()
        );
    }

    #[test]
    fn points_that_differ_in_their_seeds_stand_together() {
        let point = |name: &str, density: f64| {
            point(name, vec![crate::testing::chosen("density", density)])
        };
        let points =
            [point("rho0.1-seed1", 0.1), point("rho0.2-seed1", 0.2), point("rho0.1-seed2", 0.1)];
        let together = averaged(&points);
        assert_eq!(together.len(), 2);
        assert_eq!(together[0].name(), "rho0.1-seed1 and 1 more seeds");
        assert_eq!(together[1].setting("density"), Some(0.2));
        assert_eq!(together[0].mean("pressure"), None);
        assert_eq!(together[0].temperature(), None);
    }
}
