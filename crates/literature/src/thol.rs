//! The family of equations by Thol and co-workers: one formula, a set of coefficients for each model.

use serde::Deserialize;

use crate::equation::{EquationOfState, EquationSpec};
use crate::freezing::freezing_line;
use crate::jet::Jet;

/// Polynomial terms n τᵗ δᵈ.
#[derive(Debug, Clone, Deserialize)]
struct Polynomial {
    n: Vec<f64>,
    t: Vec<f64>,
    d: Vec<i32>,
}

/// Terms n τᵗ δᵈ exp(−δˡ).
#[derive(Debug, Clone, Deserialize)]
struct Exponential {
    n: Vec<f64>,
    t: Vec<f64>,
    d: Vec<i32>,
    l: Vec<i32>,
}

/// Terms n τᵗ δᵈ exp(−η(δ − ε)² − β(τ − γ)²).
#[derive(Debug, Clone, Deserialize)]
struct Gaussian {
    n: Vec<f64>,
    t: Vec<f64>,
    d: Vec<i32>,
    eta: Vec<f64>,
    beta: Vec<f64>,
    gamma: Vec<f64>,
    epsilon: Vec<f64>,
}

/// An equation of state of the form
///
/// a_res/T = Σ n τᵗ δᵈ + Σ n τᵗ δᵈ exp(−δˡ) + Σ n τᵗ δᵈ exp(−η(δ − ε)² − β(τ − γ)²),
///
/// with τ = T_c/T and δ = ρ/ρ_c (M. Thol et al., Equation of State for the Lennard-Jones Fluid,
/// J. Phys. Chem. Ref. Data 45, 023101, 2016, Eq. 13 ff.).
#[derive(Debug, Clone, Deserialize)]
pub struct Thol {
    #[serde(flatten)]
    spec: EquationSpec,
    t_reducing: f64,
    rho_reducing: f64,
    poly: Polynomial,
    exp: Exponential,
    gauss: Gaussian,
    /// Whether the freezing line of the full potential is this model's.
    #[serde(default)]
    full_potential: bool,
}

impl EquationOfState for Thol {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let tau = beta * self.t_reducing;
        let delta = rho * (1.0 / self.rho_reducing);
        let term = |n: f64, t: f64, d: i32| tau.powf(t) * delta.powi(d) * n;
        let mut sum = Jet::constant(0.0);
        let p = &self.poly;
        for ((n, t), d) in p.n.iter().zip(&p.t).zip(&p.d) {
            sum += term(*n, *t, *d);
        }
        let e = &self.exp;
        for (((n, t), d), l) in e.n.iter().zip(&e.t).zip(&e.d).zip(&e.l) {
            sum += term(*n, *t, *d) * (-delta.powi(*l)).exp();
        }
        let g = &self.gauss;
        for i in 0..g.n.len() {
            let exponent = (delta - g.epsilon[i]).powi(2) * -g.eta[i]
                + (tau - g.gamma[i]).powi(2) * -g.beta[i];
            sum += term(g.n[i], g.t[i], g.d[i]) * exponent.exp();
        }
        sum
    }

    fn freezing_density(&self, temperature: f64) -> Option<f64> {
        self.full_potential
            .then(|| freezing_line().freezing_density(temperature))
            .flatten()
    }
}
