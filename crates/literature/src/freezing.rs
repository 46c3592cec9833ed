//! The freezing and melting line of the full Lennard-Jones potential.

use std::sync::LazyLock;

use serde::Deserialize;

/// Densities at which the liquid freezes and the crystal melts,
/// ρ = β^{−1/4} Σ c_k βᵏ with β = 1/T (E. A. Mastny, J. J. de Pablo, Melting line of the
/// Lennard-Jones system, infinite size, and full potential, J. Chem. Phys. 127, 104504, 2007,
/// Eqs. 20 and 21).
#[derive(Debug, Clone, Deserialize)]
pub struct FreezingLine {
    /// Where it comes from.
    pub citation: String,
    /// Its DOI.
    pub doi: String,
    /// How the coefficients were obtained.
    pub status: String,
    /// Temperature of the triple point in ε/k_B, below which the line has no meaning.
    pub t_triple: f64,
    /// How the triple temperature was obtained.
    pub t_triple_status: String,
    solid: Vec<f64>,
    liquid: Vec<f64>,
}

impl FreezingLine {
    /// The density in σ⁻³ above which the liquid at `temperature` (ε/k_B) is only metastable;
    /// `None` below the triple point.
    #[must_use]
    pub fn freezing_density(&self, temperature: f64) -> Option<f64> {
        self.on_line(&self.liquid, temperature)
    }

    /// The density in σ⁻³ below which the crystal at `temperature` (ε/k_B) begins to melt;
    /// `None` below the triple point.
    #[must_use]
    pub fn melting_density(&self, temperature: f64) -> Option<f64> {
        self.on_line(&self.solid, temperature)
    }

    fn on_line(&self, coefficients: &[f64], temperature: f64) -> Option<f64> {
        if temperature.is_nan() || temperature < self.t_triple {
            return None;
        }
        let beta = 1.0 / temperature;
        let series = coefficients.iter().rev().fold(0.0, |sum, c| sum * beta + c);
        Some(series * beta.powf(-0.25))
    }
}

static LINE: LazyLock<FreezingLine> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/freezing-mastny-de-pablo-2007.json"))
        .expect("the shipped freezing line is well formed: a test reads it")
});

/// The freezing line of the full Lennard-Jones potential.
#[must_use]
pub fn freezing_line() -> &'static FreezingLine {
    &LINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freezing_and_melting_densities_are_the_tabulated_ones() {
        // Evaluated independently from the same coefficients, five digits.
        for (t, freeze, melt) in [
            (0.7, 0.84750, 0.96151),
            (1.0, 0.91857, 1.00628),
            (2.74, 1.13886, 1.20239),
        ] {
            let line = freezing_line();
            assert!((line.freezing_density(t).unwrap() - freeze).abs() < 5e-6);
            assert!((line.melting_density(t).unwrap() - melt).abs() < 5e-6);
        }
    }

    #[test]
    fn there_is_no_freezing_liquid_below_the_triple_point() {
        assert_eq!(freezing_line().freezing_density(0.6), None);
        assert_eq!(freezing_line().freezing_density(f64::NAN), None);
    }
}
