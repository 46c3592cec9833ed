//! How well a run kept what it ought to keep, and its means beside a line of an equation of state.

use crate::{Estimate, finite, statistics};
use serde::{Deserialize, Serialize};

use super::Thermodynamics;

/// How well energy and momentum were kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conservation {
    /// Slope of the conserved energy per particle, ε/τ, by least squares over all samples.
    #[serde(with = "finite")]
    pub energy_drift_per_atom_per_tau: f64,
    /// Its standard error, from the slopes of ten blocks.
    #[serde(with = "finite")]
    pub energy_drift_standard_error: f64,
    /// Root mean square of the conserved energy per particle about that line, over single samples.
    #[serde(with = "finite")]
    pub energy_rms_per_atom: f64,
    /// The largest |Σ m v|/N seen, in σ/τ, of the components that the forces keep.
    #[serde(with = "finite")]
    pub momentum_per_atom: f64,
}

impl Thermodynamics {
    /// Drift and fluctuation of the conserved energy, and the momentum.
    #[must_use]
    pub fn conservation(&self) -> Conservation {
        let rows = self.series.rows();
        Conservation {
            energy_drift_per_atom_per_tau: self.energy_line.slope(),
            energy_drift_standard_error: statistics::slope_error(
                &rows.time,
                &rows.conserved_energy,
            ),
            energy_rms_per_atom: self.energy_line.rms(),
            momentum_per_atom: self.largest_momentum,
        }
    }

    /// The mean potential energy per particle, with the error of its difference from an equation of state
    /// ([`statistics::about_line`]). `slope` is ∂u/∂T of the equation at the temperature of the
    /// positions.
    #[must_use]
    pub fn potential_energy_against(&self, slope: f64) -> Estimate {
        let rows = self.series.rows();
        self.against(&rows.potential_energy, slope)
    }

    /// The mean pressure, with the error of its difference from an equation of state whose slope ∂p/∂T at
    /// the temperature of the positions is given.
    #[must_use]
    pub fn pressure_against(&self, slope: f64) -> Estimate {
        self.against(&self.series.rows().pressure, slope)
    }

    fn against(&self, values: &[f64], slope: f64) -> Estimate {
        let temperature = &self.series.rows().temperature_of_positions;
        let found = statistics::about_line(values, temperature, slope, self.equilibration_cut());
        self.in_samples(found)
    }
}
