//! The figures of the oscillator part.

use lennard_report::{Axis, Dash, Figure, Guide, Look, Picture, Series, Symbol};

use super::OscillatorStudy;
use super::amplification::{MapPoint, theory};
use super::displacement::{Case, Run, STEP};
use super::groups::Group;
use super::map::StepMap;

/// The largest spectral radius shown.
const TALLEST: f64 = 3.0;
/// |x| in m at which a line that leaves its figure is not followed any further.
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
        let points = points_of(study, g)
            .map(|p| (p.omega_h, p.measured_radius))
            .filter(|p| p.1 <= TALLEST);
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
        let line = dense(0.05_f64.ln(), 3.2_f64.ln(), 400)
            .map(f64::exp)
            .map(|x| {
                let phase = theory(group.first(), x).and_then(StepMap::phase);
                (x, phase.map_or(f64::NAN, |p| error(x, p)))
            });
        let points = points_of(study, g)
            .filter_map(|p| Some((p.omega_h, error(p.omega_h, p.measured_phase?))));
        figure = figure
            .line("", g, line)
            .marks("", g, points)
            .with(entry(group, g));
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
    let line = |run: &Run, values: &[f64], take: usize| {
        let sight = run
            .positions
            .iter()
            .position(|x| x.abs() > OUT_OF_SIGHT)
            .map_or(values.len(), |n| n + 1);
        let points = values.iter().take(take.min(sight)).enumerate();
        let points = points.map(|(n, v)| (n as f64 * STEP, *v));
        let series = Series::new("", Look::line(run.group), run.group, points);
        // Where a method stopped by itself is marked.
        match run.stopped {
            Some(_) if run.positions.len() < take => {
                series.with_failures(vec![(run.positions.len() - 1) as f64 * STEP])
            }
            _ => series,
        }
    };
    let time = || Axis::linear("time / s");
    let reach = if case.name == "k-inside" { 130.0 } else { 3.5 };
    let data = format!("displacement-{}.csv", case.name);
    // Large swings first: whatever stays small is drawn over them.
    let mut runs: Vec<&Run> = case.runs.iter().collect();
    let size = |r: &Run| r.positions.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    runs.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let end = runs.iter().map(|r| r.positions.len()).max().unwrap_or(1);
    let mut displacement = Figure::new(
        format!("displacement-{}", case.name),
        format!("Displacement, {}", case.title),
        time().from_to(0.0, (end - 1) as f64 * STEP),
        Axis::linear("x / m").from_to(-reach, reach),
    );
    let mut close = Figure::new(
        format!("first-steps-{}", case.name),
        format!("The first {CLOSE_STEPS} steps, {}", case.title),
        time().from_to(0.0, CLOSE_STEPS as f64 * STEP),
        Axis::linear("x / m").from_to(-3.5, 3.5),
    );
    let mut energy = Figure::new(
        format!("energy-{}", case.name),
        format!("Energy, {}", case.title),
        time().from_to(0.0, (end - 1) as f64 * STEP),
        Axis::logarithmic("(½kx² + ½mv²) / E(0)").from_to(1e-4, 1e8),
    );
    for run in runs {
        displacement = displacement.with(line(run, &run.positions, usize::MAX));
        close = close.with(line(run, &run.positions, CLOSE_STEPS + 1));
        let start = run.energies[0];
        let relative: Vec<f64> = run.energies.iter().map(|e| e / start).collect();
        energy = energy.with(line(run, &relative, usize::MAX));
    }
    for figure in [&mut displacement, &mut close, &mut energy] {
        for (g, group) in groups.iter().enumerate() {
            let entry = Series::entry(&group.name, Look::line(g), g);
            figure.series.push(entry);
        }
    }
    let mut figures = vec![Picture::new(
        displacement,
        format!(
            "Displacement against time at {} (ωh = {:.6}), from 1 m at rest, h = {STEP} s; one line for \
             each distinct one-step map.",
            case.title, case.omega_h
        ),
        data.as_str(),
    )];
    if case.name != "k-100" {
        figures.push(Picture::new(
            close,
            "The same, close up: with so few steps in a period every line is a zigzag between its points.",
            data.as_str(),
        ));
    }
    figures.push(Picture::new(
        energy,
        "Energy against time over the energy at the start, on a logarithmic axis: a straight rise is \
         exponential growth.",
        data.as_str(),
    ));
    figures
}

pub(crate) fn infinite(study: &OscillatorStudy) -> Picture {
    let found = &study.infinite;
    let steps = || found.shown_steps.iter().map(|n| f64::from(*n));
    let mut figure = Figure::new(
        "infinite-stiffness",
        "SPOOK as k → ∞",
        Axis::logarithmic("step n"),
        Axis::logarithmic("|x| / m").from_to(1e-6, 1e5),
    );
    for (i, run) in found.rigid.iter().enumerate() {
        let name = if run.damping_steps == 0.0 {
            "k = ∞, τ = 0".to_owned()
        } else {
            format!("k = ∞, τ = {} h", run.damping_steps)
        };
        let look = if i == 0 {
            Look::Points(Symbol::Disc)
        } else {
            Look::line(i)
        };
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
    figure = figure.with(Series::new(
        "theory: 2n + 1",
        Look::Line(Dash::Dotted),
        6,
        line,
    ));
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
