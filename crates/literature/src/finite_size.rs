//! What a closed box of N particles lacks of the fluctuations of an infinite system.

use crate::{EquationOfState, Phase};

/// By how much the means of N particles differ from the means of an infinite system, to first order in 1/N.
///
/// A box with periodic sides has no surface, but it is closed. With the grand-canonical weights e^{βμN}·Z_N, which are
/// a Gaussian of width ⟨δN²⟩ = N·S₀ about N, and whose sum is e^{βpV} of the infinite system,
///
/// F_N = F + ½T·ln(2πN·S₀), S₀ = T/(∂p/∂ρ) = S(k → 0),
///
/// and from its derivatives
///
/// - p_N = p + (Tρ²/2N)·∂ln S₀/∂ρ, which is −½⟨δN²⟩·∂²p/∂N²: below the infinite system where p is convex,
/// - u_N = u − (T²/2N)·∂ln S₀/∂T, above it wherever cooling makes the fluid more compressible, most near the critical
///   point.
///
/// At constant energy the temperature fluctuates too. Means of X at the mean temperature then differ from X(T̄) by
/// −½⟨δT²⟩·∂²X/∂T² with ⟨δT²⟩ = T²/(N·c_v), the same relation in the other pair of variables.
///
/// Errors: the next order is some S₀/N of these, a per cent in a liquid and a tenth near the critical point. S₀ is the equation's,
/// which has another critical point than the fluid: near it the term is no better than an order of magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiniteSize {
    /// Of the potential energy per particle, in ε.
    pub potential_energy: f64,
    /// Of the pressure, in ε/σ³.
    pub pressure: f64,
    /// Why a tolerance must hold the terms.
    pub doubt: Option<FiniteSizeDoubt>,
}

/// Why a finite-size term is no better than an order of magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FiniteSizeDoubt {
    /// S₀/N is not small: no reference should contain the term.
    NotSmall,
    /// The state is near the critical point of the equation.
    NearCritical,
}

/// What is kept in a closed box besides the number of particles and the volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// The temperature.
    Temperature,
    /// The energy.
    Energy,
}

/// The largest S₀/N at which the first order says anything.
const LARGEST_SHARE: f64 = 0.05;
/// How near the critical temperature of the equation a state is near its critical point, as a part of this temperature.
const NEAR_TEMPERATURE: f64 = 0.05;
/// The same for the density: up to so many times the critical one, or down to this part of it.
const NEAR_DENSITY: f64 = 2.0;

/// Relative steps of the derivatives: errors of 1e-7 of them.
const STEP: f64 = 1e-4;

impl FiniteSize {
    /// At a density (σ⁻³) and temperature (ε/k_B) for `n` particles; `None` where the fluid is not stable there.
    #[must_use]
    pub fn of(
        equation: &dyn EquationOfState,
        density: f64,
        temperature: f64,
        n: usize,
        kept: Kept,
    ) -> Option<Self> {
        let n = n as f64;
        let state = equation.at(density, temperature);
        let stiffness = state.dp_drho;
        // Inside the dome the equations have loops, where a slope may be positive by chance.
        let unstable = equation.phase(density, temperature) == Phase::InsideDome;
        if unstable || stiffness <= 0.0 {
            return None;
        }
        let critical = equation.spec().critical;
        let from_critical = (density / critical.density).ln().abs();
        let doubt = if temperature / stiffness > LARGEST_SHARE * n {
            Some(FiniteSizeDoubt::NotSmall)
        } else if (temperature / critical.temperature - 1.0).abs() < NEAR_TEMPERATURE
            && from_critical < NEAR_DENSITY.ln()
        {
            Some(FiniteSizeDoubt::NearCritical)
        } else {
            None
        };
        let (dr, dt) = (STEP * density, STEP * temperature);
        let at = |rho: f64, t: f64| equation.at(rho, t);
        let (thin, dense) = (at(density - dr, temperature), at(density + dr, temperature));
        let (cold, hot) = (at(density, temperature - dt), at(density, temperature + dt));
        // ln S₀ = ln T − ln ∂p/∂ρ.
        let by_density = -(dense.dp_drho - thin.dp_drho) / (2.0 * dr * stiffness);
        let by_temperature =
            1.0 / temperature - (hot.dp_drho - cold.dp_drho) / (2.0 * dt * stiffness);
        let mut shift = Self {
            potential_energy: -0.5 * temperature.powi(2) * by_temperature / n,
            pressure: 0.5 * temperature * density.powi(2) * by_density / n,
            doubt,
        };
        if kept == Kept::Energy {
            let half_variance = 0.5 * temperature.powi(2) / (n * state.heat_capacity_volume);
            shift.potential_energy -= half_variance * (hot.du_dt - cold.du_dt) / (2.0 * dt);
            shift.pressure -= half_variance * (hot.dp_dt - cold.dp_dt) / (2.0 * dt);
        }
        (shift.potential_energy.is_finite() && shift.pressure.is_finite()).then_some(shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thol_2016;

    /// The part of the free energy that a closed box has in excess, ½T·ln(S₀) + const, over N.
    fn excess(density: f64, temperature: f64, n: f64) -> f64 {
        let stiffness = thol_2016().at(density, temperature).dp_drho;
        0.5 * temperature * (temperature / stiffness).ln() / n
    }

    #[test]
    fn shifts_are_the_derivatives_of_the_free_energy_of_a_closed_box() {
        let n = 500.0;
        for (rho, t) in [(0.85, 1.22), (0.45, 1.5), (0.05, 1.5)] {
            let found = FiniteSize::of(thol_2016(), rho, t, 500, Kept::Temperature).unwrap();
            // p = ρ²·∂(F/N)/∂ρ and u = −T²·∂(F/NT)/∂T, with other steps than the code's.
            let h = 1e-3;
            let p = rho * rho * (excess(rho + h, t, n) - excess(rho - h, t, n)) / (2.0 * h);
            let over_t = |t: f64| excess(rho, t, n) / t;
            let u = -t * t * (over_t(t + h) - over_t(t - h)) / (2.0 * h);
            assert!((found.pressure - p).abs() < 1e-3 * p.abs(), "{found:?} {p}");
            assert!((found.potential_energy - u).abs() < 1e-3 * u.abs(), "{found:?} {u}");
        }
    }

    #[test]
    fn an_ideal_gas_has_no_shift_and_others_fall_as_one_over_n() {
        let at = |rho, n| FiniteSize::of(thol_2016(), rho, 2.0, n, Kept::Energy).unwrap();
        assert!(at(1e-6, 100).pressure.abs() < 1e-12);
        assert!(at(1e-6, 100).potential_energy.abs() < 1e-6);
        let (few, many) = (at(0.8, 200), at(0.8, 2000));
        assert!((few.pressure / many.pressure - 10.0).abs() < 1e-9);
        assert!((few.potential_energy / many.potential_energy - 10.0).abs() < 1e-9);
        // Convex in the dense liquid, so below.
        assert!(many.pressure < 0.0);
    }

    #[test]
    fn unstable_states_have_none_and_doubtful_terms_say_so() {
        let at = |rho, t, n| FiniteSize::of(thol_2016(), rho, t, n, Kept::Energy);
        assert_eq!(at(0.3, 0.9, 1000), None);
        for (rho, t, n, doubt) in [
            (0.31, 1.33, 20, Some(FiniteSizeDoubt::NotSmall)),
            (0.45, 1.33, 864, Some(FiniteSizeDoubt::NearCritical)),
            (0.45, 1.29, 864, Some(FiniteSizeDoubt::NearCritical)),
            (0.35, 1.41, 864, None),
            (0.7, 1.32, 864, None),
            (0.1, 3.0, 32, None),
        ] {
            assert_eq!(at(rho, t, n).unwrap().doubt, doubt, "{rho} {t} {n}");
        }
    }
}
