//! Orders of convergence.

use lennard_core::{StepError, System};

use super::{Kepler, KeplerForces, run};
use crate::IntegratorEntry;

/// Errors at one step size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPoint {
    /// The step, τ.
    pub dt: f64,
    /// Distance from the exact position, σ.
    pub position: f64,
    /// Distance from the exact velocity, σ/τ.
    pub velocity: f64,
}

/// Measured orders with the points behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Orders {
    /// Order of the positions.
    pub position: f64,
    /// Order of the velocities.
    pub velocity: f64,
    /// The errors, from the largest step to the smallest.
    pub points: Vec<ErrorPoint>,
}

/// The exponent p of error = C·dtᵖ, by least squares on the logarithms of (dt, error).
#[must_use]
pub fn fitted_order(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mean_x, mean_y) =
        points.iter().fold((0.0, 0.0), |(x, y), (dt, error)| (x + dt.ln() / n, y + error.ln() / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), (dt, error)| {
        let dx = dt.ln() - mean_x;
        (xy + dx * (error.ln() - mean_y), xx + dx * dx)
    });
    xy / xx
}

impl From<Vec<ErrorPoint>> for Orders {
    fn from(points: Vec<ErrorPoint>) -> Self {
        let column = |error: fn(&ErrorPoint) -> f64| -> Vec<(f64, f64)> {
            points.iter().map(|p| (p.dt, error(p))).collect()
        };
        Self {
            position: fitted_order(&column(|p| p.position)),
            velocity: fitted_order(&column(|p| p.velocity)),
            points,
        }
    }
}

/// Errors of a method on the ellipse [`Kepler::for_orders`] at the time `duration`, for each number of
/// steps.
///
/// # Errors
/// As the method's own steps.
pub fn global_errors(
    entry: &IntegratorEntry,
    duration: f64,
    steps: &[u64],
) -> Result<Vec<ErrorPoint>, StepError> {
    let orbit = Kepler::for_orders();
    let (x, v) = orbit.at(duration);
    let system = System::atoms(1);
    steps
        .iter()
        .map(|&n| {
            let dt = duration / n as f64;
            let mut state = orbit.start();
            let mut integrator = entry.build();
            run(&mut integrator, &system, &mut KeplerForces, &mut state, dt, n, |_, _| {})?;
            Ok(ErrorPoint {
                dt,
                position: (state.positions[0] - x).length(),
                velocity: (state.velocities[0] - v).length(),
            })
        })
        .collect()
}

/// Global orders of a method, measured on the ellipse at t = 4 with steps where its leading error
/// stands clear of the next one and of rounding.
///
/// # Errors
/// As the method's own steps.
pub fn orders(entry: &IntegratorEntry) -> Result<Orders, StepError> {
    const DURATION: f64 = 4.0;
    let steps: &[u64] = match entry.spec.position_order {
        // The next error is of relative order h: it must be below 1 %.
        0 | 1 => &[4_000, 8_000, 16_000],
        2 | 3 => &[200, 400, 800],
        // Rounding ends at 1e-15 a step, which a method of order 4 and a small constant meets soon.
        _ => &[160, 240, 320],
    };
    Ok(global_errors(entry, DURATION, steps)?.into())
}
