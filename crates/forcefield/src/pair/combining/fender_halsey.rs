//! Fender–Halsey: the mean of lengths, the harmonic mean of depths.

use super::{CombiningRule, CombiningSpec, Deviation, Size};

lennard_core::options! {
    /// σ_ab = ½(σ_a + σ_b), ε_ab = 2ε_a·ε_b/(ε_a + ε_b).
    #[derive(Copy)]
    pub struct FenderHalsey {}
}

/// What it declares about itself.
pub const SPEC: CombiningSpec = CombiningSpec {
    name: "fender-halsey",
    title: "Fender–Halsey",
    summary: "Mean of the lengths, harmonic mean of the depths.",
    equation: "sigma_ab = (sigma_a + sigma_b)/2, epsilon_ab = 2 epsilon_a epsilon_b/(epsilon_a + epsilon_b)",
    source: "B. E. F. Fender and G. D. Halsey, J. Chem. Phys. 36 (1962) 1881",
};

impl CombiningRule for FenderHalsey {
    fn combine(&self, one: Size, other: Size, _: Deviation) -> Option<Size> {
        let sum = one.epsilon + other.epsilon;
        let epsilon = if sum == 0.0 { 0.0 } else { 2.0 * one.epsilon * other.epsilon / sum };
        Some(Size { sigma: 0.5 * (one.sigma + other.sigma), epsilon })
    }
}
