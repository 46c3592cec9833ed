//! The critical point of an equation of state.

use crate::fluid_state::{CriticalPoint, FluidState};

const ITERATIONS: usize = 60;
/// Relative change of the temperature at which Newton's method has converged.
const CONVERGED: f64 = 1e-9;

/// The point where ∂p/∂ρ and ∂²p/∂ρ² vanish, by Newton's method from `start`; `start` itself where it does not converge.
pub(crate) fn critical_point(
    state_at: &dyn Fn(f64, f64) -> FluidState,
    start: CriticalPoint,
) -> CriticalPoint {
    let curvature = |rho: f64, t: f64| {
        let h = 1e-4 * rho;
        (state_at(rho + h, t).dp_drho - state_at(rho - h, t).dp_drho) / (2.0 * h)
    };
    let (mut rho, mut t) = (start.density, start.temperature);
    for _ in 0..ITERATIONS {
        let f = [state_at(rho, t).dp_drho, curvature(rho, t)];
        let (dr, dt) = (1e-4 * rho, 1e-4 * t);
        let slope = |g: &dyn Fn(f64, f64) -> f64| {
            [
                (g(rho + dr, t) - g(rho - dr, t)) / (2.0 * dr),
                (g(rho, t + dt) - g(rho, t - dt)) / (2.0 * dt),
            ]
        };
        let [a, b] = slope(&|rho, t| state_at(rho, t).dp_drho);
        let [c, d] = slope(&curvature);
        let determinant = a * d - b * c;
        let step_rho = (f[0] * d - b * f[1]) / determinant;
        let step_t = (a * f[1] - c * f[0]) / determinant;
        rho -= step_rho.clamp(-0.1 * rho, 0.1 * rho);
        t -= step_t.clamp(-0.05 * t, 0.05 * t);
        if (step_t / t).abs() < CONVERGED {
            return CriticalPoint { temperature: t, density: rho };
        }
    }
    start
}
