//! All points together beside the equations of state: their differences, and χ² of each equation.

use lennard_observables::quantities::{Mark, QUANTITIES, Quantity, quantity_of};
use lennard_observables::{Cell, Table, Tone};
use serde::Serialize;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

use super::blocks::{Blocks, EQUATIONS, PICTURES, TOGETHER};
use super::points::Kind;
use crate::compare::{
    CardRow, ComparedRun, Row, StateCard, Verdict, capital, is_a_part, quantity_words,
};
use crate::lists::{grouped, unique};
use crate::report::{Axis, Figure, Look, Picture, Point, Section, Series, Symbol, significant};
use crate::sweep::StudyPoints;
use crate::sweep::SweptPoint;

/// The quantities whose differences are drawn.
const DRAWN: [&str; 2] = ["potential_energy", "pressure"];

/// All points together, their differences, and each equation beside them.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let points = study.swept;
    let together: Vec<Agreement> = QUANTITIES
        .iter()
        .filter(|quantity| quantity.is(Mark::Summed))
        .filter_map(|quantity| agreement(points, quantity.key))
        .collect();
    let drawn = DRAWN.into_iter().filter_map(quantity_of).filter_map(|q| differences(points, q));
    let figures = Section::new(PICTURES).figures(drawn.collect());
    let mut blocks = Blocks { sections: vec![figures], ..Blocks::default() };
    if Kind::of(points).is_homogeneous() {
        let section = Section::new(TOGETHER);
        blocks.sections.push(match together.is_empty() {
            true => section.text("No point is judged: the verdicts of the points say why."),
            false => section.table(agreement_table(&together)),
        });
    }
    let deviations = deviations(points);
    if !deviations.is_empty() {
        let table = equations_table(&deviations, quantity_words);
        blocks.sections.push(Section::new(EQUATIONS).table(table));
        blocks.tables.push(equations_table(&deviations, str::to_owned));
        blocks.tables.push(beside_equations(points));
    }
    if !together.is_empty() {
        blocks.terminal.push(agreement_table(&together).without(&CHI_SQUARED));
        blocks.sentences.push(PROBABILITY.into());
    }
    blocks.with_entry("agreement", &together)
}

/// The differences of one quantity over all points that are single stable phases.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Agreement {
    /// Which quantity.
    pub quantity: String,
    /// Points that it is judged at.
    pub points: usize,
    /// How many of them agree.
    pub agree: usize,
    /// How many of them have a tolerance that is too large to see a difference.
    pub too_coarse: usize,
    /// Mean difference.
    pub mean_difference: f64,
    /// Largest difference by size, with its sign.
    pub largest_difference: f64,
    /// Largest standard error.
    pub largest_standard_error: f64,
    /// Σ (difference/error)² with the statistical errors alone.
    pub chi_squared: f64,
    /// Probability of a sum at least so large, were the equation exact.
    pub p_value: f64,
    /// The same with the equation's own uncertainty added in quadrature.
    pub chi_squared_with_reference: f64,
    /// Probability of a sum at least so large, were the equation off by its own uncertainty at random.
    pub p_value_with_reference: f64,
}

/// Sums up one quantity; `None` where no point is judged by it.
fn agreement(points: &[SweptPoint], quantity: &str) -> Option<Agreement> {
    let rows: Vec<&Row> = points
        .iter()
        .filter_map(|p| p.compared.as_ref())
        .filter(|c| c.state.is_single_stable_phase())
        .flat_map(|c| &c.rows)
        .filter(|r| r.quantity == quantity)
        .filter(|r| r.verdict.is_judged())
        .collect();
    let off = |row: &&Row| Some((row.difference?, row.combined_error?, row.reference_error));
    let off: Vec<(f64, f64, Option<f64>)> = rows.iter().filter_map(off).collect();
    let n = off.len();
    let largest = off.iter().map(|(difference, ..)| *difference);
    let largest = largest.reduce(|a, b| if b.abs() > a.abs() { b } else { a })?;
    let chi_squared = off.iter().map(|(d, own, _)| (d / own).powi(2)).sum();
    let with_own = |(d, own, its_own): &(f64, f64, Option<f64>)| {
        (d / own.hypot(its_own.unwrap_or(0.0))).powi(2)
    };
    let with_reference = off.iter().map(with_own).sum();
    let count = |verdict: Verdict| rows.iter().filter(|r| r.verdict == verdict).count();
    Some(Agreement {
        quantity: quantity.to_owned(),
        points: n,
        agree: count(Verdict::Agrees),
        too_coarse: count(Verdict::TooCoarse),
        mean_difference: off.iter().map(|(difference, ..)| difference).sum::<f64>() / n as f64,
        largest_difference: largest,
        largest_standard_error: off.iter().map(|(_, own, _)| *own).fold(0.0, f64::max),
        chi_squared,
        p_value: tail_probability(chi_squared, n),
        chi_squared_with_reference: with_reference,
        p_value_with_reference: tail_probability(with_reference, n),
    })
}

fn differences(points: &[SweptPoint], quantity: &Quantity) -> Option<Picture> {
    let mark = |point: &SweptPoint| {
        let r = point.row(quantity.key)?;
        let state = &point.compared.as_ref()?.state;
        let note = format!("{}: T = {:.4}, {}", point.name, state.temperature, state.words);
        let mark = Point {
            error: r.combined_error,
            note: Some(note),
            link: point.page.clone(),
            ..Point::from((state.density, r.difference?))
        };
        Some((state.is_single_stable_phase(), mark))
    };
    let (judged, others): (Vec<_>, Vec<_>) =
        points.iter().filter_map(mark).partition(|(is_judged, _)| *is_judged);
    let has_others = !others.is_empty();
    if judged.is_empty() && others.is_empty() {
        return None;
    }
    let mut figure = Figure::new(
        quantity.key,
        format!("{}: measured − equation of state", capital(quantity.words)),
        Axis::linear("density ρ / σ⁻³"),
        Axis::linear(format!("Δ{}", quantity.axis())),
    )
    .level(0.0, "");
    for (name, points, symbol, color) in
        [("single phase", judged, Symbol::Disc, 0), ("not judged", others, Symbol::Ring, 1)]
    {
        if !points.is_empty() {
            let points = points.into_iter().map(|(_, mark)| mark);
            figure = figure.with(Series::new(name, Look::Points(symbol), color, points));
        }
    }
    let open = "Open marks are points that are no single stable phase, which are not judged.";
    let caption = match has_others {
        true => format!("Bars are one standard error of the difference. {open}"),
        false => "Bars are one standard error of the difference.".to_owned(),
    };
    Some(Picture::new(figure, caption, "table.csv"))
}

/// The differences of all points together, quantity by quantity.
fn agreement_table(together: &[Agreement]) -> Table {
    let caption = format!(
        "Differences of all points that are single stable phases. {CHI_SQUARED_IN_WORDS} {PROBABILITY}"
    );
    Table::rows_of("agreement", together)
        .caption(caption)
        .column("Quantity", |a| quantity_words(&a.quantity))
        .column("Points judged", |a| a.points)
        .column("Agree", |a| {
            let all = a.agree == a.points;
            Cell::from(a.agree).toned(if all { Tone::Good } else { Tone::Careful })
        })
        .column("Too coarse to tell", |a| a.too_coarse)
        .column("Mean difference", |a| Cell::rounded(a.mean_difference, 3))
        .column("Largest", |a| Cell::rounded(a.largest_difference, 3))
        .column("Largest standard error", |a| Cell::rounded(a.largest_standard_error, 2))
        .column(CHI_SQUARED[0], |a| Cell::rounded(a.chi_squared, 4))
        .column("p", |a| Cell::figures(probability_words(a.p_value)))
        .column(CHI_SQUARED[1], |a| Cell::rounded(a.chi_squared_with_reference, 4))
        .column("p with the equation's own uncertainty", |a| {
            Cell::figures(probability_words(a.p_value_with_reference))
        })
        .table()
}

/// What p is.
const PROBABILITY: &str = "p is the probability of a χ² at least so large: first were the equation exact, then were it off at random by its own uncertainty.";
/// The columns of [`agreement_table`] that p already says.
const CHI_SQUARED: [&str; 2] = ["χ²", "χ² with the equation's own uncertainty"];

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

/// A property of a point less the value of an equation: the point, whether the equation counts, and the difference. Its size follows,
/// as a part of the measured value and in errors.
type Difference<'a> = (&'a str, bool, f64, f64, f64);

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
    summed(all(points).flat_map(|Beside { point, card, row, .. }| {
        let equations = card.equations.iter().zip(row.differences());
        equations.map(move |(equation, difference)| {
            let (part, in_errors) = ((difference / row.measured).abs(), difference / row.error);
            let key = (row.property.as_str(), equation.name.as_str());
            (key, (point.name.as_str(), equation.counts, difference, part, in_errors))
        })
    }))
}

/// The sums over all differences of a property from an equation, property by property.
fn summed<'a>(each: impl Iterator<Item = ((&'a str, &'a str), Difference<'a>)>) -> Vec<Deviation> {
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
fn equations_table(deviations: &[Deviation], named: impl Fn(&str) -> String) -> Table {
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

/// What χ² is.
pub(super) const CHI_SQUARED_IN_WORDS: &str = "χ² is the sum of (difference/standard error)²: near the number of points where an equation is exact.";

/// A probability for a table: what is too small for a number is said to be below the smallest.
#[must_use]
pub(super) fn probability_words(p: f64) -> String {
    if p < f64::MIN_POSITIVE { "< 10⁻³⁰⁷".into() } else { crate::report::significant(p, 2) }
}

/// The probability that a sum of `n` squares of standard normal numbers is at least `chi_squared`.
pub(super) fn tail_probability(chi_squared: f64, n: usize) -> f64 {
    if !chi_squared.is_finite() {
        return f64::NAN;
    }
    ChiSquared::new(n as f64).map_or(f64::NAN, |d| d.sf(chi_squared))
}

/// P(X ≤ k) and P(X ≥ k) of a binomial variable: `n` trials of probability `p`.
pub(super) fn binomial_tails(k: usize, n: usize, p: f64) -> (f64, f64) {
    let Ok(distribution) = Binomial::new(p, n as u64) else {
        return (f64::NAN, f64::NAN);
    };
    let above = match k {
        0 => 1.0,
        k => distribution.sf(k as u64 - 1),
    };
    (distribution.cdf(k as u64), above)
}

/// P(χ² ≤ x) and P(χ² ≥ x) with `n` degrees of freedom.
pub(super) fn chi_squared_tails(x: f64, n: usize) -> (f64, f64) {
    match ChiSquared::new(n as f64) {
        Ok(distribution) if x > 0.0 => (distribution.cdf(x), distribution.sf(x)),
        _ => (0.0, 1.0),
    }
}

#[cfg(test)]
mod tests_of_equations {
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
        let of_point = |k: usize| {
            let off = if k.is_multiple_of(2) { 0.1 } else { -0.1 };
            // Of a gas alone: two points are too few.
            let of_gas = if k < 2 { off } else { f64::NAN };
            let equations =
                [("exact", true, off), ("off", false, off - 0.3), ("gas", true, of_gas)];
            let name = &names[k];
            equations.map(|(equation, counts, difference)| {
                let part = (difference / (2.0 + off)).abs();
                (
                    ("pressure", equation),
                    (name.as_str(), counts, difference, part, difference / 0.1),
                )
            })
        };
        let found = summed((0..20).flat_map(of_point));
        let [exact, off] = &found[..] else { panic!("{found:?}") };
        assert_eq!((exact.equation.as_str(), exact.points), ("exact", 20));
        assert!((exact.chi_squared - 20.0).abs() < 1e-9, "{exact:?}");
        assert!(exact.mean_difference.abs() < 1e-12);
        // (2² + 4²)/2 each.
        assert!((off.chi_squared - 200.0).abs() < 1e-9, "{off:?}");
        assert!((off.mean_difference + 0.3).abs() < 1e-12 && !off.counts);
        assert!((off.largest_in_errors + 4.0).abs() < 1e-9);
        assert_eq!(off.at, "point-1");
        let table = equations_table(&found, str::to_owned);
        assert_eq!(table.rows(), 2);
    }
}

#[cfg(test)]
mod tests_of_probability {
    use super::*;

    #[test]
    fn points_of_chi_squared_are_those_of_the_tables() {
        // 0.1 % and 99.9 % points, from tables.
        for (n, low, high) in [
            (1, 1.571e-6, 10.828),
            (2, 0.002_001, 13.816),
            (9, 1.152, 27.877),
            (29, 10.986, 58.301),
            (100, 61.918, 149.449),
        ] {
            let (below, _) = chi_squared_tails(low, n);
            let (_, above) = chi_squared_tails(high, n);
            assert!((below - 1e-3).abs() < 2e-6, "{n}: {below}");
            assert!((above - 1e-3).abs() < 2e-6, "{n}: {above}");
        }
        assert_eq!(chi_squared_tails(0.0, 5), (0.0, 1.0));
    }

    #[test]
    fn tails_of_a_binomial_are_its_sums() {
        let (below, above) = binomial_tails(1, 3, 0.5);
        assert!((below - 0.5).abs() < 1e-12 && (above - 0.875).abs() < 1e-12);
        let (below, above) = binomial_tails(30, 30, 0.95);
        assert!((below - 1.0).abs() < 1e-9 && (above - 0.95_f64.powi(30)).abs() < 1e-9);
    }

    #[test]
    fn tail_probabilities_are_those_of_the_tables() {
        // Two degrees of freedom: e^{−x/2}; ten: the 5 % point is 18.307.
        assert!((tail_probability(3.0, 2) - (-1.5_f64).exp()).abs() < 1e-9);
        assert!((tail_probability(18.307, 10) - 0.05).abs() < 1e-5);
        assert!(tail_probability(f64::NAN, 3).is_nan());
        assert_eq!(probability_words(tail_probability(1e5, 3)), "< 10⁻³⁰⁷");
        assert_eq!(probability_words(0.0512), "0.051");
    }
}
