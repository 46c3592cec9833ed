//! Coexistence of vapor and liquid by simulations of others.

use serde::Deserialize;

use crate::saturation::Saturation;
use crate::tables::rows;

/// The columns that are read of the table `coexistence`.
#[derive(Debug, Deserialize)]
struct Row {
    #[serde(rename = "T")]
    temperature: f64,
    rho_vap: f64,
    rho_liq: f64,
    psat: f64,
}

/// Vapor and liquid of the full potential in equilibrium, by transition-matrix Monte Carlo (NIST): the rows of the table
/// `coexistence`.
#[must_use]
pub fn coexistence_by_simulation() -> Vec<Saturation> {
    let saturation = |row: Row| Saturation {
        temperature: row.temperature,
        pressure: row.psat,
        vapor_density: row.rho_vap,
        liquid_density: row.rho_liq,
    };
    rows("coexistence").into_iter().map(saturation).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_and_lies_near_the_equation() {
        let rows = coexistence_by_simulation();
        assert!(rows.len() > 200);
        // Every tenth is enough: neighbors differ by their noise alone.
        for row in rows.iter().step_by(10) {
            let equation = crate::thol_2016().saturation(row.temperature).unwrap();
            assert!((row.liquid_density - equation.liquid_density).abs() < 0.0025);
            assert!((row.vapor_density / equation.vapor_density - 1.0).abs() < 0.025);
            assert!((row.pressure / equation.pressure - 1.0).abs() < 0.025);
        }
    }
}
