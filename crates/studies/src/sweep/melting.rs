//! The melting temperature of a sweep over crystals beside their liquids.

use lennard_literature::{equation_of_state_for, freezing_lines};
use lennard_report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};
use serde::Serialize;

use super::averaged::averaged;
use super::{Sweep, SweptPoint};
use crate::lines::WeightedLine;

/// The fewest temperatures that make a curve.
const FEWEST: usize = 2;
/// Standard errors by which a velocity must differ from zero for a phase to be the growing one.
const ERRORS: f64 = 2.0;
/// Colours of the sweep, its line, and references.
const MEASURED: usize = 1;
const OTHERS: usize = 4;

/// Velocity of the fronts at one temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Front {
    temperature: f64,
    velocity: f64,
    error: f64,
}

/// The temperature at which neither phase grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeltingEstimate {
    /// T_m, ε/k_B.
    pub temperature: f64,
    /// Its standard error.
    pub temperature_error: f64,
    /// The highest temperature at which the crystal grows, ε/k_B.
    pub grows_at: f64,
    /// The lowest temperature above it at which the crystal melts, ε/k_B.
    pub melts_at: f64,
    /// The pressure of the barostat, ε/σ³; absent without one.
    pub pressure: Option<f64>,
    /// Where the freezing lines of others meet this pressure: name and temperature.
    pub references: Vec<(String, f64)>,
}

/// The fronts of a sweep from cold to hot, seeds together.
fn fronts(points: &[SweptPoint]) -> Vec<Front> {
    let mut fronts: Vec<Front> = averaged(points)
        .iter()
        .filter_map(|point| {
            let mean = point.mean("front_velocity")?;
            Some(Front {
                temperature: point.points.first()?.planned.temperature,
                velocity: mean.value,
                error: mean.error?,
            })
        })
        .collect();
    fronts.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    fronts
}

/// Both temperatures between which the growing phase changes, and where a line through the velocities between them is zero.
fn crossing(fronts: &[Front]) -> Option<[f64; 4]> {
    let melts = |f: &Front| f.velocity < -ERRORS * f.error;
    let grows = |f: &Front| f.velocity > ERRORS * f.error;
    let last = fronts.iter().rposition(grows)?;
    let first = last + 1 + fronts[last + 1..].iter().position(melts)?;
    let between: Vec<(f64, f64, f64)> = fronts[last..=first]
        .iter()
        .map(|f| (f.temperature, f.velocity, f.error))
        .collect();
    let (zero, error) = WeightedLine::through(&between)?.zero();
    let bounds = [fronts[last].temperature, fronts[first].temperature];
    (bounds[0]..=bounds[1])
        .contains(&zero)
        .then_some([zero, error, bounds[0], bounds[1]])
}

/// The pressure that the measured stage of the points holds, where it holds one.
fn pressure(sweep: &Sweep) -> Option<f64> {
    let scene = &sweep.points.first()?.scene;
    let measured = scene.stages.iter().find(|s| s.measure)?;
    measured.barostat.as_ref().map(|control| control.pressure)
}

/// Where the freezing lines of others meet a pressure, by the equation that judges the model.
fn references(sweep: &Sweep, pressure: f64) -> Vec<(String, f64)> {
    let Some(first) = sweep.points.first() else {
        return Vec::new();
    };
    let Ok(equation) = equation_of_state_for(lennard_scene::model_kind(&first.scene)) else {
        return Vec::new();
    };
    let lines = freezing_lines().into_iter();
    lines
        .filter_map(|line| {
            let temperature = crate::eos::freezing_temperature(equation, line, pressure)?;
            Some((line.name.clone(), temperature))
        })
        .collect()
}

/// The melting temperature of a sweep over temperatures; `None` where no two of them lie on both sides of it.
pub(super) fn estimate(sweep: &Sweep, points: &[SweptPoint]) -> Option<MeltingEstimate> {
    let [temperature, temperature_error, grows_at, melts_at] = crossing(&fronts(points))?;
    let pressure = pressure(sweep);
    Some(MeltingEstimate {
        temperature,
        temperature_error,
        grows_at,
        melts_at,
        pressure,
        references: pressure.map_or(Vec::new(), |p| references(sweep, p)),
    })
}

impl MeltingEstimate {
    /// The estimate in words, beside the lines of others.
    #[must_use]
    pub fn in_words(&self) -> String {
        let held = self
            .pressure
            .map_or(String::new(), |p| format!(" at P = {p}"));
        let of_others: Vec<String> = self
            .references
            .iter()
            .map(|(name, t)| format!("{t:.4} ({name})"))
            .collect();
        let beside = match of_others.is_empty() {
            true => String::new(),
            false => format!("; lines of others have {}", of_others.join(" and ")),
        };
        format!(
            "The crystal grows at T = {} and melts at T = {}{held}. Neither does at T = {}{beside}",
            self.grows_at,
            self.melts_at,
            with_error(self.temperature, self.temperature_error)
        )
    }
}

/// Velocity against temperature; `None` where the sweep has no fronts at several temperatures.
pub(super) fn picture(
    points: &[SweptPoint],
    estimate: Option<&MeltingEstimate>,
) -> Option<Picture> {
    let fronts = fronts(points);
    if fronts.len() < FEWEST {
        return None;
    }
    let marks = fronts.iter().map(|f| Point {
        error: Some(f.error),
        ..Point::from((f.temperature, f.velocity))
    });
    let bounds = fronts.iter().fold([0.0_f64; 2], |[low, high], f| {
        [low.min(f.velocity), high.max(f.velocity)]
    });
    let mut figure = Figure::new(
        "melting",
        "Growth of the crystal into its liquid",
        Axis::linear("T / (ε/k_B)"),
        Axis::linear("velocity of a front / (σ/τ)"),
    )
    .level(0.0, "neither grows")
    .with(Series::new(
        "measured",
        Look::Points(Symbol::Disc),
        MEASURED,
        marks.collect::<Vec<_>>(),
    ));
    for (at, (name, temperature)) in estimate.iter().flat_map(|e| &e.references).enumerate() {
        let line = bounds.map(|v| (*temperature, v));
        let dash = Look::Line([Dash::Dashed, Dash::Dotted][at % 2]);
        figure = figure.with(Series::new(name.clone(), dash, OTHERS, line));
    }
    let caption = estimate.map_or_else(
        || "No two temperatures lie on both sides of the melting temperature.".to_owned(),
        |e| format!("{}. Bars are one standard error.", e.in_words()),
    );
    Some(Picture::new(figure, caption, "table.csv"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn front(temperature: f64, velocity: f64) -> Front {
        Front {
            temperature,
            velocity,
            error: 0.01,
        }
    }

    #[test]
    fn the_temperature_of_no_growth_lies_between_growth_and_melting() {
        // v = 2·(1.02 − T).
        let exact = |t: f64| front(t, 2.0 * (1.02 - t));
        let fronts: Vec<Front> = [0.9, 0.95, 1.0, 1.05, 1.1].map(exact).into();
        let [zero, error, low, high] = crossing(&fronts).unwrap();
        assert!((zero - 1.02).abs() < 1e-9, "{zero}");
        assert_eq!((low, high), (1.0, 1.05));
        // Errors of 0.01 in v are 0.005 in T, a little less between two of them.
        assert!((0.002..0.006).contains(&error), "{error}");
        // Growth alone brackets nothing.
        assert_eq!(crossing(&fronts[..3]), None);
        assert_eq!(crossing(&[front(1.0, 0.005), front(1.1, -0.1)]), None);
    }
}
