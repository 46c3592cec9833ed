//! The family of equations by Thol and co-workers: one formula, a set of coefficients for each model.

use serde::Deserialize;

use crate::equation::{EquationOfState, EquationSpec};
use crate::freezing::freezing_line;
use crate::jet::Jet;
use crate::terms::Terms;

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
    #[serde(flatten)]
    terms: Terms,
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
        self.terms.at(tau, delta)
    }

    fn freezing_density(&self, temperature: f64) -> Option<f64> {
        self.full_potential.then(|| freezing_line().freezing_density(temperature)).flatten()
    }
}
