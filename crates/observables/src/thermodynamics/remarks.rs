//! What belongs beside the thermodynamic averages.

use super::Thermodynamics;
use crate::statistics;

/// Fewer independent samples than this make an error bar uncertain by more than 16 % (1/√(2·20)).
const FEW_INDEPENDENT: f64 = 20.0;

impl Thermodynamics {
    /// Where an error is less sure than it looks, and what was assumed.
    pub(super) fn remarks(&self, cut: usize) -> Vec<String> {
        let rows = self.series.rows();
        let mut remarks = Vec::new();
        for (name, column) in [
            ("potential energy", &rows.potential_energy_without_tail),
            ("pressure", &rows.pressure_without_tail),
        ] {
            let found = statistics::autocorrelation_time(&column[cut..]);
            let independent = statistics::estimate_after(column, cut).n_effective;
            if !found.decayed {
                remarks.push(format!(
                    "the correlation of the {name} does not decay within the run: its error is a lower bound"
                ));
            } else if independent < FEW_INDEPENDENT {
                remarks.push(format!(
                    "only {independent:.0} independent samples of the {name}: its error is itself uncertain"
                ));
            }
        }
        if self.options.configurational_temperature && self.force_jump != 0.0 {
            remarks.push(format!(
                "the configurational temperature counts the jump of the force at the cutoff with g(r_cut) = 1: {:.4} ε/σ² in the Laplacian of each particle",
                self.jump_laplacian()
            ));
        }
        remarks
    }
}
