//! What a tail correction adds to a compressibility that comes from the structure.

use lennard_core::Findings;

use crate::Simulation;

/// Compressibilities from g(r) and from S(k) have names that begin so.
const FROM_STRUCTURE: &str = "compressibility_kirkwood_buff";

impl Simulation {
    /// Says what compressibilities from the structure are with the tail.
    ///
    /// A tail correction moves no particle, so that the structure is of the fluid without it. Pressure and response functions have the tail:
    /// with P_tail = c·ρ², 1/κ_T = ρ·∂P/∂ρ has 2·P_tail more.
    pub(crate) fn tell_tail_of_structure(&self, findings: &mut [Findings]) {
        let Some(tail) = self.tail_in(self.state.cell.volume()) else {
            return;
        };
        for of_one in findings {
            let from_structure = of_one.averages.iter().filter(|average| {
                average.name.starts_with(FROM_STRUCTURE) && average.estimate.mean > 0.0
            });
            let words: Vec<String> = from_structure
                .map(|average| {
                    let kappa = average.estimate.mean;
                    let with_tail = kappa / (1.0 + 2.0 * tail.pressure * kappa);
                    format!("{} {with_tail:.4} σ³/ε", average.name)
                })
                .collect();
            if words.is_empty() || tail.pressure == 0.0 {
                continue;
            }
            of_one.remark(format!(
                "the structure is of the fluid without its tail, which adds 2·P_tail = {:.4} ε/σ³ to 1/κ_T; with the tail: {}",
                2.0 * tail.pressure,
                words.join(", ")
            ));
        }
    }
}
