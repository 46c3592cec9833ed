//! Pressure along the isotherms of a sweep, beside the equation of state.

use std::collections::BTreeMap;

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol};
use lennard_literature::EquationOfState;

use super::blocks::{Blocks, StudyPoints};
use crate::sweep::SweptPoint;

/// Fewest densities that make an isotherm.
const FEWEST: usize = 3;
/// Most isotherms that one figure shows.
const MOST: usize = 6;
/// Points of a line.
const STEPS: usize = 120;

/// The figure of pressures.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    Blocks::of_figures(picture(study))
}

/// P(ρ) for each temperature with several densities; `None` where the sweep has no isotherm.
///
/// Marks are means with one standard error at the density of the run. Lines are the equation of state of the model at the
/// temperature that was asked for.
fn picture(study: &StudyPoints<'_>) -> Option<Picture> {
    let mut isotherms: BTreeMap<u64, Vec<&SweptPoint>> = BTreeMap::new();
    for point in study.swept.iter().filter(|p| p.row("pressure").is_some()) {
        // Positive numbers have the order of their bits.
        let temperature = point.planned.temperature.to_bits();
        isotherms.entry(temperature).or_default().push(point);
    }
    isotherms.retain(|_, points| range(points).is_some());
    if isotherms.is_empty() || isotherms.len() > MOST {
        return None;
    }
    let model = lennard_scene::model_kind(&study.sweep.points.first()?.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    let mut figure = Figure::new(
        "pressure",
        "Pressure along isotherms",
        Axis::linear("density ρ / σ⁻³"),
        Axis::linear("pressure P / (ε/σ³)"),
    );
    for (color, (bits, points)) in isotherms.iter().enumerate() {
        let temperature = f64::from_bits(*bits);
        if let Some((equation, (from, to))) = equation.zip(range(points)) {
            let name = format!("{}, T = {temperature}", equation.spec().name);
            let line = curve(equation, temperature, from, to);
            figure = figure.with(Series::new(name, Look::Line(Dash::Solid), color, line));
        }
        let name = format!("measured, T = {temperature}");
        let marks = marks(points);
        figure = figure.with(Series::new(name, Look::Points(Symbol::Disc), color, marks));
    }
    let caption = "Bars are one standard error of the pressure. Lines are the equation of state of the model.";
    Some(Picture::new(figure, caption, "table.csv"))
}

/// The lowest and the highest density of an isotherm; `None` where there are too few.
fn range(points: &[&SweptPoint]) -> Option<(f64, f64)> {
    let mut densities: Vec<f64> = points.iter().map(|p| p.planned.density).collect();
    densities.sort_by(f64::total_cmp);
    densities.dedup();
    (densities.len() >= FEWEST).then(|| (densities[0], densities[densities.len() - 1]))
}

fn marks(points: &[&SweptPoint]) -> Vec<Point> {
    let mark = |point: &&SweptPoint| {
        let row = point.row("pressure")?;
        Some(Point {
            x: point.planned.density,
            y: row.measured,
            error: Some(row.standard_error),
            note: Some(point.name.clone()),
            link: point.page.clone(),
            ..Point::default()
        })
    };
    points.iter().filter_map(mark).collect()
}

fn curve(equation: &dyn EquationOfState, temperature: f64, from: f64, to: f64) -> Vec<Point> {
    (0..=STEPS)
        .map(|i| from + (to - from) * i as f64 / STEPS as f64)
        .map(|density| Point {
            x: density,
            y: equation.pressure(density, temperature),
            ..Point::default()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_of_a_thin_gas_is_nearly_ideal_and_spans_the_densities() {
        let model = lennard_literature::ModelKind::CutWithTail { r_cut: 4.0 };
        let equation = lennard_literature::equation_of_state_for(model).unwrap();
        let line = curve(equation, 2.0, 1e-4, 1e-3);
        assert_eq!(line.len(), STEPS + 1);
        assert!((line[STEPS].x - 1e-3).abs() < 1e-12);
        assert!((line[0].y / (1e-4 * 2.0) - 1.0).abs() < 1e-3, "{}", line[0].y);
    }
}
