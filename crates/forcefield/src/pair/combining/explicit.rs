//! No rule: the scene writes σ and ε of each unlike pair.

use super::{CombiningRule, CombiningSpec, Deviation, Size};

lennard_core::options! {
    /// σ_ab and ε_ab are written in a table `[[pair]]` for each pair of unlike species.
    #[derive(Copy)]
    pub struct Explicit {}
}

/// What it declares about itself.
pub const SPEC: CombiningSpec = CombiningSpec {
    name: "explicit",
    title: "explicit",
    summary: "A table [[pair]] for each pair of unlike species, with sigma and epsilon.",
    equation: "sigma_ab and epsilon_ab as written",
    source: "W. Kob and H. C. Andersen, Phys. Rev. E 51 (1995) 4626, for one such mixture",
};

impl CombiningRule for Explicit {
    fn combine(&self, _one: Size, _other: Size, _: Deviation) -> Option<Size> {
        None
    }
}
