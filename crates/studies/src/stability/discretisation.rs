//! A3: the discretisation error of Störmer–Verlet on ẍ = w²x, whose solution e^{wt} is known.

use lennard_observables::statistics::Line;
use serde::Serialize;

use super::groups::entry;
use super::oscillator::Spring;
use crate::StudyError;

/// The steps, as wh.
const STEPS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];
/// The end of the runs, as wt.
const END: f64 = 8.0;
/// wt from which the line is fitted to the Taylor start's error: before it, the decaying root e^{−2wt}
/// of the start is still there.
const FIT_FROM: f64 = 4.0;

/// The error growth at one step.
#[derive(Debug, Clone, Serialize)]
pub struct GrowthError {
    /// wh.
    pub wh: f64,
    /// Coefficient c in ln(x_n/e^{wt}) = −c·(wh)²·wt with x_1 = q₊: to be 1/24.
    pub exact_start_coefficient: f64,
    /// The same as the slope of the error over wt with the Taylor start.
    pub taylor_start_coefficient: f64,
    /// Offset of that line in units of (wh)²: to be near −1/16.
    pub taylor_start_offset: f64,
    /// wt of each step.
    #[serde(skip)]
    pub times: Vec<f64>,
    /// |x_n/e^{wt} − 1| with x_1 = q₊.
    #[serde(skip)]
    pub exact_start_errors: Vec<f64>,
    /// |x_n/e^{wt} − 1| with the Taylor start.
    #[serde(skip)]
    pub taylor_start_errors: Vec<f64>,
}

/// Runs both starts at every step, with w = 1.
pub(crate) fn measure() -> Result<Vec<GrowthError>, StudyError> {
    STEPS.iter().map(|wh| growth(*wh)).collect()
}

/// q₊ = 1 + ½z² + z·√(1 + ¼z²), the growing root of the recurrence.
fn growing_root(z: f64) -> f64 {
    1.0 + 0.5 * z * z + z * (1.0 + 0.25 * z * z).sqrt()
}

fn growth(z: f64) -> Result<GrowthError, StudyError> {
    // The method starts from x(−h) = x − h·v + ½h²·a: this velocity makes it 1/q₊, and so x(h) = q₊.
    let exact_velocity = (1.0 + 0.5 * z * z - growing_root(z).recip()) / z;
    let exact = logarithms(z, exact_velocity)?;
    let taylor = logarithms(z, 1.0)?;
    let last = exact[exact.len() - 1];
    let late: Vec<(f64, f64)> = taylor.iter().copied().filter(|p| p.0 >= FIT_FROM).collect();
    let line = Line::through(&late);
    let errors = |points: &[(f64, f64)]| points.iter().map(|p| p.1.exp_m1().abs()).collect();
    Ok(GrowthError {
        wh: z,
        exact_start_coefficient: -last.1 / (z * z * last.0),
        taylor_start_coefficient: -line.slope() / (z * z),
        taylor_start_offset: line.intercept() / (z * z),
        times: exact.iter().map(|p| p.0).collect(),
        exact_start_errors: errors(&exact),
        taylor_start_errors: errors(&taylor),
    })
}

/// (wt, ln x_n − wt) at each step from x = 1.
fn logarithms(z: f64, velocity: f64) -> Result<Vec<(f64, f64)>, StudyError> {
    let method = entry("stormer-verlet")?;
    let mut rig = Spring::Stiffness(-1.0).start(method, (1.0, velocity), z)?;
    let steps = (END / z).round() as u32;
    (1..=steps)
        .map(|n| {
            let x = rig.next_point()?.x;
            let t = f64::from(n) * z;
            Ok((t, x.ln() - t))
        })
        .collect()
}
