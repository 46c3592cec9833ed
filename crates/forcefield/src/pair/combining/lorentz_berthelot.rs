//! Lorentz–Berthelot: the mean of lengths, the geometric mean of depths.

use super::{CombiningRule, CombiningSpec, Deviation, Size};

lennard_core::options! {
    /// σ_ab = ½(σ_a + σ_b)·(1 − l), ε_ab = √(ε_a·ε_b)·(1 − k).
    #[derive(Copy)]
    pub struct LorentzBerthelot {
        /// Deviation of ε of every unlike pair: ε_ab = √(ε_a·ε_b)·(1 − k).
        k: f64 = 0.0, Between(-1.0, 1.0);
        /// Deviation of σ of every unlike pair: σ_ab = ½(σ_a + σ_b)·(1 − l).
        l: f64 = 0.0, Between(-0.5, 0.5);
    }
}

/// What it declares about itself.
pub const SPEC: CombiningSpec = CombiningSpec {
    name: "lorentz-berthelot",
    title: "Lorentz–Berthelot",
    summary: "Mean of the lengths, geometric mean of the depths.",
    equation: "sigma_ab = (sigma_a + sigma_b)/2 (1 - l), epsilon_ab = sqrt(epsilon_a epsilon_b) (1 - k)",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 1.3",
};

impl CombiningRule for LorentzBerthelot {
    fn deviates(&self) -> bool {
        true
    }

    fn combine(&self, one: Size, other: Size, deviation: Deviation) -> Option<Size> {
        let (k, l) = (deviation.k.unwrap_or(self.k), deviation.l.unwrap_or(self.l));
        Some(Size {
            sigma: 0.5 * (one.sigma + other.sigma) * (1.0 - l),
            epsilon: (one.epsilon * other.epsilon).sqrt() * (1.0 - k),
        })
    }
}
