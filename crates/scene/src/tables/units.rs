//! The keys of `[units]`.

use lennard_literature::units::SUBSTANCES;

lennard_core::options! {
    /// The keys of `[units]`.
    pub(crate) struct UnitKeys {
        /// The substance: `lennard list substances` has its σ, ε and m with their source.
        substance: Option<String> = None, else "needed", Names(substances);
    }
}

/// The names of all substances.
pub(crate) fn substances() -> Vec<&'static str> {
    SUBSTANCES.iter().map(|substance| substance.name).collect()
}
