//! The last build of a list.

use lennard_core::PeriodicBox;

/// The last build of a list.
#[derive(Debug, Clone)]
pub struct Build {
    /// The box of the build. The box of an evaluation may differ from it.
    pub cell: PeriodicBox,
    /// The skin of the build, σ.
    pub skin: f64,
    /// The list radius, σ: the cutoff, the skin, and the rounding of distances.
    pub r_list: f64,
}

impl Build {
    /// The distance, σ, within which no pair may be missing. The factor is a margin for rounding: no pair inside the cutoff
    /// may seem to lie outside.
    pub fn inner(&self) -> f64 {
        (self.r_list - self.skin) * (1.0 + 1e-12)
    }
}
