//! The coexistence curve of a sweep over the temperature of slabs.

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};
use lennard_literature::{
    EquationOfState, TwoPhaseSource, TwoPhases, coexistence_by_simulation, equation_of_state_for,
    surface_tensions_by_simulation, thol_2016,
};

use lennard_observables::quantities::{Quantity, quantity_of};

use super::averaged::{Averaged, averaged};
use super::blocks::{Blocks, StudyPoints};
use super::critical::{CriticalEstimate, Pair, estimate};
use crate::compare::capital;
use crate::sweep::SweptPoint;

/// The fewest temperatures that make a curve.
const FEWEST: usize = 2;
/// Temperatures of a line.
const STEPS: usize = 160;
/// How far below the coldest point lines begin, in critical temperatures.
const MARGIN: f64 = 0.05;
/// Each so-manieth row of the table of coexistence is drawn.
const EACH: usize = 25;

const SOLID: Look = Look::Line(Dash::Solid);
const DASHED: Look = Look::Line(Dash::Dashed);
const RING: Look = Look::Points(Symbol::Ring);
const DISC: Look = Look::Points(Symbol::Disc);

/// Colours of the equation, of the correlations, of simulations of others, and of the sweep.
const EQUATION: usize = 0;
const CORRELATION: usize = 2;
const OTHERS: usize = 4;
const MEASURED: usize = 1;

/// Vapor and liquid of each temperature with both errors, seeds together.
fn pairs(points: &[SweptPoint]) -> Vec<Pair> {
    let pair = |point: &Averaged<'_>| {
        let density = |name: &str| {
            let mean = point.mean(name).filter(|m| m.standard_error.is_finite())?;
            Some([mean.mean, mean.standard_error])
        };
        Some(Pair {
            temperature: point.temperature()?,
            vapor: density("vapor_density")?,
            liquid: density("liquid_density")?,
        })
    };
    averaged(points).iter().filter_map(pair).collect()
}

/// T(ρ), p_s(T) and γ(T), with the critical point from three temperatures or more.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let critical = estimate(&pairs(study.swept));
    let pictures = pictures(study, critical.as_ref());
    Blocks::of_figures(pictures).with_entry("critical_point", &critical)
}

/// T(ρ), p_s(T) and γ(T); none where the study has no slabs at several temperatures.
fn pictures(study: &StudyPoints<'_>, critical: Option<&CriticalEstimate>) -> Vec<Picture> {
    let points: Vec<Averaged<'_>> = averaged(study.swept)
        .into_iter()
        .filter(|point| point.mean("liquid_density").is_some())
        .collect();
    let temperatures: Vec<f64> = points.iter().filter_map(Averaged::temperature).collect();
    let Some(first) = study.sweep.points.first().filter(|_| temperatures.len() >= FEWEST) else {
        return Vec::new();
    };
    let model = lennard_scene::model_kind(&first.scene);
    let coldest = temperatures.iter().copied().fold(f64::INFINITY, f64::min);
    let lines = Lines {
        equation: equation_of_state_for(model).ok(),
        source: TwoPhaseSource::of(model).ok(),
        coldest,
    };
    let mut drawn = vec![lines.in_density(&points, study.swept, critical)];
    let others = ["vapor_pressure", "surface_tension"].into_iter().filter_map(quantity_of);
    drawn.extend(others.filter_map(|quantity| lines.against_temperature(&points, quantity)));
    drawn
}

/// What the literature has of the model.
struct Lines {
    equation: Option<&'static dyn EquationOfState>,
    source: Option<TwoPhaseSource>,
    coldest: f64,
}

impl Lines {
    /// Temperatures of a line up to the critical one, where they crowd: lines close as a root.
    fn temperatures(&self, critical: f64) -> impl Iterator<Item = f64> + use<> {
        let lowest = self.coldest - MARGIN * critical;
        (0..=STEPS).map(move |i| {
            let left = 1.0 - i as f64 / STEPS as f64;
            critical - (critical - lowest) * left * left
        })
    }

    /// The equation of state from cold to hot.
    fn of_equation(&self) -> Option<(String, Vec<TwoPhases>)> {
        let equation = self.equation?;
        let spec = equation.spec();
        let phases = self
            .temperatures(spec.critical.temperature)
            .filter_map(|t| equation.saturation(t))
            .map(|saturation| TwoPhases {
                saturation,
                surface_tension: None,
                source: String::new(),
            });
        Some((spec.name.clone(), phases.collect()))
    }

    /// Correlations of others, where they are no equation of state.
    fn of_correlations(&self) -> Option<(String, Vec<TwoPhases>)> {
        let source = self.source.filter(|s| *s == TwoPhaseSource::Vrabec)?;
        let phases = self.temperatures(source.critical().temperature).filter_map(|t| source.at(t));
        Some((source.name(), phases.collect()))
    }

    fn in_density(
        &self,
        points: &[Averaged<'_>],
        swept: &[SweptPoint],
        critical: Option<&CriticalEstimate>,
    ) -> Picture {
        let mut figure = Figure::new(
            "coexistence",
            "Coexisting vapor and liquid",
            Axis::linear("density ρ / σ⁻³"),
            Axis::linear("T / (ε/k_B)"),
        );
        let dome = |phases: &[TwoPhases]| -> Vec<(f64, f64)> {
            let at = |p: &TwoPhases, rho: f64| (rho, p.saturation.temperature);
            let vapor = phases.iter().map(|p| at(p, p.saturation.vapor_density));
            let liquid = phases.iter().rev();
            vapor.chain(liquid.map(|p| at(p, p.saturation.liquid_density))).collect()
        };
        if let Some((name, phases)) = self.of_equation() {
            figure = figure.with(Series::new(name, SOLID, EQUATION, dome(&phases)));
        }
        if let Some((name, phases)) = self.of_correlations() {
            figure = figure.with(Series::new(name, DASHED, CORRELATION, dome(&phases)));
        }
        if self.is_full_potential() {
            let others = coexistence_by_simulation();
            let others = others
                .iter()
                .step_by(EACH)
                .flat_map(|s| [s.vapor_density, s.liquid_density].map(|rho| (rho, s.temperature)));
            let others: Vec<(f64, f64)> = others.collect();
            figure = figure.with(Series::new("NIST", RING, OTHERS, others));
        }
        let marks: Vec<Point> = ["vapor_density", "liquid_density"]
            .into_iter()
            .flat_map(|name| {
                points.iter().filter_map(move |p| p.mark_across(name, p.temperature()?))
            })
            .collect();
        figure = figure.with(Series::new("this sweep", DISC, MEASURED, marks));
        let diameters: Vec<(f64, f64)> =
            pairs(swept).iter().map(|p| (p.diameter()[0], p.temperature)).collect();
        if !diameters.is_empty() {
            let look = Look::Points(Symbol::Plus);
            figure = figure.with(Series::new("half the sum of both", look, MEASURED, diameters));
        }
        let mut caption = "Bars are one standard error.".to_owned();
        if let Some(c) = critical {
            let here = Point {
                error: Some(c.temperature_error),
                x_range: Some((c.density - c.density_error, c.density + c.density_error)),
                ..Point::from((c.density, c.temperature))
            };
            let look = Look::Points(Symbol::Triangle);
            figure = figure.with(Series::new("critical point, estimated", look, MEASURED, [here]));
            caption += &format!(
                " Critical point by β = 0.326 and rectilinear diameters: T = {}, ρ = {}, from {} temperatures. Both laws hold near \
                 the critical point; colder points bias the estimate.",
                with_error(c.temperature, c.temperature_error),
                with_error(c.density, c.density_error),
                c.temperatures
            );
        }
        Picture::new(figure, caption, "table.csv")
    }

    fn against_temperature(&self, points: &[Averaged<'_>], quantity: &Quantity) -> Option<Picture> {
        let name = quantity.key;
        // A pressure grows with temperature over decades.
        let is_pressure = name == "vapor_pressure";
        let marks: Vec<Point> = points
            .iter()
            .filter_map(|p| p.mark(p.temperature()?, name))
            .filter(|p| !is_pressure || p.y > 0.0)
            .collect();
        if marks.is_empty() {
            return None;
        }
        let axis = match is_pressure {
            true => Axis::logarithmic(quantity.axis()),
            false => Axis::linear(quantity.axis()),
        };
        let title = capital(quantity.words);
        let mut figure = Figure::new(name, title, Axis::linear("T / (ε/k_B)"), axis);
        let value = |phases: &TwoPhases| match is_pressure {
            true => Some(phases.saturation.pressure),
            false => phases.surface_tension,
        };
        let known =
            [(self.of_equation(), SOLID, EQUATION), (self.of_correlations(), DASHED, CORRELATION)];
        for (line, look, color) in known {
            let Some((source, phases)) = line else {
                continue;
            };
            let curve: Vec<(f64, f64)> =
                phases.iter().filter_map(|p| Some((p.saturation.temperature, value(p)?))).collect();
            if !curve.is_empty() {
                figure = figure.with(Series::new(source, look, color, curve));
            }
        }
        let hottest = marks.iter().map(|p| p.x).fold(0.0, f64::max);
        if !is_pressure && self.source == Some(TwoPhaseSource::Vrabec) {
            let near = |(t, _): &(f64, f64)| (self.coldest - 0.05..=hottest + 0.05).contains(t);
            let single: Vec<(f64, f64)> =
                surface_tensions_by_simulation().into_iter().filter(near).collect();
            figure = figure.with(Series::new("Vrabec 2006, simulations", RING, OTHERS, single));
        }
        if is_pressure && self.is_full_potential() {
            let others: Vec<(f64, f64)> = coexistence_by_simulation()
                .iter()
                .step_by(EACH)
                .map(|s| (s.temperature, s.pressure))
                .collect();
            figure = figure.with(Series::new("NIST", RING, OTHERS, others));
        }
        let figure = figure.with(Series::new("this sweep", DISC, MEASURED, marks));
        let caption = "Bars are one standard error.";
        Some(Picture::new(figure, caption, "table.csv"))
    }

    /// Whether simulations of the full potential belong into a figure.
    fn is_full_potential(&self) -> bool {
        self.equation.is_some_and(|e| e.spec().key == thol_2016().spec().key)
    }
}
