//! Diffusion against the inverse temperature.

use lennard_observables::statistics::Line;
use lennard_observables::{CORRECTED, UNCORRECTED};

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};

use super::blocks::Blocks;
use super::properties::{averaged, label_of, series_of};
use crate::sweep::StudyPoints;

/// The fewest temperatures that make a line.
const FEWEST: usize = 3;

/// The line of Arrhenius, ln D = ln D₀ − E/T against 1/T, through points (1/T, D, standard error of D).
fn line_through(points: &[(f64, f64, f64)]) -> Option<Line> {
    let logarithms: Vec<(f64, f64, f64)> =
        points.iter().map(|(x, d, error)| (*x, d.ln(), error / d)).collect();
    Line::with_errors(&logarithms).filter(|_| points.len() >= FEWEST)
}

/// D₀ of a line in σ²/τ with its standard error.
fn factor(line: &Line) -> (f64, f64) {
    let factor = line.at(0.0).exp();
    (factor, factor * line.error_at(0.0))
}

/// The figure of diffusion coefficients.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    Blocks::of_figures(picture(study))
}

/// D against 1/T with a line for each fluid; `None` where no fluid has D at three temperatures.
fn picture(study: &StudyPoints<'_>) -> Option<Picture> {
    let points = averaged(study.swept);
    let mut figure = Figure::new(
        "arrhenius",
        "Diffusion coefficient against inverse temperature",
        Axis::linear("1/T / (k_B/ε)"),
        Axis::logarithmic("D / (σ²/τ)"),
    );
    // One line has one kind of D: corrected for finite size where every point is.
    let all_corrected =
        points.iter().all(|p| p.mean(UNCORRECTED).is_none() || p.mean(CORRECTED).is_some());
    let (quantity, which) = match all_corrected {
        true => (CORRECTED, "corrected for finite size"),
        false => (UNCORRECTED, "not corrected for finite size"),
    };
    let mut fits = Vec::new();
    for (color, group) in series_of(&points, "temperature").into_iter().enumerate() {
        let marks = group.iter().filter_map(|p| p.mark(1.0 / p.temperature()?, quantity));
        let marks: Vec<Point> = marks.filter(|mark| mark.y > 0.0).collect();
        let sound = |m: &Point| Some((m.x, m.y, m.error.filter(|error| error.is_finite())?));
        let results: Vec<(f64, f64, f64)> = marks.iter().filter_map(sound).collect();
        let Some(fit) = line_through(&results) else {
            continue;
        };
        let label = label_of(group[0], "temperature");
        let look = Look::Points(Symbol::Disc);
        figure = figure.with(Series::new(label.clone(), look, color, marks));
        let ends = results.iter().map(|(x, ..)| *x);
        let (low, high) =
            ends.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
        let line = [low, high].map(|x| (x, fit.at(x).exp()));
        figure = figure.with(Series::new("", Look::Line(Dash::Solid), color, line));
        let factor = factor(&fit);
        fits.push(format!(
            "{label}: E = {} ε, D₀ = {} σ²/τ",
            with_error(-fit.slope(), fit.error_of_slope()),
            with_error(factor.0, factor.1)
        ));
    }
    let caption = format!(
        "Bars are one standard error, D is {which}. Lines are D = D₀·exp(−E/T). {}.",
        fits.join("; ")
    );
    (!fits.is_empty()).then(|| Picture::new(figure, caption, "table.csv"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_diffusion_gives_its_energy_and_factor() {
        let points = [0.8, 1.0, 1.3].map(|t: f64| {
            let d = 0.3 * (-2.1 / t).exp();
            (1.0 / t, d, 0.01 * d)
        });
        let fit = line_through(&points).unwrap();
        assert!((fit.slope() + 2.1).abs() < 1e-12);
        assert!((factor(&fit).0 - 0.3).abs() < 1e-12);
        assert!(fit.error_of_slope() > 0.0 && factor(&fit).1 > 0.0);
        assert_eq!(line_through(&points[..2]), None);
    }
}
