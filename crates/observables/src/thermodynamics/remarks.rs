//! What belongs beside the thermodynamic averages.

use super::Thermodynamics;

impl Thermodynamics {
    /// What was assumed.
    pub(super) fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.options.configurational_temperature && self.force_jump != 0.0 {
            remarks.push(format!(
                "the configurational temperature counts the jump of the force at the cutoff with g(r_cut) = 1: {:.4} ε/σ² in the Laplacian of each particle",
                self.jump_laplacian(self.seen.volume())
            ));
        }
        remarks
    }
}
