//! Refusals of force fields, on the line that each is about.

use lennard_forcefield::ForceFieldError;

use crate::{Scene, SceneError};

impl Scene {
    /// A force field that does not fit, on the line that it is about. A cutoff that a table `[[pair]]` gives is on the line of that table.
    #[must_use]
    pub fn misfit(&self, error: &ForceFieldError) -> SceneError {
        let ForceFieldError::CutoffOverHalfBox { r_cut, .. } = error else {
            return self.misfit_of(&error.key(), error);
        };
        let mut pairs = self.mixture.iter().flat_map(|m| &m.pairs);
        let own = pairs.position(|pair| {
            let [a, b] = pair.species;
            pair.r_cut.is_some() && self.species_pair(a, b).r_cut == *r_cut
        });
        let key = own.map_or_else(|| error.key(), |pair| format!("pair.{pair}.r_cut"));
        self.misfit_of(&key, error)
    }

    fn misfit_of(&self, key: &str, error: &ForceFieldError) -> SceneError {
        let refused = self.source.refuse(key, error.problem());
        refused.found(error.found()).allowed(error.allowed())
    }
}
