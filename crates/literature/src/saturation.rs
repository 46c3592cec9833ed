//! Vapor–liquid coexistence: equal pressure and equal chemical potential.

use serde::Serialize;

use crate::bisection::bisect;
use crate::fluid_state::{CriticalPoint, FluidState};

/// A vapor and a liquid at the same temperature, pressure and chemical potential.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Saturation {
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Vapor pressure, ε/σ³.
    pub pressure: f64,
    /// Density of the vapor, σ⁻³.
    pub vapor_density: f64,
    /// Density of the liquid, σ⁻³.
    pub liquid_density: f64,
}

type StateAt<'a> = &'a dyn Fn(f64, f64) -> FluidState;

/// Closest approach to the critical temperature, relative: nearer, the two densities merge and the
/// equations become singular.
const CLOSEST_TO_CRITICAL: f64 = 1e-4;
/// Below this fraction of T_c the liquid at zero pressure is a good first guess.
const COLD: f64 = 0.75;
/// Longest step upwards in temperature, in T_c, and largest fraction of the way that is left.
const LONGEST_STEP: f64 = 0.02;
const FRACTION_OF_REST: f64 = 0.5;
/// Relative change of the densities at which Newton's method has converged.
const CONVERGED: f64 = 1e-13;
const ITERATIONS: usize = 60;
/// A liquid denser than this, in ρ_c, is looked for no further.
const DENSEST_LIQUID: f64 = 3.4;

/// Solves for coexistence at `temperature`. It begins with the cold liquid at zero pressure and
/// goes up in steps that shorten towards the critical point. Newton's method solves each step.
pub(crate) fn solve(
    state_at: StateAt<'_>,
    critical: CriticalPoint,
    temperature: f64,
) -> Option<Saturation> {
    let t_c = critical.temperature;
    if !(temperature > 0.0 && temperature <= t_c * (1.0 - CLOSEST_TO_CRITICAL)) {
        return None;
    }
    let mut t = temperature.min(COLD * t_c);
    let liquid = liquid_at_zero_pressure(state_at, critical, t)?;
    let vapor = chemical_potential(&state_at(liquid, t)).exp();
    let mut found = newton(state_at, critical, t, liquid, vapor)?;
    while t < temperature {
        let step = (LONGEST_STEP * t_c).min(FRACTION_OF_REST * (t_c - t));
        let next = (t + step).min(temperature);
        // An analytic equation closes its dome as the square root of T_c − T.
        let shrink = ((t_c - next) / (t_c - t)).sqrt();
        let guess = |rho: f64| critical.density + (rho - critical.density) * shrink;
        found = newton(
            state_at,
            critical,
            next,
            guess(found.liquid_density),
            guess(found.vapor_density),
        )?;
        t = next;
    }
    Some(found)
}

/// ln ρ + α + ρ ∂α/∂ρ: the chemical potential over T up to a function of temperature.
fn chemical_potential(s: &FluidState) -> f64 {
    s.rho.ln() + s.residual_helmholtz + s.pressure / (s.rho * s.temperature) - 1.0
}

/// The largest density at which the pressure vanishes, by bisection from the dense side.
fn liquid_at_zero_pressure(
    state_at: StateAt<'_>,
    critical: CriticalPoint,
    temperature: f64,
) -> Option<f64> {
    let pressure = |rho: f64| state_at(rho, temperature).pressure;
    let step = 0.02 * critical.density;
    let mut above = DENSEST_LIQUID * critical.density;
    let mut below = above - step;
    while pressure(below) > 0.0 {
        above = below;
        below -= step;
        if below < critical.density {
            return None;
        }
    }
    if pressure(above) < 0.0 {
        return None;
    }
    let [above, below] = bisect(above, below, ITERATIONS, |rho| pressure(rho) > 0.0);
    Some(0.5 * (above + below))
}

/// Newton's method for equal pressure and chemical potential in (ρ_liquid, ln ρ_vapor). Its step is
/// halved until both densities stay on their own side of the critical density.
fn newton(
    state_at: StateAt<'_>,
    critical: CriticalPoint,
    t: f64,
    mut liquid: f64,
    mut vapor: f64,
) -> Option<Saturation> {
    for _ in 0..ITERATIONS {
        let l = state_at(liquid, t);
        let v = state_at(vapor, t);
        let pressure_gap = l.pressure - v.pressure;
        let potential_gap = chemical_potential(&l) - chemical_potential(&v);
        // Rows: (∂/∂ρ_l, ∂/∂ln ρ_v) of both gaps; dμ/dρ = (dp/dρ)/ρ.
        let (a, b) = (l.dp_drho, -vapor * v.dp_drho);
        let (c, d) = (l.dp_drho / (liquid * t), -v.dp_drho / t);
        let determinant = a * d - b * c;
        let liquid_step = -(pressure_gap * d - b * potential_gap) / determinant;
        let vapor_step = -(a * potential_gap - c * pressure_gap) / determinant;
        if !(liquid_step.is_finite() && vapor_step.is_finite()) {
            return None;
        }
        let mut scale = 1.0;
        let (mut next_liquid, mut next_vapor);
        loop {
            next_liquid = liquid + scale * liquid_step;
            next_vapor = vapor * (scale * vapor_step).exp();
            let apart = next_liquid > critical.density && next_vapor < critical.density;
            if apart && next_liquid < 2.0 * liquid {
                break;
            }
            scale *= 0.5;
            if scale < CONVERGED {
                return None;
            }
        }
        let change = (next_liquid / liquid - 1.0).abs().max((next_vapor / vapor - 1.0).abs());
        liquid = next_liquid;
        vapor = next_vapor;
        if change < CONVERGED {
            break;
        }
    }
    let l = state_at(liquid, t);
    let v = state_at(vapor, t);
    // Rounding in the liquid's pressure, a small difference of terms of order ten, allows no less.
    let agreed = (l.pressure - v.pressure).abs() < 1e-12
        && (chemical_potential(&l) - chemical_potential(&v)).abs() < 1e-12 / liquid.min(vapor);
    let stable = l.dp_drho > 0.0 && v.dp_drho > 0.0;
    (agreed && stable).then_some(Saturation {
        temperature: t,
        pressure: v.pressure,
        vapor_density: vapor,
        liquid_density: liquid,
    })
}

/// The largest density that is looked at, σ⁻³: beyond any fluid.
const DENSEST: f64 = 3.0;

/// The density of the stable fluid at a pressure, by bisection on the branch where p rises with ρ.
pub(crate) fn density_at(
    state_at: &dyn Fn(f64) -> FluidState,
    saturation: Option<Saturation>,
    pressure: f64,
    temperature: f64,
) -> Option<f64> {
    let is_above = |rho: f64| state_at(rho).pressure > pressure;
    let (mut below, mut above) = match saturation {
        Some(s) if pressure <= s.pressure => (0.0, s.vapor_density),
        Some(s) => (s.liquid_density, 1.02 * s.liquid_density),
        None => (0.0, 0.5 * (pressure / temperature).min(1.0)),
    };
    while !is_above(above) && above < DENSEST {
        if saturation.is_some_and(|s| above <= s.vapor_density) {
            break;
        }
        below = above;
        above = 1.02 * above + f64::MIN_POSITIVE;
    }
    let [above, below] = bisect(above, below, 2 * ITERATIONS, is_above);
    let density = 0.5 * (below + above);
    let reached = (state_at(density).pressure - pressure).abs() <= 1e-6 * pressure.abs().max(1e-6);
    (density > 0.0 && reached).then_some(density)
}
