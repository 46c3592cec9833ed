//! The figures of the oscillator part.

use crate::report::{Axis, Dash, Figure, Guide, Look, Picture, Series, Symbol};

use super::amplification::{MapPoint, theory};
use super::displacement::{Case, Run, STEP};
use super::groups::Group;
use super::map::StepMap;
use super::study::OscillatorStudy;

/// The largest spectral radius shown.
const TALLEST: f64 = 3.0;
/// |x| in σ at which a line that leaves its figure is not followed any further.
const OUT_OF_SIGHT: f64 = 2e4;
/// Steps shown in the close view of a stiff case.
const CLOSE_STEPS: usize = 24;

pub(crate) fn dense(from: f64, to: f64, n: u32) -> impl Iterator<Item = f64> {
    (0..=n).map(move |i| from + (to - from) * f64::from(i) / f64::from(n))
}

/// The measured points of a group.
fn points_of(study: &OscillatorStudy, group: usize) -> impl Iterator<Item = &MapPoint> {
    let methods = study.methods.iter().filter(move |m| m.group == group);
    methods.flat_map(|m| &m.points)
}

/// The entry of a group in the legend.
fn entry(group: &Group, index: usize) -> Series {
    Series::entry(&group.name, Look::joined(index), index)
}

/// Theory as lines, one per group, and the measurement of every method as marks beside each other.
pub(crate) fn amplification(study: &OscillatorStudy) -> Picture {
    let mut figure = Figure::new(
        "amplification",
        "Amplification of one step on the oscillator",
        Axis::linear("ωh").from_to(0.0, 4.0),
        Axis::linear("spectral radius of the one-step map").from_to(0.0, TALLEST),
    )
    .level(1.0, "")
    .guided(Guide::Vertical(2.0, "ωh = 2".into()));
    for (g, group) in study.groups.iter().enumerate() {
        let radius = |x| theory(group.first(), x).map_or(f64::NAN, StepMap::radius);
        figure = figure.line("", g, dense(0.004, 4.0, 999).map(|x| (x, radius(x))));
    }
    for (g, group) in study.groups.iter().enumerate() {
        let points =
            points_of(study, g).map(|p| (p.omega_h, p.measured_radius)).filter(|p| p.1 <= TALLEST);
        figure = figure.marks("", g, points).with(entry(group, g));
    }
    Picture::new(
        figure,
        "Spectral radius of the one-step map on ẍ = −ω²x against ωh. Lines: the map that each method \
         declares. Marks: the map that three consecutive states of a run show. Above 1 a run grows, below 1 \
         it decays.",
        "amplification.csv",
    )
}

pub(crate) fn phase(study: &OscillatorStudy) -> Picture {
    let mut figure = Figure::new(
        "phase-error",
        "Phase error of one step on the oscillator",
        Axis::logarithmic("ωh").from_to(0.05, 3.2),
        Axis::logarithmic("|θ/(ωh) − 1|").from_to(1e-12, 2.0),
    );
    let error = |omega_h: f64, phase: f64| (phase / omega_h - 1.0).abs();
    for (g, group) in study.groups.iter().enumerate() {
        if group.first().spec.position_order == 0 {
            // The exact solution has no phase error to show on a logarithmic axis.
            continue;
        }
        let line = dense(0.05_f64.ln(), 3.2_f64.ln(), 400).map(f64::exp).map(|x| {
            let phase = theory(group.first(), x).and_then(StepMap::phase);
            (x, phase.map_or(f64::NAN, |p| error(x, p)))
        });
        let points = points_of(study, g)
            .filter_map(|p| Some((p.omega_h, error(p.omega_h, p.measured_phase?))));
        figure = figure.line("", g, line).marks("", g, points).with(entry(group, g));
    }
    Picture::new(
        figure,
        "The angle θ by which a step turns the oscillator, against the true angle ωh. Lines: declared maps. \
         Marks: measured. The slope is the order of the method in h; a line ends where its eigenvalues \
         become real.",
        "amplification.csv",
    )
}

/// Displacement, its first steps, and energy, for one stiffness.
pub(crate) fn case(case: &Case, groups: &[Group]) -> Vec<Picture> {
    // Large swings first: small ones are drawn over them.
    let mut runs: Vec<&Run> = case.runs.iter().collect();
    let size = |r: &Run| r.positions.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    runs.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let steps = runs.iter().map(|r| r.positions.len()).max();
    let last = steps.unwrap_or(1) - 1;
    let picture = |stem: &str, title: &str, last: usize, y: Axis, value: Value, caption: String| {
        let x = Axis::linear("time / τ").from_to(0.0, last as f64 * STEP);
        let name = format!("{stem}-{}", case.name);
        let mut figure = Figure::new(name, format!("{title}, {}", case.title), x, y);
        for run in &runs {
            figure = figure.with(line_of(run, last, value));
        }
        for (g, group) in groups.iter().enumerate() {
            figure = figure.with(Series::entry(&group.name, Look::line(g), g));
        }
        Picture::new(figure, caption, format!("displacement-{}.csv", case.name))
    };
    let reach = if case.name == "k-inside" { 130.0 } else { 3.5 };
    let position: Value = |run, n| run.positions[n];
    let mut pictures = vec![picture(
        "displacement",
        "Displacement",
        last,
        Axis::linear("x / σ").from_to(-reach, reach),
        position,
        format!(
            "Displacement against time at {} (ωh = {:.6}), from 1 σ at rest, h = {STEP} τ; one line for \
             each distinct one-step map.",
            case.title, case.omega_h
        ),
    )];
    if case.name != "k-100" {
        pictures.push(picture(
            "first-steps",
            &format!("The first {CLOSE_STEPS} steps"),
            CLOSE_STEPS,
            Axis::linear("x / σ").from_to(-3.5, 3.5),
            position,
            "The same, close up: with so few steps in a period every line is a zigzag between its points.".into(),
        ));
    }
    pictures.push(picture(
        "energy",
        "Energy",
        last,
        Axis::logarithmic("(½kx² + ½mv²) / E(0)").from_to(1e-4, 1e8),
        |run, n| run.energies[n] / run.energies[0],
        "Energy against time over the energy at the start, on a logarithmic axis: a straight rise is \
         exponential growth."
            .into(),
    ));
    pictures
}

/// A number of a run at a step.
type Value = fn(&Run, usize) -> f64;

/// A run up to a step, or to where it leaves every figure. A cross marks where a method stopped by itself.
fn line_of(run: &Run, last: usize, value: Value) -> Series {
    let out_of_sight = |x: &f64| x.abs() > OUT_OF_SIGHT;
    let sight = run.positions.iter().position(out_of_sight);
    let steps = run.positions.len();
    let shown = sight.map_or(steps, |n| n + 1).min(last + 1);
    let points = (0..shown).map(|n| (n as f64 * STEP, value(run, n)));
    let series = Series::new("", Look::line(run.group), run.group, points);
    if run.stopped.is_some() && steps <= last + 1 {
        return series.with_failures(vec![(steps - 1) as f64 * STEP]);
    }
    series
}

pub(crate) fn infinite(study: &OscillatorStudy) -> Picture {
    let found = &study.infinite;
    let steps = || found.shown_steps.iter().map(|n| f64::from(*n));
    let mut figure = Figure::new(
        "infinite-stiffness",
        "SPOOK as k → ∞",
        Axis::logarithmic("step n"),
        Axis::logarithmic("|x| / σ").from_to(1e-6, 1e5),
    );
    for (i, run) in found.rigid.iter().enumerate() {
        let name = if run.damping_steps == 0.0 {
            "k = ∞, τ = 0".to_owned()
        } else {
            format!("k = ∞, τ = {} h", run.damping_steps)
        };
        let look = if i == 0 { Look::Points(Symbol::Disc) } else { Look::line(i) };
        let points = steps().zip(run.displacements.iter().copied());
        figure = figure.with(Series::new(name, look, i, points));
    }
    for (i, run) in found.stiff.iter().enumerate().skip(1) {
        let color = found.rigid.len() + i - 1;
        let points = envelope(steps().zip(run.displacements.iter().copied()));
        let name = format!("ωh = {}, τ = 0", run.omega_h);
        figure = figure.with(Series::new(name, Look::Line(Dash::Dashed), color, points));
    }
    let line = steps().map(|n| (n, 2.0 * n + 1.0));
    figure = figure.with(Series::new("theory: 2n + 1", Look::Line(Dash::Dotted), 6, line));
    Picture::new(
        figure,
        "SPOOK with ε = 0 (k = ∞): without damping |x| grows as 2n + 1, with any damping it dies away. \
         Dashed: large finite stiffnesses (envelope of |x|) follow the same line until their amplitude \
         √(1 + ω²h²/4) is reached.",
        "infinite-stiffness.csv",
    )
}

/// The largest value so far.
fn envelope(points: impl Iterator<Item = (f64, f64)>) -> impl Iterator<Item = (f64, f64)> {
    points.scan(0.0_f64, |largest, (x, y)| {
        *largest = largest.max(y);
        Some((x, *largest))
    })
}
