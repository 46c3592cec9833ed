//! Every property of every point beside every equation of state, and χ² of each equation.

use crate::report::significant;
use lennard_observables::{Cell, Table, Tone};

use super::probability::{CHI_SQUARED_IN_WORDS, probability_words, tail_probability};
use crate::compare::{CardRow, ComparedRun, StateCard, is_a_part};
use crate::lists::{grouped, unique};
use crate::sweep::SweptPoint;

/// Fewest points that say anything of an equation.
const FEWEST: usize = 3;

/// A measured property of a point beside the equations.
#[derive(Clone, Copy)]
struct Beside<'a> {
    point: &'a SweptPoint,
    run: &'a ComparedRun,
    card: &'a StateCard,
    row: &'a CardRow,
}

/// How an equation does for one property over the points that it covers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Deviation {
    /// Name of the property.
    pub property: String,
    /// Name of the equation.
    pub equation: String,
    /// Whether the equation counts for the band of the literature.
    pub counts: bool,
    /// Points with a measured error that the equation covers.
    pub points: usize,
    /// Σ (measured − equation)²/error².
    pub chi_squared: f64,
    /// Mean of measured − equation.
    pub mean_difference: f64,
    /// The largest |measured − equation|, with its sign, in errors.
    pub largest_in_errors: f64,
    /// The point where it is.
    pub at: String,
    /// Mean of |measured − equation|/|measured|.
    pub relative: f64,
}

/// One property of one point, less the value of each equation.
struct Item<'a> {
    point: &'a str,
    property: &'a str,
    measured: f64,
    /// Name, whether it counts, measured − equation, and the error of this difference.
    equations: Vec<(&'a str, bool, f64, f64)>,
}

/// Whether a row says anything of equations: it has an error, and is the whole of a property.
fn judges(row: &CardRow) -> bool {
    row.error > 0.0 && !is_a_part(&row.property)
}

/// All properties with an error, of all points that have a card, in the order of the cards.
fn all(points: &[SweptPoint]) -> impl Iterator<Item = Beside<'_>> {
    points.iter().flat_map(|point| {
        let run = point.compared.as_ref();
        let card = run.and_then(|run| Some((run, run.card.as_ref()?)));
        card.into_iter().flat_map(move |(run, card)| {
            let rows = card.rows.iter().filter(|r| judges(r));
            rows.map(move |row| Beside { point, run, card, row })
        })
    })
}

/// Every equation for every property that has enough points.
pub(super) fn deviations(points: &[SweptPoint]) -> Vec<Deviation> {
    judged(all(points).map(|beside| {
        let equations = beside.card.equations.iter().zip(beside.row.differences());
        Item {
            point: &beside.point.name,
            property: &beside.row.property,
            measured: beside.row.measured,
            equations: equations
                .map(|(e, difference)| (e.name.as_str(), e.counts, difference, beside.row.error))
                .collect(),
        }
    }))
}

/// The sums over all items, property by property.
fn judged<'a>(items: impl Iterator<Item = Item<'a>>) -> Vec<Deviation> {
    let each = items.flat_map(|Item { point, property, measured, equations }| {
        equations.into_iter().map(move |(equation, counts, difference, error)| {
            let relative = (difference / measured).abs();
            ((property, equation), (point, counts, difference, relative, difference / error))
        })
    });
    let found = grouped(each.filter(|(_, (.., z))| z.is_finite())).into_iter();
    let enough = found.filter(|(_, points)| points.len() >= FEWEST);
    let mut found: Vec<Deviation> = enough
        .map(|((property, equation), points)| {
            let mean = |values: &mut dyn Iterator<Item = f64>| {
                let next = |mean: f64, (i, value)| mean + (value - mean) * (1.0 / (i + 1) as f64);
                values.enumerate().fold(0.0, next)
            };
            let largest = points.iter().rev().max_by(|a, b| a.4.abs().total_cmp(&b.4.abs()));
            Deviation {
                property: property.to_owned(),
                equation: equation.to_owned(),
                counts: points[0].1,
                points: points.len(),
                chi_squared: points.iter().map(|p| p.4 * p.4).sum(),
                mean_difference: mean(&mut points.iter().map(|p| p.2)),
                largest_in_errors: largest.map_or(0.0, |p| p.4),
                at: largest.map_or("", |p| p.0).to_owned(),
                relative: mean(&mut points.iter().map(|p| p.3)),
            }
        })
        .collect();
    let order = unique(found.iter().map(|d| d.property.clone()));
    found.sort_by_key(|d| order.iter().position(|property| *property == d.property));
    found
}

/// χ² of each equation for each property, which `named` writes for a file or for a reader.
pub(super) fn table(deviations: &[Deviation], named: impl Fn(&str) -> String) -> Table {
    let caption = format!(
        "Each equation beside all points that it covers, with the errors of the runs alone. {CHI_SQUARED_IN_WORDS} U and P are \
                   compared for as many particles and less the known bias of the cutoff, with errors at the given temperature. Other \
                   properties are compared for an infinite system."
    );
    Table::rows_of("equations", deviations)
        .caption(caption)
        .column("property", |j| named(&j.property))
        .column("equation", |j| {
            let tone = if j.counts { Tone::Plain } else { Tone::Faint };
            Cell::words(j.equation.clone()).toned(tone)
        })
        .column("points", |j| j.points)
        .column("χ² per point", |j| {
            Cell::figures(significant(j.chi_squared / j.points as f64, 3))
        })
        .column("p", |j| {
            Cell::figures(probability_words(tail_probability(j.chi_squared, j.points)))
        })
        .column("mean difference", |j| Cell::rounded(j.mean_difference, 3))
        .column("mean difference, part of the value", |j| Cell::rounded(j.relative, 2))
        .column("largest, in errors", |j| Cell::figures(format!("{:+.1}", j.largest_in_errors)))
        .column("at", |j| j.at.as_str())
        .table()
}

/// Every property of every point beside every equation: measured value, error, and a column for each equation of any card. Then the
/// differences that χ² is made of, and their error.
pub(super) fn beside_equations(points: &[SweptPoint]) -> Table {
    let rows: Vec<Beside<'_>> = all(points).collect();
    let keys = unique(rows.iter().flat_map(|b| &b.card.equations).map(|e| e.key.as_str()));
    let column = |b: &Beside<'_>, key: &str| b.card.equations.iter().position(|e| e.key == key);
    let mut table = Table::rows_of("beside_equations", &rows)
        .column("point", |b| b.point.name.as_str())
        .column("density", |b| b.run.state.density)
        .column("temperature", |b| b.run.state.temperature)
        .column("property", |b| b.row.property.as_str())
        .column("measured", |b| b.row.measured)
        .column("standard_error", |b| b.row.standard_error);
    for key in &keys {
        table = table.column(key, |b| Some(b.row.values[column(b, key)?]));
    }
    for key in &keys {
        table = table
            .column(&format!("difference_{key}"), |b| b.row.differences().nth(column(b, key)?));
    }
    table.column("error_of_difference", |b| b.row.error).table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Verdict;

    #[test]
    fn a_part_of_the_entropy_judges_no_equation_of_the_whole() {
        let row = |property: &str, error| CardRow {
            property: property.to_owned(),
            name: String::new(),
            unit: String::new(),
            measured: -2.1,
            standard_error: error,
            error,
            predicted_bias: None,
            values: vec![-2.5],
            band: None,
            verdict: Verdict::NoReference,
        };
        assert!(judges(&row("pressure", 0.01)));
        let biased = CardRow { predicted_bias: Some(0.3), ..row("pressure", 0.01) };
        let [difference] = biased.differences().collect::<Vec<_>>()[..] else { panic!() };
        assert!((difference - 0.1).abs() < 1e-12, "a bias is no fault of an equation");
        assert!(!judges(&row("pressure", f64::NAN)));
        assert!(!judges(&row("two_body_entropy", 0.01)));
    }

    #[test]
    fn an_equation_that_is_exact_has_one_per_point_and_one_that_is_off_has_more() {
        // Errors of 0.1 about 2.0, each point off by one error to either side; the second equation is off by 0.3 beside.
        let names: Vec<String> = (0..20).map(|k| format!("point-{k}")).collect();
        let item = |k: usize| {
            let off = if k.is_multiple_of(2) { 0.1 } else { -0.1 };
            Item {
                point: &names[k],
                property: "pressure",
                measured: 2.0 + off,
                equations: vec![
                    ("exact", true, off, 0.1),
                    ("off", false, off - 0.3, 0.1),
                    // Of a gas alone: two points are too few.
                    ("gas", true, if k < 2 { off } else { f64::NAN }, 0.1),
                ],
            }
        };
        let found = judged((0..20).map(item));
        let [exact, off] = &found[..] else { panic!("{found:?}") };
        assert_eq!((exact.equation.as_str(), exact.points), ("exact", 20));
        assert!((exact.chi_squared - 20.0).abs() < 1e-9, "{exact:?}");
        assert!(exact.mean_difference.abs() < 1e-12);
        // (2² + 4²)/2 each.
        assert!((off.chi_squared - 200.0).abs() < 1e-9, "{off:?}");
        assert!((off.mean_difference + 0.3).abs() < 1e-12 && !off.counts);
        assert!((off.largest_in_errors + 4.0).abs() < 1e-9);
        assert_eq!(off.at, "point-1");
        let table = table(&found, str::to_owned);
        assert_eq!(table.rows(), 2);
    }
}
