//! How well a run kept what it ought to keep.

use crate::{finite, statistics};
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
}
