//! The coexistence curve of a sweep over the temperature of slabs.

use lennard_literature::{
    EquationOfState, Saturation, TwoPhaseSource, TwoPhases, coexistence_by_simulation,
    equation_of_state_for, surface_tensions_by_simulation, thol_2016,
};
use lennard_observables::Estimate;
use lennard_observables::quantities::{Quantity, quantity_of};
use lennard_observables::statistics::Line;
use serde::Serialize;

use super::blocks::Blocks;
use super::properties::{Averaged, averaged};
use crate::compare::capital;
use crate::lab::mean_of;
use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};
use crate::sweep::StudyPoints;
use crate::sweep::SweptPoint;

/// The fewest temperatures that make a curve.
const FEWEST: usize = 2;
/// Temperatures of a line.
const STEPS: usize = 160;
/// How far below the coldest point lines begin, in critical temperatures.
const MARGIN: f64 = 0.05;
/// Each so-manieth row of the table of coexistence is drawn.
const EACH: usize = 25;

/// The caption of every figure.
const BARS: &str = "Bars are one standard error.";
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
        let density = |name: &str| point.mean(name).filter(|m| m.standard_error.is_finite());
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

    /// Points of the literature from cold to hot: by the equation of state, by another correlation, and by simulations of the
    /// full potential.
    fn known(
        &self,
        of_phases: impl Fn(&[TwoPhases]) -> Vec<(f64, f64)>,
        of_simulation: impl Fn(&Saturation) -> Vec<(f64, f64)>,
    ) -> Vec<Series> {
        let equation = self.equation.map(|equation| {
            let spec = equation.spec();
            let all = self.temperatures(spec.critical.temperature);
            let all = all.filter_map(|t| equation.saturation(t)).map(|saturation| TwoPhases {
                saturation,
                surface_tension: None,
                source: String::new(),
            });
            Series::new(&spec.name, SOLID, EQUATION, of_phases(&all.collect::<Vec<_>>()))
        });
        // Others are an equation of state themselves.
        let vrabec = self.source.filter(|s| *s == TwoPhaseSource::Vrabec);
        let correlation = vrabec.map(|source| {
            let all = self.temperatures(source.critical().temperature);
            let all: Vec<TwoPhases> = all.filter_map(|t| source.at(t)).collect();
            Series::new(source.name(), DASHED, CORRELATION, of_phases(&all))
        });
        let is_full = self.equation.is_some_and(|e| e.spec().key == thol_2016().spec().key);
        let simulated = is_full.then(|| {
            let all = coexistence_by_simulation();
            Series::new("NIST", RING, OTHERS, all.iter().step_by(EACH).flat_map(of_simulation))
        });
        let all = equation.into_iter().chain(correlation).chain(simulated);
        all.filter(|series| !series.points.is_empty()).collect()
    }

    fn in_density(
        &self,
        points: &[Averaged<'_>],
        swept: &[SweptPoint],
        critical: Option<&CriticalEstimate>,
    ) -> Picture {
        let dome = |phases: &[TwoPhases]| -> Vec<(f64, f64)> {
            let at = |p: &TwoPhases, rho: f64| (rho, p.saturation.temperature);
            let vapor = phases.iter().map(|p| at(p, p.saturation.vapor_density));
            let liquid = phases.iter().rev();
            vapor.chain(liquid.map(|p| at(p, p.saturation.liquid_density))).collect()
        };
        let both = |s: &Saturation| {
            [s.vapor_density, s.liquid_density].map(|rho| (rho, s.temperature)).into()
        };
        let measured = |name: &'static str| {
            points.iter().filter_map(move |p| p.mark_across(name, p.temperature()?))
        };
        let marks = ["vapor_density", "liquid_density"].into_iter().flat_map(measured);
        let (x, y) = (Axis::linear("density ρ / σ⁻³"), Axis::linear("T / (ε/k_B)"));
        let figure = Figure::new("coexistence", "Coexisting vapor and liquid", x, y);
        let mut figure = Figure { series: self.known(dome, both), ..figure }.with(Series::new(
            "this sweep",
            DISC,
            MEASURED,
            marks,
        ));
        let diameters: Vec<(f64, f64)> =
            pairs(swept).iter().map(|p| (p.diameter().mean, p.temperature)).collect();
        if !diameters.is_empty() {
            let look = Look::Points(Symbol::Plus);
            figure = figure.with(Series::new("half the sum of both", look, MEASURED, diameters));
        }
        let mut caption = BARS.to_owned();
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
        let hottest = marks.iter().map(|p| p.x).reduce(f64::max)?;
        let axis = match is_pressure {
            true => Axis::logarithmic(quantity.axis()),
            false => Axis::linear(quantity.axis()),
        };
        let value = |p: &TwoPhases| match is_pressure {
            true => Some((p.saturation.temperature, p.saturation.pressure)),
            false => Some((p.saturation.temperature, p.surface_tension?)),
        };
        let known = self.known(
            |phases| phases.iter().filter_map(value).collect(),
            |s| is_pressure.then_some((s.temperature, s.pressure)).into_iter().collect(),
        );
        let title = capital(quantity.words);
        let figure = Figure::new(name, title, Axis::linear("T / (ε/k_B)"), axis);
        let mut figure = Figure { series: known, ..figure };
        if !is_pressure && self.source == Some(TwoPhaseSource::Vrabec) {
            let near = |(t, _): &(f64, f64)| (self.coldest - 0.05..=hottest + 0.05).contains(t);
            let single = surface_tensions_by_simulation().into_iter().filter(near);
            figure = figure.with(Series::new("Vrabec 2006, simulations", RING, OTHERS, single));
        }
        let figure = figure.with(Series::new("this sweep", DISC, MEASURED, marks));
        Some(Picture::new(figure, BARS, "table.csv"))
    }
}

/// The exponent β of ρ_l − ρ_v ∝ (T_c − T)^β in the universality class of fluids.
///
/// Source: A. Pelissetto and E. Vicari, Phys. Rep. 368, 549 (2002), table 5 (0.3265).
const BETA: f64 = 0.326;
/// The fewest temperatures from which a critical point is estimated.
const FEWEST_OF_CRITICAL: usize = 3;

/// Vapor and liquid at one temperature, with errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub temperature: f64,
    pub vapor: Estimate,
    pub liquid: Estimate,
}

impl Pair {
    /// ½(ρ_l + ρ_v), σ⁻³, with its error.
    pub(crate) fn diameter(&self) -> Estimate {
        mean_of(&[self.liquid, self.vapor])
    }
}

/// A critical point with standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct CriticalEstimate {
    /// T_c, ε/k_B.
    pub temperature: f64,
    /// Its standard error.
    pub temperature_error: f64,
    /// ρ_c, σ⁻³.
    pub density: f64,
    /// Its standard error.
    pub density_error: f64,
    /// Temperatures that it comes from.
    pub temperatures: usize,
}

/// The critical point by (ρ_l − ρ_v)^{1/β} = B·(T_c − T) and by the law of rectilinear diameters, ½(ρ_l + ρ_v) = ρ_c + A·(T_c − T).
///
/// Both laws hold near the critical point. Points far below bias the estimate by more than its statistical error.
pub(super) fn estimate(pairs: &[Pair]) -> Option<CriticalEstimate> {
    if pairs.len() < FEWEST_OF_CRITICAL {
        return None;
    }
    let power = 1.0 / BETA;
    let contrasts: Vec<(f64, f64, f64)> = pairs
        .iter()
        .map(|p| {
            let contrast = p.liquid.minus(&p.vapor);
            let slope = power * contrast.mean.powf(power - 1.0);
            (p.temperature, contrast.mean.powf(power), slope * contrast.standard_error)
        })
        .collect();
    let diameters = pairs.iter().map(|p| (p.temperature, p.diameter()));
    let diameters: Vec<(f64, f64, f64)> =
        diameters.map(|(t, d)| (t, d.mean, d.standard_error)).collect();
    let closing = Line::with_errors(&contrasts)?;
    let diameter = Line::with_errors(&diameters)?;
    let (temperature, temperature_error) = closing.zero();
    let hottest = pairs.iter().map(|p| p.temperature).fold(0.0, f64::max);
    (closing.slope() < 0.0 && temperature > hottest).then(|| CriticalEstimate {
        temperature,
        temperature_error,
        density: diameter.at(temperature),
        density_error: diameter.error_at(temperature).hypot(diameter.slope() * temperature_error),
        temperatures: pairs.len(),
    })
}

#[cfg(test)]
mod tests_of_critical {
    use super::*;

    fn exact(temperature: f64, error: f64) -> Pair {
        let below = 1.08 - temperature;
        let (middle, half) = (0.32 + 0.2 * below, 0.5 * 1.1 * below.powf(BETA));
        let density = |mean| Estimate::new(mean, error, f64::NAN);
        Pair { temperature, vapor: density(middle - half), liquid: density(middle + half) }
    }

    #[test]
    fn the_laws_themselves_give_back_the_critical_point() {
        let pairs = [0.9, 0.95, 1.0, 1.04].map(|t| exact(t, 1e-3));
        let found = estimate(&pairs).unwrap();
        assert!((found.temperature - 1.08).abs() < 1e-10, "{found:?}");
        assert!((found.density - 0.32).abs() < 1e-10, "{found:?}");
        assert!(found.temperature_error > 0.0 && found.temperature_error < 0.01);
        assert!(found.density_error > 0.0 && found.density_error < 0.01);
        assert_eq!(estimate(&pairs[..2]), None);
    }

    #[test]
    fn the_errors_cover_noise_of_the_size_that_is_stated() {
        let seeds = 400;
        let mut within = [0; 2];
        for seed in 0..seeds {
            let mut pairs = [0.9, 0.94, 0.98, 1.02].map(|t| exact(t, 2e-3));
            let mut noise = lennard_core::random::Streams::new(seed).sequential("noise");
            for pair in &mut pairs {
                for density in [&mut pair.vapor.mean, &mut pair.liquid.mean] {
                    // Twelve uniform numbers less six have unit variance.
                    let normal: f64 = (0..12)
                        .map(|_| {
                            (rand::Rng::next_u64(&mut noise) >> 11) as f64 / (1_u64 << 53) as f64
                        })
                        .sum::<f64>()
                        - 6.0;
                    *density += 2e-3 * normal;
                }
            }
            let found = estimate(&pairs).unwrap();
            within[0] += usize::from((found.temperature - 1.08).abs() < found.temperature_error);
            within[1] += usize::from((found.density - 0.32).abs() < found.density_error);
        }
        // 68 % where errors are right, and more where chance widens them.
        for count in within {
            let share = count as f64 / seeds as f64;
            assert!((0.60..0.85).contains(&share), "{within:?}");
        }
    }

    #[test]
    fn densities_that_do_not_close_have_no_critical_point() {
        let mut pairs = [0.9, 0.95, 1.0].map(|t| exact(t, 1e-3));
        pairs.reverse();
        for (pair, t) in pairs.iter_mut().zip([0.9, 0.95, 1.0]) {
            pair.temperature = t;
        }
        assert_eq!(estimate(&pairs), None);
    }
}
