//! The list of barostats, and everything that is made from it.

use lennard_core::BarostatSpec;

use super::parts::BarostatParts;
use super::{mtk, stochastic_cell_rescaling};

list_of_methods! {
    /// A barostat by name, with its options: the `barostat` of a stage without its `pressure`.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    pub enum BarostatOptions: BarostatParts, declared by SPEC: BarostatSpec {
        /// Stochastic cell rescaling of Bernetti and Bussi, accepted by Metropolis.
        StochasticCellRescaling: stochastic_cell_rescaling,
        /// The barostat of Martyna, Tobias and Klein, in place of the scene's integrator.
        Mtk: mtk,
    }
}

/// Every barostat, in the order of `lennard list`.
#[must_use]
pub fn barostats() -> &'static [BarostatSpec] {
    BarostatOptions::SPECS
}
