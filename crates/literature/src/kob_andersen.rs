//! Runs of others of the mixture of Kob and Andersen.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::tables::rows;

/// The mixture of Kob and Andersen: two species A and B, cut and shifted at 2.5 σ_ab. Lengths in σ_AA, energies in ε_AA.
///
/// W. Kob and H. C. Andersen, Phys. Rev. E 51, 4626 (1995).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KobAndersen;

impl KobAndersen {
    /// The cutoff of each pair, in σ_ab.
    pub const CUTOFF: f64 = 2.5;

    /// σ_ab and ε_ab of species a and b; 0 is A, 1 is B.
    #[must_use]
    pub fn pair(a: usize, b: usize) -> [f64; 2] {
        [[1.0, 1.0], [0.8, 1.5], [0.88, 0.5]][(a + b).min(2)]
    }
}

/// What was measured in a run of the mixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
pub enum KobAndersenQuantity {
    /// Potential energy per particle, ε.
    #[serde(rename = "U")]
    PotentialEnergy,
    /// A third of the virial per particle, ε: p = ρ(T + W).
    #[serde(rename = "W")]
    Virial,
    /// Pressure, ε/σ³.
    #[serde(rename = "p")]
    Pressure,
    /// N times the variance of U per particle at constant temperature, ε².
    #[serde(rename = "var(U)")]
    EnergyVariance,
    /// cov(U, W)/var(U), the density-scaling exponent.
    #[serde(rename = "gamma")]
    DensityScaling,
    /// The first peak of g_AA(r).
    #[serde(rename = "g_AA")]
    PeakAA,
    /// The first peak of g_AB(r).
    #[serde(rename = "g_AB")]
    PeakAB,
    /// The highest peak of g_BB(r), at 1.65 σ; a lower one stands before it at 0.9 σ.
    #[serde(rename = "g_BB")]
    PeakBB,
    /// Self-diffusion coefficient of A in the box of that run, σ²/τ.
    #[serde(rename = "D_A")]
    DiffusionA,
    /// Self-diffusion coefficient of B in the box of that run, σ²/τ.
    #[serde(rename = "D_B")]
    DiffusionB,
}

/// A row of the table `kob-andersen`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct KobAndersenRow {
    /// Temperature, ε/k_B.
    #[serde(rename = "T")]
    pub temperature: f64,
    /// Number density, σ⁻³.
    pub rho: f64,
    /// Mole fraction of A.
    #[serde(rename = "x_A")]
    pub fraction: f64,
    /// Particles of that run, where its source says so.
    #[serde(rename = "N")]
    pub particles: Option<u32>,
    /// What was measured.
    pub quantity: KobAndersenQuantity,
    /// Its value.
    pub value: f64,
    /// How far the value may be off.
    pub tolerance: f64,
    /// The source in short; the table names it in full.
    pub source: String,
}

/// Densities, in σ⁻³, and temperatures, in ε/k_B, that differ by less are one state.
const SAME_STATE: f64 = 1e-6;

/// Mole fractions that differ by less are one composition. 691 of 864 particles are not 80 per cent: the pressure of the dense
/// liquid differs by more than its error.
const SAME_COMPOSITION: f64 = 1e-4;

static TABLE: LazyLock<Vec<KobAndersenRow>> = LazyLock::new(|| rows("kob-andersen"));

/// What runs of others found at a density (σ⁻³), a temperature (ε/k_B) and a mole fraction of A: rows of the table `kob-andersen`.
/// Elsewhere there is no row, because nothing is taken between states.
#[must_use]
pub fn kob_andersen_at(
    density: f64,
    temperature: f64,
    fraction: f64,
) -> Vec<&'static KobAndersenRow> {
    let is_there = |row: &&KobAndersenRow| {
        (row.rho - density).abs() < SAME_STATE
            && (row.temperature - temperature).abs() < SAME_STATE
            && (row.fraction - fraction).abs() < SAME_COMPOSITION
    };
    TABLE.iter().filter(is_there).collect()
}

/// The states of the table in words, for a run of the mixture that is at none of them.
#[must_use]
pub fn kob_andersen_states() -> String {
    let mut states: Vec<String> = TABLE
        .iter()
        .filter(|row| row.fraction < 1.0)
        .map(|row| format!("(ρ {}, T {}, x_A {})", row.rho, row.temperature, row.fraction))
        .collect();
    states.dedup();
    states.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(rows: &[&KobAndersenRow], quantity: KobAndersenQuantity) -> Option<f64> {
        let row = rows.iter().find(|row| row.quantity == quantity)?;
        Some(row.value)
    }

    #[test]
    fn energy_virial_and_pressure_of_a_state_belong_together() {
        use KobAndersenQuantity::{DiffusionB, PotentialEnergy, Pressure, Virial};
        let rows = kob_andersen_at(1.2, 2.0, 0.8);
        assert_eq!(rows.len(), 9);
        let of = |quantity| found(&rows, quantity).unwrap();
        assert!((of(Pressure) - 1.2 * (2.0 + of(Virial))).abs() < 3e-4);
        assert_eq!((of(PotentialEnergy), of(DiffusionB)), (-4.653947433, 0.0717919));
        let melting = kob_andersen_at(1.2, 1.028, 0.8);
        assert_eq!(found(&melting, Virial), Some(7.444));
        assert_eq!(found(&melting, Pressure), None);
    }

    #[test]
    fn a_state_or_composition_beside_those_of_the_table_has_no_row() {
        assert!(kob_andersen_at(1.2, 2.001, 0.8).is_empty());
        assert!(kob_andersen_at(1.2001, 2.0, 0.8).is_empty());
        assert!(kob_andersen_at(1.2, 2.0, 691.0 / 864.0).is_empty());
        assert!(kob_andersen_states().starts_with("(ρ 1.2, T 2, x_A 0.8), (ρ 1.2, T 1.028,"));
    }
}
