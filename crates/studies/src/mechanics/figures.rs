//! The figures of bonds, relaxation and SPOOK.

use crate::report::{Axis, Dash, Figure, Guide, Look, Picture, Series, Symbol};

use super::comparison::{AtStep, LARGEST_STEP, WayResults};
use super::maps::{DAMPING, theory};
use super::study::MechanicsMeasurements;

/// A vertical line in figures against ωh for s = ∞ stands here.
const AT_INFINITY: f64 = 60.0;

/// A value of a way at a step.
type Value = fn(&WayResults, &AtStep) -> (f64, f64);

fn chart(
    found: &MechanicsMeasurements,
    name: &str,
    title: &str,
    (x, y): (Axis, Axis),
    value: Value,
    words: String,
) -> Picture {
    let mut figure = Figure::new(name, title, x, y);
    for (i, way) in found.ways.iter().enumerate() {
        let points = way.points.iter().map(|p| value(way, p));
        figure = figure.with(Series::new(&way.name, Look::joined(i), i, points));
    }
    Picture::new(figure, words, "ways.csv")
}

/// Errors of each way against the step and against the cost.
pub(super) fn ways(found: &MechanicsMeasurements) -> Vec<Picture> {
    let step = || Axis::logarithmic("h / τ");
    let cost = || Axis::logarithmic("ns per bond and τ of motion");
    let position = || Axis::logarithmic("error of a position / σ");
    let energy = || Axis::logarithmic("RMS of E − E(0) / ε");
    let about = "Two dumbbells that meet, at t = 2.5 τ, against rigid dumbbells in high precision.";
    vec![
        chart(
            found,
            "ways-error",
            "Bonds held in each way: error",
            (step(), position()),
            |_, p| (p.dt, p.position_error),
            format!("{about} Springs end at the error of their model, which falls as 1/k; a line ends where a run fails."),
        ),
        chart(
            found,
            "ways-energy",
            "Bonds held in each way: energy",
            (step(), energy()),
            |_, p| (p.dt, p.energy_rms),
            "RMS of the energy on the same run. SPOOK publishes velocities half a step behind: its RMS falls as h alone.".into(),
        ),
        chart(
            found,
            "ways-cost",
            "Bonds held in each way: error against cost",
            (cost(), position()),
            |way, p| (way.cost[0] / p.dt, p.position_error),
            "The same errors against what a bond costs for a time of 1 τ: kick, drift and bond, without pair forces. Costs are the fastest of repeated blocks.".into(),
        ),
        limits(found),
    ]
}

/// The smallest error that a way reaches, and the largest step that it bears.
fn limits(found: &MechanicsMeasurements) -> Picture {
    let mut figure = Figure::new(
        "ways-limit",
        "Bonds held in each way: largest step",
        Axis::logarithmic("error at the smallest step / σ"),
        Axis::logarithmic("largest stable step / τ"),
    );
    let of = |way: &WayResults| {
        let smallest = way.points.last()?;
        let step = way.largest_step.unwrap_or(LARGEST_STEP);
        Some((smallest.position_error, step))
    };
    for (i, way) in found.ways.iter().enumerate() {
        figure = figure.with(Series::new(&way.name, Look::marks(i), i, of(way)));
    }
    // Through the stiffest of the explicit springs.
    let stiffest = found.ways.iter().find(|way| way.name == "spring, k = 64000");
    if let Some((error, step)) = stiffest.and_then(of) {
        let law = [1.0, 256.0].map(|more: f64| (error * more, step * more.sqrt()));
        figure = figure.with(Series::new(
            "springs: error ∝ h²",
            Look::Line(Dash::Dashed),
            found.ways.len(),
            law,
        ));
    }
    Picture::new(
        figure,
        format!(
            "The largest stable step of a rotor that vibrates, against the error that is left at the smallest step. \
             Half the error of an explicit spring costs √2 times the steps. Marks at {LARGEST_STEP} τ had no limit up to there."
        ),
        "ways.csv",
    )
}

/// Convergence of sweeps.
pub(super) fn rates(found: &MechanicsMeasurements) -> Picture {
    let straight =
        || found.relaxing.rates.iter().filter(|r| r.angle == 0.0 && r.over_relaxation == 1.0);
    let sweeps = |rate: f64| -12.0 * 10.0_f64.ln() / rate.ln();
    let mut figure = Figure::new(
        "sweeps",
        "Sweeps of relaxation against the length of a chain",
        Axis::logarithmic("bonds n"),
        Axis::logarithmic("sweeps for a factor of 10⁻¹²"),
    );
    let law = (2..=100)
        .map(|n| (f64::from(n), sweeps((std::f64::consts::PI / f64::from(n + 1)).cos().powi(2))));
    figure = figure.with(Series::new("cos²(π/(n + 1))", Look::Line(Dash::Solid), 0, law));
    let best = (2..=100).map(|n| {
        let omega = 2.0 / (1.0 + (std::f64::consts::PI / f64::from(n + 1)).sin());
        (f64::from(n), sweeps(omega - 1.0))
    });
    figure = figure.with(Series::new("best over-relaxation", Look::Line(Dash::Dashed), 1, best));
    let points = straight().map(|r| (r.bonds as f64, sweeps(r.measured)));
    figure = figure.with(Series::new("measured", Look::Points(Symbol::Disc), 0, points));
    let points = found.relaxing.rates.iter().filter(|r| r.over_relaxation != 1.0);
    let points = points.map(|r| (r.bonds as f64, sweeps(r.measured)));
    figure = figure.with(Series::new(
        "measured, near the best ω",
        Look::Points(Symbol::Ring),
        1,
        points,
    ));
    Picture::new(
        figure,
        "Sweeps over a straight chain. The direct solve needs one to five iterations at any length.",
        "rates.csv",
    )
}

/// Energy and sweeps against the tolerance.
pub(super) fn tolerances(found: &MechanicsMeasurements) -> Vec<Picture> {
    let mut steps: Vec<f64> = found.relaxing.tolerances.iter().map(|t| t.dt).collect();
    steps.dedup();
    let axis = || Axis::logarithmic("tolerance");
    let mut energy = Figure::new(
        "tolerance-energy",
        "Energy against the tolerance",
        axis(),
        Axis::logarithmic("RMS of E − E(0) / ε"),
    );
    let mut sweeps = Figure::new(
        "tolerance-sweeps",
        "Sweeps against the tolerance",
        axis(),
        Axis::linear("sweeps per step"),
    );
    for (i, dt) in steps.iter().enumerate() {
        let at = || found.relaxing.tolerances.iter().filter(move |t| t.dt == *dt);
        let name = format!("h = {dt} τ");
        energy = energy
            .with(Series::new(&name, Look::joined(i), i, at().map(|t| (t.tolerance, t.energy_rms))))
            .with(Series::new(
                "",
                Look::Line(Dash::Dotted),
                i,
                at().map(|t| (t.tolerance, t.bound)),
            ));
        sweeps = sweeps.with(Series::new(
            &name,
            Look::joined(i),
            i,
            at().map(|t| (t.tolerance, t.sweeps)),
        ));
    }
    vec![
        Picture::new(
            energy,
            "Two dumbbells that meet, with relaxation. With a loose tolerance a shorter step does not help. Dotted: ½μ·(tol·r/h)² of both bonds, which velocities would have that kept the corrections; the velocity stage here is exact and takes most of it off.",
            "tolerances.csv",
        ),
        Picture::new(sweeps, "Sweeps per step on the same runs.", "tolerances.csv"),
    ]
}

/// The rotor that slows down, and drift of fluids.
pub(super) fn direction(found: &MechanicsMeasurements) -> Vec<Picture> {
    let slow = &found.relaxing.slowing;
    let figure = Figure::new(
        "rotor",
        "A rotor under projection along the new bond",
        Axis::logarithmic("step n"),
        Axis::logarithmic("angle per step / rad"),
    )
    .with(Series::new(
        "α₀/√(1 + 2α₀²n)",
        Look::Line(Dash::Solid),
        0,
        slow.iter().map(|s| (f64::from(s.step), s.theory)),
    ))
    .with(Series::new(
        "measured",
        Look::Points(Symbol::Disc),
        0,
        slow.iter().map(|s| (f64::from(s.step), s.measured)),
    ));
    let rotor = Picture::new(
        figure,
        "A free dumbbell at α₀ = 0.1. Along the old bond it turns by the same angle for ever.",
        "rotor.csv",
    );
    let mut figure = Figure::new(
        "drift-density",
        "Drift of the energy against density",
        Axis::linear("ρ / molecules per σ³"),
        Axis::linear("drift / ε per τ and molecule"),
    )
    .level(0.0, "");
    for (i, way) in ["relaxation, new direction", "direct"].iter().enumerate() {
        let runs = || found.drifts.iter().filter(move |d| d.way == *way && d.dt == 0.002);
        figure = figure.with(Series::new(
            *way,
            Look::joined(i),
            i,
            runs().map(|d| (d.density, d.drift)),
        ));
        if i == 0 {
            let law = runs().map(|d| (d.density, d.law));
            figure = figure.with(Series::new("−h·⟨T_b·r·Ω²⟩", Look::Line(Dash::Dashed), 2, law));
        }
    }
    let drift = Picture::new(
        figure,
        "Fluids of dumbbells (L = 0.67 σ, T near 2, h = 0.002 τ) at constant energy. The projection cools a gas and heats a dense liquid: where its line \
         crosses zero, a single state point would prove nothing.",
        "drifts.csv",
    );
    vec![rotor, drift]
}

/// The amplification map of SPOOK.
pub(super) fn maps(found: &MechanicsMeasurements) -> Picture {
    let mut figure = Figure::new(
        "spook-amplification",
        "Amplification of SPOOK on a damped spring",
        Axis::logarithmic("ωh").from_to(0.1, 100.0),
        Axis::linear("spectral radius of the one-step map").from_to(0.0, 1.1),
    )
    .guided(Guide::Vertical(AT_INFINITY, "ε = 0".into()));
    for (i, damping) in DAMPING.iter().enumerate() {
        let name = match *damping == 0.0 {
            true => "τ = 0".to_owned(),
            false => format!("τ = {damping} h"),
        };
        let dense = (0..=300).map(|k| 0.1 * 400.0_f64.powf(f64::from(k) / 300.0));
        let line = dense.map(|s| (s, theory(s, *damping).radius()));
        let points = found.maps.points.iter().filter(|p| p.damping == *damping);
        let points = points.map(|p| (p.phase.min(AT_INFINITY), p.measured));
        figure = figure
            .with(Series::new("", Look::line(i), i, line))
            .with(Series::new("", Look::marks(i), i, points))
            .with(Series::entry(name, Look::joined(i), i));
    }
    Picture::new(
        figure,
        "Lines: [[1 − q, p], [−q, p]] with p = γ(s² + 4)/(s² + 4γ), q = 4γs²/(s² + 4γ). Marks: three states of a run. Marks on the \
         vertical line are ε = 0; there τ = 2h has the smallest radius, 1/3.",
        "spook-map.csv",
    )
}
