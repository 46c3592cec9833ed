//! The equation of Johnson, Zollweg and Gubbins: a modified Benedict–Webb–Rubin equation.

use serde::Deserialize;

use crate::equation::{EquationOfState, EquationSpec};
use crate::freezing::freezing_line;
use crate::jet::Jet;

/// A sum of coefficients times powers of the temperature, as pairs of exponent and coefficient.
type PowersOfT = Vec<(f64, f64)>;

fn sum(powers: &PowersOfT, temperature: Jet) -> Jet {
    let terms = powers.iter().map(|(exponent, c)| match exponent {
        0.0 => Jet::constant(*c),
        _ => temperature.powf(*exponent) * *c,
    });
    terms.fold(Jet::constant(0.0), |sum, term| sum + term)
}

/// The equation of state
///
/// a_res = Σ_{i=1}^{8} a_i(T) ρⁱ/i + Σ_{i=1}^{6} b_i(T) G_i(ρ),
///
/// G₁ = (1 − F)/(2γ), G_i = −(F ρ^{2(i−1)} − 2(i − 1) G_{i−1})/(2γ), F = exp(−γρ²), γ = 3
/// (J. K. Johnson, J. A. Zollweg, K. E. Gubbins, The Lennard-Jones equation of state revisited, Mol. Phys. 78, 591, 1993,
/// Tables 5 to 7).
#[derive(Debug, Clone, Deserialize)]
pub struct Johnson {
    #[serde(flatten)]
    spec: EquationSpec,
    gamma: f64,
    a: Vec<PowersOfT>,
    b: Vec<PowersOfT>,
}

impl EquationOfState for Johnson {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let temperature = beta.powi(-1);
        let mut energy = Jet::constant(0.0);
        for (order, a) in (1..).zip(&self.a) {
            energy += sum(a, temperature) * rho.powi(order) * (1.0 / f64::from(order));
        }
        let falling = (rho.powi(2) * -self.gamma).exp();
        let scale = 0.5 / self.gamma;
        let mut g = (Jet::constant(1.0) - falling) * scale;
        for (order, b) in (0..).zip(&self.b) {
            if order > 0 {
                g = (g * f64::from(2 * order) - falling * rho.powi(2 * order)) * scale;
            }
            energy += sum(b, temperature) * g;
        }
        energy * beta
    }

    fn freezing_density(&self, temperature: f64) -> Option<f64> {
        freezing_line().freezing_density(temperature)
    }
}
