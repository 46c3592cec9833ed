//! The figures of the fluid part.

use crate::report::{Axis, Dash, Figure, Look, Picture, Point, Series};

use super::run::FluidRun;
use super::start::{STATES, StatePoint, TRUNCATIONS};
use super::study::{FluidStudy, SHOWN_TRUNCATION, limit_at};
use crate::stability::groups::groups;

/// Steps common to the energy figures, τ.
const DT_RANGE: (f64, f64) = (0.00091, 0.027);

fn dt_axis() -> Axis {
    Axis::logarithmic("dt / τ").from_to(DT_RANGE.0, DT_RANGE.1)
}

/// The figures of a kind, one per state point.
fn of_states(make: impl Fn(usize) -> Option<Picture>) -> impl Iterator<Item = Picture> {
    (0..STATES.len()).filter_map(make)
}

/// Energy and temperature against dt.
pub(super) fn energy(study: &FluidStudy) -> Vec<Picture> {
    of_states(|s| fluctuation(study, s))
        .chain(of_states(|s| drift(study, s)))
        .chain(of_states(|s| temperature(study, s)))
        .collect()
}

/// The truncations at each state point.
pub(super) fn truncations(study: &FluidStudy) -> Vec<Picture> {
    of_states(|s| truncation(study, s)).collect()
}

/// The methods that are drawn: name in the legend, method, index of colour and symbol.
fn drawn() -> Vec<(String, &'static str, usize)> {
    groups()
        .iter()
        .enumerate()
        .map(|(g, group)| (group.name.clone(), group.representative().spec.name, g))
        .collect()
}

fn series(
    name: &str,
    index: usize,
    runs: &[&FluidRun],
    value: impl Fn(&FluidRun) -> Option<(f64, Option<f64>)>,
) -> Series {
    let mut points = Vec::new();
    let mut failures = Vec::new();
    for run in runs {
        match value(run) {
            Some((y, error)) if run.completed() => points.push(Point {
                x: run.dt,
                y,
                error,
                note: Some(format!("{}, dt = {}", run.method, run.dt)),
                ..Point::default()
            }),
            _ => failures.push(run.dt),
        }
    }
    Series::new(name, Look::joined(index), index, points).with_failures(failures)
}

fn file_stem(kind: &str, state: usize) -> String {
    format!("fluid-{kind}-{}", ["triple-point", "t-1.5", "t-5"][state])
}

fn per_method(
    study: &FluidStudy,
    state: usize,
    kind: &str,
    title: &str,
    y: Axis,
    value: impl Fn(&FluidRun) -> Option<(f64, Option<f64>)>,
) -> Option<Figure> {
    let title = format!("{title}, {}", STATES[state].name);
    let mut figure = Figure::new(file_stem(kind, state), title, dt_axis(), y);
    for (name, method, i) in drawn() {
        let here = study.runs_at(state, SHOWN_TRUNCATION);
        let runs: Vec<&FluidRun> = here.filter(|r| r.method == method).collect();
        if !runs.is_empty() {
            figure = figure.with(series(&name, i, &runs, &value));
        }
    }
    (!figure.series.is_empty()).then_some(figure)
}

fn fluctuation(study: &FluidStudy, state: usize) -> Option<Picture> {
    let y = Axis::logarithmic("RMS of the energy / ε per atom");
    let figure = per_method(study, state, "fluctuation", "Energy fluctuation", y, |r| {
        Some((r.fluctuation?, None))
    })?;
    let caption = "RMS of the total energy around its own straight line against dt, force-shifted at \
                   2.5 σ. The slope is the order of the method until something else than dt decides. \
                   Crosses: the run did not reach its end.";
    Some(Picture::new(figure, caption, "fluid.csv"))
}

fn drift(study: &FluidStudy, state: usize) -> Option<Picture> {
    let y = Axis::logarithmic("|drift| / ε/τ per atom");
    let figure = per_method(study, state, "drift", "Energy drift", y, |r| {
        Some((r.drift?.abs(), r.drift_error))
    })?;
    let caption = "Size of the slope of the total energy against dt, with its standard error. Where the \
                   bar reaches the lower edge no drift was found in so short a run.";
    Some(Picture::new(figure, caption, "fluid.csv"))
}

fn temperature(study: &FluidStudy, state: usize) -> Option<Picture> {
    let y = Axis::linear("(T_kin − T_conf)/T").from_to(-0.15, 0.15);
    let figure = per_method(study, state, "temperature", "Temperature error", y, |r| {
        Some((r.temperature_error?, r.temperature_error_error))
    })?
    .level(0.0, "");
    let caption = "Kinetic less configurational temperature, Σ⟨F²⟩/⟨∇²U⟩, as a share of T*. In a correct \
                   ensemble both are equal; a finite step pulls them apart, and so does a method that \
                   heats or cools. All runs begin alike, so that they share part of the noise of one short run. \
                   Arrows at the edges lie beyond them.";
    Some(Picture::new(figure, caption, "fluid.csv"))
}

fn truncation(study: &FluidStudy, state: usize) -> Option<Picture> {
    let title = format!("Truncation and energy, velocity Verlet, {}", STATES[state].name);
    let y = Axis::logarithmic("RMS of the energy / ε per atom");
    let mut figure = Figure::new(file_stem("truncation", state), title, dt_axis(), y);
    for (i, (_, name)) in TRUNCATIONS.iter().enumerate() {
        let mut runs: Vec<&FluidRun> =
            study.runs_at(state, i).filter(|r| r.method == "velocity-verlet").collect();
        runs.sort_by(|a, b| a.dt.total_cmp(&b.dt));
        figure = figure.with(series(name, i, &runs, |r| Some((r.fluctuation?, None))));
    }
    if figure.is_empty() {
        return None;
    }
    let caption = "The same for the four ways to end the potential at 2.5 σ. The plain cutoff and the \
                   shifted one have the same forces, and both are judged by the energy that these conserve. \
                   Their force jumps at the cutoff, and each crossing leaves an error that falls more slowly \
                   than dt². It shows where points at the smallest steps leave the line of the smooth potentials.";
    Some(Picture::new(figure, caption, "fluid.csv"))
}

/// The largest stable steps against the temperature.
pub(super) fn limits(study: &FluidStudy) -> Option<Picture> {
    let mut figure = Figure::new(
        "fluid-limits",
        "Largest stable step on the fluid",
        Axis::logarithmic("T*").from_to(0.6, 6.5),
        Axis::logarithmic("largest stable dt / τ"),
    );
    for (name, method, i) in drawn() {
        let point = |(state, point): (usize, &StatePoint)| {
            let limit = limit_at(&study.limits, method, state, SHOWN_TRUNCATION)?;
            Some((point.temperature, limit.middle()?))
        };
        let points: Vec<(f64, f64)> = STATES.iter().enumerate().filter_map(point).collect();
        if !points.is_empty() {
            figure = figure.joined(name, i, points);
        }
    }
    if figure.is_empty() {
        return None;
    }
    let caption = "Largest stable step of every method against the temperature, force-shifted. A hotter \
                   fluid meets steeper parts of the core and bears smaller steps.";
    Some(Picture::new(figure, caption, "fluid-limits.csv"))
}

/// Small steps in double and in mixed precision.
pub(super) fn floors(study: &FluidStudy) -> Option<Picture> {
    if study.double.is_empty() {
        return None;
    }
    let mut figure = Figure::new(
        "fluid-precision",
        "Small steps in double and in mixed precision",
        Axis::logarithmic("dt / τ"),
        Axis::logarithmic("RMS of the energy / ε per atom"),
    );
    for (i, (name, runs)) in
        [("double precision", &study.double), ("mixed precision (pairs in f32)", &study.mixed)]
            .into_iter()
            .enumerate()
    {
        let runs: Vec<&FluidRun> = runs.iter().collect();
        figure = figure.with(series(name, i, &runs, |r| Some((r.fluctuation?, None))));
    }
    if let Some(last) = study.double.last().and_then(|r| Some((r.dt, r.fluctuation?))) {
        let first = study.double[0].dt;
        let law = [first, last.0].map(|dt| (dt, last.1 * (dt / last.0).powi(2)));
        figure = figure.with(Series::new("dt² law", Look::Line(Dash::Dotted), 6, law));
    }
    let caption = "Velocity Verlet near the triple point: the RMS of the energy falls as dt² until rounding \
                   of the pair forces takes over. Where the marks leave the line is the floor of that \
                   precision.";
    Some(Picture::new(figure, caption, "fluid-precision.csv"))
}
