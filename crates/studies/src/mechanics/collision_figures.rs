//! The figures of collisions, pressures and fluids.

use crate::report::{Axis, Dash, Figure, Look, Picture, Series, Symbol};

use super::study::MechanicsMeasurements;

/// Springs of walls.
pub(super) fn penalty(found: &MechanicsMeasurements) -> Vec<Picture> {
    let stiff = &found.collisions.stiff;
    let gain = |f: fn(&super::collisions::StiffHit) -> f64| {
        stiff.iter().map(move |hit| (hit.phase, f(hit)))
    };
    let figure = Figure::new(
        "penalty-energy",
        "A penalty force that is too strong",
        Axis::linear("ωh").from_to(0.0, 2.0),
        Axis::logarithmic("change of the energy per hit").from_to(1e-8, 10.0),
    )
    .with(Series::new("mean gain", Look::joined(0), 0, gain(|h| h.gain.abs())))
    .with(Series::new("RMS of the change", Look::joined(1), 1, gain(|h| h.rms)));
    let energy = Picture::new(
        figure,
        "Hits of an undamped spring under velocity Verlet, over all phases of the step. The gain is not monotonic: near ωh = 1 half a period is three steps.",
        "penalty.csv",
    );
    let figure = Figure::new(
        "penalty-depth",
        "Depth of a penalty contact",
        Axis::linear("ωh").from_to(0.0, 2.0),
        Axis::linear("greatest depth over v/ω"),
    )
    .level(1.0, "theory")
    .with(Series::new("measured", Look::joined(0), 0, gain(|h| h.depth)));
    let depth = Picture::new(
        figure,
        "How deep a particle gets, over v/ω = v·√(m/k). A wall of thickness D holds particles with v < ω·D alone: that is the weak end.",
        "penalty.csv",
    );
    let mut figure = Figure::new(
        "bounces",
        "A bouncing ball",
        Axis::linear("t / τ").from_to(0.0, 12.0),
        Axis::linear("height / σ").from_to(0.0, 1.3),
    );
    for (i, ball) in found.collisions.bouncing.iter().enumerate() {
        if ball.rule == "billiard" {
            continue;
        }
        let name = format!("{}, e = {}", ball.rule, ball.restitution);
        figure = figure.with(Series::new(name, Look::line(i), i, ball.path.iter().copied()));
    }
    let bounces = Picture::new(
        figure,
        "Dropped from 1 σ with g = 1, h = 0.01 τ. Under the event rule heights fall as e²ⁿ; a mirror gains energy; a projection keeps none.",
        "bounces.csv",
    );
    vec![energy, depth, bounces]
}

/// Pressures between walls.
pub(super) fn pressure(found: &MechanicsMeasurements) -> Picture {
    let points = &found.pressure.points;
    let figure = Figure::new(
        "wall-pressure",
        "Pressure on hard walls and pressure of the virial",
        Axis::logarithmic("t / τ"),
        Axis::linear("P / ε σ⁻³"),
    )
    .with(Series::new(
        "virial",
        Look::Line(Dash::Solid),
        1,
        points.iter().map(|p| (p.time, p.of_virial)),
    ))
    .with(Series::new(
        "virial less boundary term",
        Look::Line(Dash::Dashed),
        2,
        points.iter().map(|p| (p.time, p.with_boundary)),
    ))
    .with(Series::new(
        "walls",
        Look::Points(Symbol::Disc),
        0,
        points.iter().map(|p| (p.time, p.of_walls)),
    ));
    Picture::new(
        figure,
        "108 atoms between hard walls (ρ = 0.6, T = 1.5), from the momentum of hits and from speeds and forces. With the boundary term both are one number at each step.",
        "wall-pressure.csv",
    )
}

/// Fluids of dumbbells beside equations of state.
pub(super) fn states(found: &MechanicsMeasurements) -> Vec<Picture> {
    let all = &found.states;
    let draw = |name: &str,
                title: &str,
                y: &str,
                of: fn(&super::fluid::StateResults) -> [f64; 3]| {
        let series = |k: usize| all.iter().map(move |s| (s.density, of(s)[k]));
        let figure =
            Figure::new(name, title, Axis::linear("ρ / molecules per σ³"), Axis::linear(y))
                .with(Series::new("Lísal 2004", Look::joined(1), 1, series(1)))
                .with(Series::new("Mecke 1997", Look::joined(2), 2, series(2)))
                .with(Series::new("measured", Look::Points(Symbol::Disc), 0, series(0)));
        Picture::new(
            figure,
            "Rigid dumbbells, L = 0.67 σ, at T near 2.4, with the tail correction; the equations at the measured temperature of half steps.",
            "states.csv",
        )
    };
    vec![
        draw("states-energy", "Energy of dumbbells", "u / ε per molecule", |s| {
            [s.energy.0, s.lisal.0, s.mecke.0]
        }),
        draw("states-pressure", "Pressure of dumbbells", "p / ε σ⁻³", |s| {
            [s.pressure.0, s.lisal.1, s.mecke.1]
        }),
    ]
}
