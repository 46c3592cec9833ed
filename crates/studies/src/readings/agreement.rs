//! All points together beside the equations of state: their differences, and χ² of each equation.

use lennard_observables::quantities::{Mark, QUANTITIES, Quantity, quantity_of};
use serde::Serialize;

use super::blocks::{Blocks, EQUATIONS, PICTURES, TOGETHER};
use super::equations;
use super::points::Kind;
use super::probability::{CHI_SQUARED_IN_WORDS, probability_words, tail_probability};
use super::study::StudyPoints;
use crate::compare::{Row, Verdict, capital, quantity_words};
use crate::report::{Axis, Figure, Look, Picture, Point, Section, Series, Symbol};
use crate::sweep::SweptPoint;
use lennard_observables::{Cell, Table, Tone};

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
    let deviations = equations::deviations(points);
    if !deviations.is_empty() {
        let table = equations::table(&deviations, quantity_words);
        blocks.sections.push(Section::new(EQUATIONS).table(table));
        blocks.tables.push(equations::table(&deviations, str::to_owned));
        blocks.tables.push(equations::beside_equations(points));
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
    let differences: Vec<f64> = rows.iter().filter_map(|r| r.difference).collect();
    if differences.is_empty() {
        return None;
    }
    let errors: Vec<(f64, f64)> = rows
        .iter()
        .map(|r| (r.combined_error.unwrap_or(f64::NAN), r.reference_error.unwrap_or(0.0)))
        .collect();
    let chi = |with_reference: bool| -> f64 {
        differences
            .iter()
            .zip(&errors)
            .map(|(d, (own, reference))| {
                let error = if with_reference { own.hypot(*reference) } else { *own };
                (d / error).powi(2)
            })
            .sum()
    };
    let (plain, with) = (chi(false), chi(true));
    let count = |verdict: Verdict| rows.iter().filter(|r| r.verdict == verdict).count();
    Some(Agreement {
        quantity: quantity.to_owned(),
        points: differences.len(),
        agree: count(Verdict::Agrees),
        too_coarse: count(Verdict::TooCoarse),
        mean_difference: differences.iter().sum::<f64>() / differences.len() as f64,
        largest_difference: differences
            .iter()
            .copied()
            .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a }),
        largest_standard_error: errors.iter().map(|(own, _)| *own).fold(0.0, f64::max),
        chi_squared: plain,
        p_value: tail_probability(plain, differences.len()),
        chi_squared_with_reference: with,
        p_value_with_reference: tail_probability(with, differences.len()),
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
