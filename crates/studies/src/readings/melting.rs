//! The melting temperature of a sweep over crystals beside their liquids.

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series, Symbol, with_error};
use lennard_literature::{equation_of_state_for, freezing_lines};
use lennard_observables::statistics::Line;
use lennard_scene::Scene;
use serde::Serialize;

use super::blocks::Blocks;
use super::properties::{Averaged, averaged, label_of, series_of};
use crate::lists::unique;
use crate::sweep::StudyPoints;
use crate::sweep::{Sweep, SweptPoint};

/// The fewest temperatures that make a curve.
const FEWEST: usize = 2;
/// Standard errors by which a velocity must differ from zero for a phase to be the growing one.
const ERRORS: f64 = 2.0;
/// Colours of the sweep, its line, and references.
const MEASURED: usize = 1;
const OTHERS: usize = 4;

/// Temperature and velocity of fronts, with the error of the velocity.
type Front = (f64, f64, f64);

/// The temperature at which neither phase grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct MeltingEstimate {
    /// What its points share beside the pressure, "N = 2000"; absent where nothing was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
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

/// Velocities against temperature, and the temperatures between growth and melting.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let found = estimates(study.sweep, study.swept);
    let mut blocks = Blocks::of_figures(picture(study.swept, &found));
    blocks.sentences = found.iter().map(|estimate| format!("{}.", estimate.in_words())).collect();
    match found.is_empty() {
        true => blocks,
        false => blocks.with_entry("melting", &found),
    }
}

/// The key of a sweep along which fronts are followed.
const KEY: &str = "temperature";

/// The fronts of points that differ in temperature alone, from cold to hot, seeds together.
fn fronts(group: &[&Averaged<'_>]) -> Vec<Front> {
    let front = |point: &&Averaged<'_>| {
        let mean = point.mean("front_velocity").filter(|m| m.standard_error.is_finite())?;
        Some((point.setting(KEY)?, mean.mean, mean.standard_error))
    };
    group.iter().filter_map(front).collect()
}

/// What the points of a group share; `None` where nothing was chosen.
fn shared(group: &[&Averaged<'_>]) -> Option<String> {
    let others = |p: &&Averaged<'_>| p.settings.iter().any(|s| s.key != KEY);
    let first = group.first().filter(|p| others(p))?;
    Some(label_of(first, KEY))
}

/// Both temperatures between which the growing phase changes, and where a line through the velocities between them is zero.
fn crossing(fronts: &[Front]) -> Option<[f64; 4]> {
    let melts = |(_, velocity, error): &Front| *velocity < -ERRORS * error;
    let grows = |(_, velocity, error): &Front| *velocity > ERRORS * error;
    let last = fronts.iter().rposition(grows)?;
    let first = last + 1 + fronts[last + 1..].iter().position(melts)?;
    let (zero, error) = Line::with_errors(&fronts[last..=first])?.zero();
    let bounds = [fronts[last].0, fronts[first].0];
    (bounds[0]..=bounds[1]).contains(&zero).then_some([zero, error, bounds[0], bounds[1]])
}

/// The pressure that the measured stage of a scene holds, where it holds one.
fn pressure(scene: &Scene) -> Option<f64> {
    scene.measured_stages().next()?.barostat.as_ref().map(|control| control.pressure)
}

/// Where the freezing lines of others meet a pressure, by the equation that judges the model.
fn references(scene: &Scene, pressure: f64) -> Vec<(String, f64)> {
    let Ok(equation) = equation_of_state_for(lennard_scene::model_kind(scene)) else {
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

/// The melting temperatures of a sweep: one for all points that differ in temperature alone. Points that do not lie on both sides of it have none.
fn estimates(sweep: &Sweep, points: &[SweptPoint]) -> Vec<MeltingEstimate> {
    let points = averaged(points);
    let groups = series_of(&points, KEY);
    let estimate = |group: &Vec<&Averaged<'_>>| {
        let [temperature, temperature_error, grows_at, melts_at] = crossing(&fronts(group))?;
        let name = &group.first()?.points.first()?.name;
        let scene = &sweep.points.iter().find(|p| p.name == name.as_str())?.scene;
        let pressure = pressure(scene);
        Some(MeltingEstimate {
            of: shared(group),
            temperature,
            temperature_error,
            grows_at,
            melts_at,
            pressure,
            references: pressure.map_or(Vec::new(), |p| references(scene, p)),
        })
    };
    groups.iter().filter_map(estimate).collect()
}

impl MeltingEstimate {
    /// The estimate in words, beside the lines of others.
    fn in_words(&self) -> String {
        let held = self.pressure.map_or(String::new(), |p| format!(" at P = {p}"));
        let of_others: Vec<String> =
            self.references.iter().map(|(name, t)| format!("{t:.4} ({name})")).collect();
        let beside = match of_others.is_empty() {
            true => String::new(),
            false => format!("; lines of others have {}", of_others.join(" and ")),
        };
        let of = self.of.as_ref().map_or(String::new(), |of| format!("{of}: "));
        format!(
            "{of}The crystal grows at T = {} and melts at T = {}{held}. Neither does at T = {}{beside}",
            self.grows_at,
            self.melts_at,
            with_error(self.temperature, self.temperature_error)
        )
    }
}

/// Velocity against temperature; `None` where the sweep has no fronts at several temperatures.
fn picture(points: &[SweptPoint], estimates: &[MeltingEstimate]) -> Option<Picture> {
    let points = averaged(points);
    let groups: Vec<(String, Vec<Front>)> = series_of(&points, KEY)
        .iter()
        .map(|group| (label_of(group[0], KEY), fronts(group)))
        .filter(|(_, fronts)| fronts.len() >= FEWEST)
        .collect();
    let all = groups.iter().flat_map(|(_, fronts)| fronts);
    let bounds = all.fold([0.0_f64; 2], |[low, high], front| [low.min(front.1), high.max(front.1)]);
    let mut figure = Figure::new(
        "melting",
        "Growth of the crystal into its liquid",
        Axis::linear("T / (ε/k_B)"),
        Axis::linear("velocity of a front / (σ/τ)"),
    )
    .level(0.0, "neither grows");
    for (at, (label, fronts)) in groups.iter().enumerate() {
        let marks =
            fronts.iter().map(|(t, v, error)| Point { error: Some(*error), ..(*t, *v).into() });
        let look = Look::Points(Symbol::cycle(at));
        figure = figure.with(Series::new(label.clone(), look, MEASURED + at, marks));
    }
    let references = unique(estimates.iter().flat_map(|e| &e.references));
    for (at, (name, temperature)) in references.into_iter().enumerate() {
        let line = bounds.map(|v| (*temperature, v));
        let dash = Look::Line([Dash::Dashed, Dash::Dotted][at % 2]);
        figure = figure.with(Series::new(name.clone(), dash, OTHERS, line));
    }
    let told: Vec<String> = estimates.iter().map(MeltingEstimate::in_words).collect();
    let caption = match told.is_empty() {
        true => "No two temperatures lie on both sides of the melting temperature.".to_owned(),
        false => format!("{}. Bars are one standard error.", told.join(". ")),
    };
    (!groups.is_empty()).then(|| Picture::new(figure, caption, "table.csv"))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use lennard_observables::Cell;

    use super::*;
    use crate::compare::{ComparedRun, Row, StateOfMatter};
    use crate::readings::points::of_points;
    use crate::sweep::Point as SweepPoint;

    /// A finished point with fronts of v = 2·(at − T).
    fn point(n: f64, temperature: f64, at: f64) -> SweptPoint {
        let average = crate::testing::average(2.0 * (at - temperature), 0.01);
        let state = StateOfMatter::new(0.96, temperature, None);
        let settings =
            vec![crate::testing::chosen("n_atoms", n), crate::testing::chosen(KEY, temperature)];
        let name = format!("N{n}-T{temperature}");
        SweptPoint {
            compared: Some(ComparedRun {
                run: String::new(),
                model: String::new(),
                atoms: n as u64,
                molecules: n as u64,
                measured_steps: 1000,
                state: state.clone(),
                equation: None,
                rows: vec![Row::measured("front_velocity", &average)],
                card: None,
                units: None,
                headline: String::new(),
                shared_reason: None,
                remarks: Vec::new(),
            }),
            ..SweptPoint::not_run(&name, settings, state)
        }
    }

    #[test]
    fn the_table_has_the_fronts_and_no_column_without_a_number() {
        let mut failed = point(1000.0, 1.1, 1.0);
        failed.compared = None;
        let table = of_points(&[point(1000.0, 0.9, 1.0), failed]);
        let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        assert!(names.contains(&"v"), "{names:?}");
        assert!(!names.iter().any(|name| name.contains("equation")));
        assert!(!names.iter().any(|name| name.contains("Verdicts")));
        // A point that has no results says so.
        let state = table.columns.last().unwrap();
        assert_eq!(state.cells[1].value, Cell::words("not finished").value);
    }

    #[test]
    fn points_of_other_sizes_have_a_melting_temperature_of_their_own() {
        let mut points = Vec::new();
        for t in [0.9, 0.96, 1.04, 1.1] {
            points.extend([point(1000.0, t, 0.98), point(2000.0, t, 1.02)]);
        }
        let scene =
            Scene::load(&lennard_scene::shipped::locate(Path::new("two-phase/melting")), &[])
                .unwrap();
        let planned = |p: &SweptPoint| SweepPoint {
            name: p.name.as_str().into(),
            settings: p.settings.clone(),
            scene: scene.clone(),
            atoms: 1000,
            density: 0.96,
        };
        let sweep = Sweep {
            name: "melting".into(),
            base: "melting.toml".into(),
            readings: Vec::new(),
            left_out: Vec::new(),
            source: Default::default(),
            points: points.iter().map(planned).collect(),
        };
        let found = estimates(&sweep, &points);
        let [small, large] = &found[..] else { panic!("{found:?}") };
        for (found, of, t) in [(small, "N = 1000", 0.98), (large, "N = 2000", 1.02)] {
            assert_eq!(found.of.as_deref(), Some(of));
            assert!((found.temperature - t).abs() < 1e-9, "{found:?}");
            assert_eq!((found.pressure, found.references.len()), (Some(4.0), 2));
            assert!(found.in_words().starts_with(of), "{}", found.in_words());
        }
        let picture = picture(&points, &found).unwrap();
        let svg = picture.to_svg().unwrap();
        assert!(svg.contains("N = 1000") && svg.contains("N = 2000"));
    }

    fn front(temperature: f64, velocity: f64) -> Front {
        (temperature, velocity, 0.01)
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
