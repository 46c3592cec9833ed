//! One state of a fluid, and its critical point.

use serde::{Deserialize, Serialize};

/// A critical point in reduced units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CriticalPoint {
    /// T_c in ε/k_B.
    pub temperature: f64,
    /// ρ_c in σ⁻³.
    pub density: f64,
}

/// Everything an equation of state says about one state; per particle, in reduced units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FluidState {
    /// Number density ρ, σ⁻³.
    pub rho: f64,
    /// Temperature T, ε/k_B.
    pub temperature: f64,
    /// Residual Helmholtz energy a_res over T: what the interaction adds to the ideal gas at the
    /// same ρ and T.
    pub residual_helmholtz: f64,
    /// Pressure p = ρT(1 + ρ ∂α/∂ρ), ε/σ³, with α = a_res/T.
    pub pressure: f64,
    /// Potential energy u = ∂α/∂β, ε, with β = 1/T.
    pub potential_energy: f64,
    /// Isochoric heat capacity c_v = 3/2 − β² ∂²α/∂β², k_B.
    pub heat_capacity_volume: f64,
    /// Isobaric heat capacity c_p = c_v + T(∂p/∂T)²/(ρ² ∂p/∂ρ), k_B; negative or infinite inside
    /// the spinodal.
    pub heat_capacity_pressure: f64,
    /// Speed of sound w = √(∂p/∂ρ + T(∂p/∂T)²/(ρ² c_v)), σ/τ; not a number where that is negative.
    pub speed_of_sound: f64,
    /// ∂u/∂T at constant density, the residual part of c_v, k_B.
    pub du_dt: f64,
    /// ∂p/∂T at constant density, k_B/σ³.
    pub dp_dt: f64,
    /// ∂u/∂ρ at constant temperature, εσ³.
    pub du_drho: f64,
    /// ∂p/∂ρ at constant temperature, ε.
    pub dp_drho: f64,
}
