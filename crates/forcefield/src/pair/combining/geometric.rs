//! Geometric means, the rule of Good and Hope.

use super::{CombiningRule, CombiningSpec, Deviation, Size};

lennard_core::options! {
    /// σ_ab = √(σ_a·σ_b), ε_ab = √(ε_a·ε_b).
    #[derive(Copy)]
    pub struct Geometric {}
}

/// What it declares about itself.
pub const SPEC: CombiningSpec = CombiningSpec {
    name: "geometric",
    title: "geometric",
    summary: "Geometric means of lengths and depths.",
    equation: "sigma_ab = sqrt(sigma_a sigma_b), epsilon_ab = sqrt(epsilon_a epsilon_b)",
    source: "R. J. Good and C. J. Hope, J. Chem. Phys. 53 (1970) 540",
};

impl CombiningRule for Geometric {
    fn combine(&self, one: Size, other: Size, _: Deviation) -> Option<Size> {
        Some(Size {
            sigma: (one.sigma * other.sigma).sqrt(),
            epsilon: (one.epsilon * other.epsilon).sqrt(),
        })
    }
}
