//! Waldman–Hagler: means of sixth powers.

use super::{CombiningRule, CombiningSpec, Deviation, Size};

lennard_core::options! {
    /// σ_ab⁶ = ½(σ_a⁶ + σ_b⁶), ε_ab = √(ε_a·ε_b)·2σ_a³σ_b³/(σ_a⁶ + σ_b⁶).
    #[derive(Copy)]
    pub struct WaldmanHagler {}
}

/// What it declares about itself.
pub const SPEC: CombiningSpec = CombiningSpec {
    name: "waldman-hagler",
    title: "Waldman–Hagler",
    summary: "Means of sixth powers, so that the attraction is the geometric mean.",
    equation: "sigma_ab^6 = (sigma_a^6 + sigma_b^6)/2, epsilon_ab = sqrt(epsilon_a epsilon_b) 2 sigma_a^3 sigma_b^3/(sigma_a^6 + sigma_b^6)",
    source: "M. Waldman and A. T. Hagler, J. Comput. Chem. 14 (1993) 1077",
};

impl CombiningRule for WaldmanHagler {
    fn combine(&self, one: Size, other: Size, _: Deviation) -> Option<Size> {
        let cubes = one.sigma.powi(3) * other.sigma.powi(3);
        let sixths = one.sigma.powi(6) + other.sigma.powi(6);
        Some(Size {
            sigma: (0.5 * sixths).powf(1.0 / 6.0),
            epsilon: (one.epsilon * other.epsilon).sqrt() * 2.0 * cubes / sixths,
        })
    }
}
