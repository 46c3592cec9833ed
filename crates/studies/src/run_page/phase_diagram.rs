//! The phase diagram of the model that was run, with the run in it.

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};
use lennard_io::AverageRecord;
use lennard_literature::{
    EquationOfState, FreezingLine, KnownPoint, Saturation, equation_of_state_for, freezing_line,
    freezing_lines, known_points,
};
use lennard_observables::statistics::Line;

use crate::compare::{ComparedRun, RunFolder};
use crate::eos::{Freezing, freezing_at};

/// Temperatures of a line.
const POINTS: usize = 48;
/// How far beyond the run and the critical point the lines of freezing are drawn, in temperatures.
const BEYOND: f64 = 1.25;
/// Errors that the ellipse reaches.
const ERRORS: f64 = 3.0;
/// Each so-manieth row of the table of coexistence is drawn.
const EACH: usize = 25;

const SOLID: Look = Look::Line(Dash::Solid);
const DASHED: Look = Look::Line(Dash::Dashed);
const DOTTED: Look = Look::Line(Dash::Dotted);

/// Colours of vapor–liquid, solid–liquid, others and the run.
const FLUID: usize = 0;
const SOLID_LIQUID: usize = 2;
const OTHERS: usize = 4;
const RUN: usize = 1;

/// T against ρ, and P against T; none where no equation describes the model.
pub(super) fn phase_diagram(run: &RunFolder, compared: &ComparedRun) -> Vec<Picture> {
    let model = lennard_scene::model_kind(&run.scene);
    let Ok(equation) = equation_of_state_for(model) else {
        return Vec::new();
    };
    let lines =
        Lines { points: known_points(model), ..Lines::of(equation, compared.state.temperature) };
    let mut pictures = vec![lines.in_density(run, compared)];
    pictures.extend(lines.in_pressure(run));
    pictures
}

/// What is drawn of an equation.
struct Lines {
    equation: &'static dyn EquationOfState,
    /// From cold to hot.
    coexistence: Vec<Saturation>,
    spinodal: Vec<(f64, [f64; 2])>,
    /// By every line, from cold to hot.
    freezing: Vec<Freezing>,
    /// Where the line that judges phases meets the saturated liquid.
    triple: Option<Saturation>,
    /// Critical and triple points by others.
    points: Vec<KnownPoint>,
}

impl Lines {
    fn of(equation: &'static dyn EquationOfState, temperature: f64) -> Self {
        let spec = equation.spec();
        let critical = spec.critical.temperature;
        let lowest = spec.range.t_min.max(0.5 * critical);
        // The lines close as a square root: temperatures crowd at the critical one.
        let below = |i: usize| {
            let left = 1.0 - i as f64 / POINTS as f64;
            critical - (critical - lowest) * left * left
        };
        let coexistence: Vec<Saturation> =
            (0..POINTS).filter_map(|i| equation.saturation(below(i))).collect();
        let spinodal = coexistence
            .iter()
            .filter_map(|s| Some((s.temperature, equation.spinodal(s.temperature)?)))
            .collect();
        let line = freezing_line();
        let highest = (BEYOND * temperature.max(critical)).min(spec.range.t_max);
        let on_line = |i: usize| {
            let part = i as f64 / POINTS as f64;
            line.t_triple + part * (highest - line.t_triple)
        };
        let freezing = (0..=POINTS).flat_map(|i| freezing_at(equation, on_line(i)));
        Self {
            equation,
            coexistence,
            spinodal,
            freezing: freezing.collect(),
            triple: line.triple_point(equation),
            points: Vec::new(),
        }
    }

    /// The critical and the triple points of others, in the plane of a figure.
    fn points_of_others(
        &self,
        mut figure: Figure,
        place: impl Fn(&KnownPoint) -> Option<(f64, f64)>,
    ) -> Figure {
        for (is_critical, name, symbol) in [
            (true, "critical points of others", Symbol::Ring),
            (false, "triple points of others", Symbol::Frame),
        ] {
            let of_kind = self.points.iter().filter(|p| p.is_critical == is_critical);
            let places: Vec<(f64, f64)> = of_kind.filter_map(&place).collect();
            if !places.is_empty() {
                figure = figure.with(Series::new(name, Look::Points(symbol), OTHERS, places));
            }
        }
        figure
    }

    /// P against T on a freezing line, by the pressure of the equation at the density of the freezing liquid.
    fn freezing_pressures(&self, line: &FreezingLine) -> Vec<(f64, f64)> {
        let places = self.on(line).filter_map(|f| Some((f.temperature, f.pressure?)));
        places.filter(|(_, p)| *p > 0.0).collect()
    }

    /// Freezing by one line.
    fn on(&self, line: &FreezingLine) -> impl Iterator<Item = &Freezing> {
        self.freezing.iter().filter(move |f| f.line == line.name)
    }

    fn name(&self) -> &str {
        &self.equation.spec().name
    }

    fn in_density(&self, run: &RunFolder, compared: &ComparedRun) -> Picture {
        let state = &compared.state;
        let critical = self.equation.spec().critical;
        let top = (critical.density, critical.temperature);
        let vapor = self.coexistence.iter().map(|s| (s.vapor_density, s.temperature));
        let liquid = self.coexistence.iter().rev();
        let liquid = liquid.map(|s| (s.liquid_density, s.temperature));
        let binodal: Vec<(f64, f64)> = vapor.chain([top]).chain(liquid).collect();
        let inner = self.spinodal.iter().map(|(t, [v, _])| (*v, *t));
        let outer = self.spinodal.iter().rev().map(|(t, [_, l])| (*l, *t));
        let spinodal: Vec<(f64, f64)> = inner.chain([top]).chain(outer).collect();
        let mut figure = Figure::new(
            "phase_diagram",
            "Phase diagram, temperature against density",
            Axis::linear("ρ / σ⁻³"),
            Axis::linear("T / (ε/k_B)"),
        )
        .with(Series::new("vapor and liquid", SOLID, FLUID, binodal))
        .with(Series::new("spinodal", DOTTED, FLUID, spinodal))
        .with(Series::new("critical point", Look::Points(Symbol::Triangle), FLUID, [top]));
        if !self.freezing.is_empty() {
            let line = freezing_line();
            let freezing = self.on(line).map(|f| (f.liquid_density, f.temperature));
            let melting = self.on(line).map(|f| (f.crystal_density, f.temperature));
            figure = figure
                .with(Series::new("freezing", SOLID, SOLID_LIQUID, freezing))
                .with(Series::new("melting", DASHED, SOLID_LIQUID, melting));
            figure = figure.with(others(self.others(), |row| {
                [(row.vapor_density, row.temperature), (row.liquid_density, row.temperature)]
            }));
        }
        let figure = self.points_of_others(figure, |p| Some((p.density?, p.temperature)));
        let with_error = |a: &AverageRecord| (a.estimate.mean, a.estimate.standard_error);
        // The density of a box that does not change is exact.
        let density = run.average("density").map(with_error);
        let densities = match ["vapor_density", "liquid_density"].map(|name| run.average(name)) {
            [Some(vapor), Some(liquid)] => [vapor, liquid].map(with_error).to_vec(),
            _ => vec![density.unwrap_or((state.density, 0.0))],
        };
        let error = run.temperature().map_or(f64::NAN, |t| t.estimate.standard_error);
        let here = densities.into_iter().map(|(density, of_density)| Point {
            // Not a number where one of both errors is not known: the point is then no result.
            error: Some(error + 0.0 * of_density),
            ..Point::from((density, state.temperature))
        });
        let figure = figure.with(Series::new("this run", Look::Points(Symbol::Square), RUN, here));
        let triple = self.triple.map_or(String::new(), |s| {
            format!(
                " Triple point: T = {:.4}, ρ of the liquid {:.4}.",
                s.temperature, s.liquid_density
            )
        });
        let freezing = match self.freezing.is_empty() {
            true => String::new(),
            false => format!("; freezing and melting by {}", freezing_line().name),
        };
        let caption = format!(
            "{}{freezing}. Critical point: T = {:.4}, ρ = {:.4}.{triple} This run: {}.",
            self.name(),
            critical.temperature,
            critical.density,
            state.words
        );
        Picture::new(figure, caption, "run.json")
    }

    /// Pressures are drawn by their logarithm: no picture for a run below zero pressure.
    fn in_pressure(&self, run: &RunFolder) -> Option<Picture> {
        // Two phases share the vapor pressure; the mean over their box is the pressure of neither.
        let name = match run.has_two_phases() {
            true => "vapor_pressure",
            false => "pressure",
        };
        let pressure = run.average(name).filter(|p| p.is_sound() && p.estimate.mean > 0.0)?;
        let temperature = run.temperature().filter(|t| t.is_sound())?;
        let critical = self.equation.spec().critical;
        let at_critical = self.equation.pressure(critical.density, critical.temperature);
        let top = (critical.temperature, at_critical);
        let boiling = self.coexistence.iter().map(|s| (s.temperature, s.pressure));
        let boiling: Vec<(f64, f64)> = boiling.chain([top]).collect();
        let mut figure = Figure::new(
            "phase_diagram_pressure",
            "Phase diagram, pressure against temperature",
            Axis::linear("T / (ε/k_B)"),
            Axis::logarithmic("P / (ε/σ³)"),
        )
        .with(Series::new("vapor pressure", SOLID, FLUID, boiling))
        .with(Series::new("critical point", Look::Points(Symbol::Triangle), FLUID, [top]));
        if !self.freezing.is_empty() {
            let [line, older] = freezing_lines();
            for (line, look) in [(line, SOLID), (older, DASHED)] {
                let places = self.freezing_pressures(line);
                let name = format!("freezing, {}", line.name);
                figure = figure.with(Series::new(name, look, SOLID_LIQUID, places));
            }
            figure = figure
                .with(Series::new(
                    "triple point",
                    Look::Points(Symbol::Triangle),
                    SOLID_LIQUID,
                    self.triple.map(|s| (s.temperature, s.pressure)),
                ))
                .with(others(self.others(), |row| [(row.temperature, row.pressure)]));
        }
        let figure = self.points_of_others(figure, |p| Some((p.temperature, p.pressure?)));
        let (t, p) = (temperature.estimate.mean, pressure.estimate.mean);
        let errors = (temperature.estimate.standard_error, pressure.estimate.standard_error);
        // The rows of a slab have the pressure of the whole box: how its vapor pressure goes with T is not known.
        let correlation = correlation(run).filter(|_| name == "pressure");
        let ellipse = ellipse((t, p), errors, correlation.unwrap_or(0.0));
        let figure = figure.with(Series::new("", SOLID, RUN, ellipse)).with(Series::new(
            "this run",
            Look::Points(Symbol::Square),
            RUN,
            [(t, p)],
        ));
        let caption = format!(
            "{}. This run: T = {}, P = {}; the ellipse is three standard errors wide, {}.",
            self.name(),
            with_error(t, errors.0),
            with_error(p, errors.1),
            correlation_in_words(correlation)
        );
        Some(Picture::new(figure, caption, "run.json"))
    }

    /// Coexistence by the simulations of others; they are of the full potential.
    fn others(&self) -> Vec<Saturation> {
        lennard_literature::coexistence_by_simulation()
    }
}

fn others<const N: usize>(
    rows: Vec<Saturation>,
    points: impl Fn(&Saturation) -> [(f64, f64); N],
) -> Series {
    let some = rows.iter().step_by(EACH).flat_map(points);
    Series::new("NIST", Look::Points(Symbol::Disc), OTHERS, some.collect::<Vec<_>>())
}

fn correlation_in_words(correlation: Option<f64>) -> String {
    correlation.map_or_else(
        || "along the axes, since the correlation of T and P is not known".to_owned(),
        |r| format!("with a correlation of {r:.2} of T and P"),
    )
}

/// The correlation of the rows of T and P after the part that averages leave out.
fn correlation(run: &RunFolder) -> Option<f64> {
    let table = run.table("measured")?;
    let name = run.temperature_name();
    let (t, p) = (table.numbers(name)?, table.numbers("pressure")?);
    let points: Vec<(f64, f64)> = t.into_iter().zip(p).collect();
    let r = Line::through(&points).correlation();
    r.is_finite().then_some(r)
}

/// The ellipse on which two correlated means lie [`ERRORS`] errors off.
fn ellipse(centre: (f64, f64), errors: (f64, f64), correlation: f64) -> Vec<(f64, f64)> {
    const SIDES: u32 = 48;
    let rest = (1.0 - correlation * correlation).max(0.0).sqrt();
    (0..=SIDES)
        .map(|i| {
            let (sine, cosine) =
                (std::f64::consts::TAU * f64::from(i) / f64::from(SIDES)).sin_cos();
            let x = centre.0 + ERRORS * errors.0 * cosine;
            let y = centre.1 + ERRORS * errors.1 * (correlation * cosine + rest * sine);
            (x, y)
        })
        .filter(|(_, y)| *y > 0.0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_full_potential_have_all_their_parts() {
        let lines = Lines::of(lennard_literature::thol_2016(), 1.5);
        assert_eq!(lines.coexistence.len(), POINTS);
        assert!(lines.spinodal.len() > POINTS - 4);
        let first = lines.on(freezing_line()).next().unwrap();
        // Mastny and de Pablo have the triple point at 0.694; there the line meets the saturated liquid of the equation.
        assert!((first.temperature - 0.694).abs() < 1e-9);
        assert!(first.liquid_density < first.crystal_density);
        let triple = lines.triple.unwrap();
        assert!((triple.temperature - 0.694).abs() < 5e-4, "{triple:?}");
        for (t, [vapor, liquid]) in &lines.spinodal {
            let binodal = lines.coexistence.iter().find(|s| s.temperature == *t).unwrap();
            assert!(binodal.vapor_density < *vapor && *liquid < binodal.liquid_density);
        }
    }

    #[test]
    fn both_freezing_lines_rise_in_pressure_from_near_the_triple_point() {
        let lines = Lines::of(lennard_literature::thol_2016(), 1.5);
        for line in freezing_lines() {
            let places = lines.freezing_pressures(line);
            assert!(places.len() > POINTS - 4, "{}", line.name);
            // The pressure of the liquid at T = 1 is about 4 on every line.
            let near = places.iter().min_by(|a, b| (a.0 - 1.0).abs().total_cmp(&(b.0 - 1.0).abs()));
            let (t, p) = near.unwrap();
            assert!((t - 1.0).abs() < 0.02 && (3.5..5.0).contains(p), "{t} {p}");
            assert!(places.is_sorted_by(|a, b| a.1 < b.1));
        }
    }

    #[test]
    fn a_correlation_that_is_not_known_is_no_zero() {
        assert!(correlation_in_words(None).contains("not known"));
        assert!(correlation_in_words(Some(0.25)).contains("0.25"));
    }

    #[test]
    fn an_ellipse_reaches_three_errors_along_both_axes() {
        for correlation in [0.0, 0.9, -0.5] {
            let points = ellipse((1.0, 10.0), (0.1, 0.2), correlation);
            let most = |of: fn(&(f64, f64)) -> f64| {
                points.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
            };
            assert!((most(|p| p.0) - 1.3).abs() < 1e-9);
            assert!((most(|p| p.1) - 10.6).abs() < 5e-3, "{correlation}");
        }
    }
}
