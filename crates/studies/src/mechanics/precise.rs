//! Pendulums and chains against solutions of high precision.

use lennard_core::DVec3;
use lennard_integrators::BondOptions;
use lennard_observables::{Cell, Table};

use super::bodies::{Bodies, distance};
use super::bodies::{damped, projected, relaxed};
use crate::StudyError;
use crate::claims::Measured;
use crate::stability::fit::slope;

/// Gravity of the shipped chain, σ/τ²: the number of standard gravity in SI.
pub(crate) const G: f64 = 9.81;

/// A problem with a known answer.
struct Problem {
    name: &'static str,
    case: Bodies,
    end: f64,
    /// Positions at the end, of the beads that follow the held one.
    known: Vec<DVec3>,
}

/// The position of a pendulum of length 1 at an angle from the downward vertical, σ.
fn at_angle(theta: f64) -> DVec3 {
    DVec3::new(theta.sin(), 0.0, -theta.cos())
}

/// The problems; answers by a Runge–Kutta method of order 8 with a tolerance of 2.3e-14.
fn problems() -> Result<Vec<Problem>, StudyError> {
    let pendulum = Bodies::hanging(1, 1.0)?;
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    let mut spherical = pendulum.clone();
    spherical.x[1] = DVec3::new(sin, 0.0, -cos);
    spherical.v[1] = DVec3::new(0.0, 1.0, 0.0);
    Ok(vec![
        Problem {
            name: "pendulum from 90°, t = 1 τ",
            case: pendulum,
            end: 1.0,
            known: vec![at_angle(-1.405027311525)],
        },
        Problem {
            name: "spherical pendulum, t = 2 τ",
            case: spherical,
            end: 2.0,
            known: vec![DVec3::new(0.672563575976, 0.460552636972, -0.579266350523)],
        },
        Problem {
            name: "double pendulum from 90°, t = 1 τ",
            case: Bodies::hanging(2, 1.0)?,
            end: 1.0,
            known: vec![
                DVec3::new(-0.585168391999, 0.0, -0.810911803469),
                DVec3::new(-1.444818849943, 0.0, -1.321794461381),
            ],
        },
        Problem {
            name: "chain of 5, t = 0.5 τ",
            case: Bodies::hanging(5, 0.2)?,
            end: 0.5,
            known: vec![DVec3::new(-0.056664541268, 0.0, -0.975802326581)],
        },
    ])
}

/// A way on a problem.
struct Solved {
    problem: &'static str,
    way: &'static str,
    /// Steps and the largest error of a position, σ.
    errors: Vec<(f64, f64)>,
    /// Order between the two smallest steps.
    order: f64,
}

/// Measures all problems with four ways.
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let steps: &[u32] = if quick { &[1000, 2000] } else { &[500, 1000, 2000, 4000, 8000] };
    let ways: [(&str, BondOptions, f64); 4] = [
        ("direct", BondOptions::default(), 2.0),
        ("relaxation, 10⁻¹²", relaxed(1e-12), 2.0),
        ("relaxation, new direction", projected(), 1.0),
        ("spook, τ = 2h", damped(2.0), 1.0),
    ];
    let mut solved = Vec::new();
    for Problem { name: problem, case, end, known } in problems()? {
        for (way, bonds, theory) in &ways {
            let mut errors = Vec::new();
            for steps in steps {
                if let Ok(found) = case.run(bonds, end, *steps)? {
                    let beads = &found.positions[found.positions.len() - known.len()..];
                    errors.push((end / f64::from(*steps), distance(beads, &known)));
                }
            }
            let order = match errors.as_slice() {
                [.., a, b] => slope(*a, *b),
                _ => f64::NAN,
            };
            let number = all.numbers.add("order of a known solution", order);
            number.of("problem", problem).of("way", way).theory(*theory);
            solved.push(Solved { problem, way, errors, order });
        }
    }
    let each: Vec<_> = solved.iter().flat_map(|s| s.errors.iter().map(move |e| (s, e))).collect();
    let table = Table::rows_of("solved", &each)
        .column("problem", |(s, _)| s.problem)
        .column("way", |(s, _)| s.way)
        .column("dt", |(_, e)| e.0)
        .column("position error", |(_, e)| e.1);
    all.tables.push(table.table());
    let in_a_line = Table::rows_of("solved-in-a-line", &solved)
        .caption("Largest error of a position at the end, at the smallest step.")
        .column("Problem", |s| s.problem)
        .column("Way", |s| s.way)
        .column("Step", |s| Cell::rounded(s.errors.last().map(|e| e.0), 3))
        .column("Error", |s| Cell::rounded(s.errors.last().map(|e| e.1), 3))
        .column("Order", |s| Cell::rounded(s.order, 3));
    all.given.tables.push(in_a_line.table());
    Ok(())
}
