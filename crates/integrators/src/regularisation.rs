//! Compliance and damping of a constraint as SPOOK uses them.

/// What compliance and damping become for a step h: Σ = (4/h²)·ε/(1 + 4τ/h) and γ = 1/(1 + 4τ/h).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// Σ, in units of an inverse mass.
    pub sigma: f64,
    /// γ, between 0 and 1.
    pub gamma: f64,
}

impl Regularisation {
    /// For compliance ε, damping time τ and step h.
    #[must_use]
    pub fn new(compliance: f64, damping_time: f64, dt: f64) -> Self {
        let gamma = 1.0 / (1.0 + 4.0 * damping_time / dt);
        Self {
            sigma: 4.0 / (dt * dt) * compliance * gamma,
            gamma,
        }
    }
}
