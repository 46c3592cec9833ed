//! The equation of Kolafa and Nezbeda: hard spheres of a temperature-dependent diameter, the exact
//! second virial coefficient, and a polynomial.

use std::f64::consts::PI;

use serde::Deserialize;

use crate::equation::{EquationOfState, EquationSpec};
use crate::freezing::freezing_line;
use crate::jet::Jet;

/// Σ c_i T^{i/2} + c_ln ln T.
#[derive(Debug, Clone, Deserialize)]
struct HalfPowers {
    powers: Vec<i32>,
    coefficients: Vec<f64>,
    #[serde(default)]
    ln: f64,
}

impl HalfPowers {
    fn at(&self, temperature: Jet) -> Jet {
        let root = temperature.sqrt();
        let mut sum = temperature.ln() * self.ln;
        for (power, c) in self.powers.iter().zip(&self.coefficients) {
            sum += root.powi(*power) * *c;
        }
        sum
    }
}

/// Σ C_ij T^{i/2 − 1} ρʲ.
#[derive(Debug, Clone, Deserialize)]
struct DoubleSeries {
    t_power: Vec<i32>,
    rho_power: Vec<i32>,
    coefficients: Vec<f64>,
}

/// The equation of state
///
/// a_res/T = a_HS(η) + ρ ΔB₂(T) exp(−γρ²) + Σ C_ij T^{i/2 − 1} ρʲ, η = (π/6) ρ d(T)³,
///
/// with a_HS = (5/3) ln(1 − η) + η(34 − 33η + 4η²)/(6(1 − η)²) (J. Kolafa, I. Nezbeda, The
/// Lennard-Jones fluid: an accurate analytic and theoretically-based equation of state, Fluid Phase
/// Equilibria 100, 1, 1994, Eqs. 5 and 30).
#[derive(Debug, Clone, Deserialize)]
pub struct KolafaNezbeda {
    #[serde(flatten)]
    spec: EquationSpec,
    gamma: f64,
    diameter: HalfPowers,
    second_virial: HalfPowers,
    c: DoubleSeries,
}

impl EquationOfState for KolafaNezbeda {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let temperature = beta.powi(-1);
        let eta = rho * self.diameter.at(temperature).powi(3) * (PI / 6.0);
        let free = Jet::constant(1.0) - eta;
        let numerator = eta * (Jet::constant(34.0) - eta * 33.0 + eta.powi(2) * 4.0);
        let hard_spheres = free.ln() * (5.0 / 3.0) + numerator / (free.powi(2) * 6.0);
        let virial = rho * self.second_virial.at(temperature) * (rho.powi(2) * -self.gamma).exp();
        let mut sum = hard_spheres + virial;
        let root = temperature.sqrt();
        let c = &self.c;
        for ((i, j), value) in c.t_power.iter().zip(&c.rho_power).zip(&c.coefficients) {
            sum += root.powi(i - 2) * rho.powi(*j) * *value;
        }
        sum
    }

    fn freezing_density(&self, temperature: f64) -> Option<f64> {
        freezing_line().freezing_density(temperature)
    }
}
