//! What takes the homogeneity of a fluid away.

use lennard_core::DVec3;

use crate::Scene;
use crate::error::SceneError;

impl Scene {
    /// What takes the fluid's homogeneity away, in words with the key of each.
    pub(crate) fn confining(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let all = [
            (!self.walls.is_empty(), "wall", "walls"),
            (
                self.acceleration != DVec3::ZERO || !self.program.fields.is_empty(),
                "field",
                "a field",
            ),
            (!self.system.held.is_empty(), "system.held", "held particles"),
        ];
        all.into_iter().filter_map(|(there, key, words)| there.then_some((key, words)))
    }

    /// What takes the fluid's homogeneity away, in words; `None` where it is periodic along all axes, in no field and free to move.
    #[must_use]
    pub fn confined_by(&self) -> Option<String> {
        let words: Vec<&str> = self.confining().map(|(_, words)| words).collect();
        match words.split_last()? {
            (last, []) => Some((*last).to_owned()),
            (last, others) => Some(format!("{} and {last}", others.join(", "))),
        }
    }

    /// Refuses molecules, contacts, and a fluid between walls or in a field, for a study of homogeneous fluids of atoms.
    ///
    /// # Errors
    /// [`SceneError`] with the table that confines the fluid.
    pub fn homogeneous_for(&self, study: &str) -> Result<(), SceneError> {
        self.planar_tail_for(study)?;
        let others = [
            (self.contact.is_some(), "contact", "contacts"),
            (self.molecule.is_some(), "molecule", "molecules"),
        ];
        let other = others.into_iter().find(|(there, ..)| *there);
        let (key, found) = match (self.confining().next(), self.confined_by(), other) {
            (Some((key, _)), Some(confined), _) => (key, confined),
            (_, _, Some((_, key, words))) => (key, words.to_owned()),
            _ => return Ok(()),
        };
        Err(self
            .source
            .refuse(key, format!("does not go with `{study}`"))
            .found(format!("a fluid with {found}"))
            .allowed("a scene of atoms, without walls and field"))
    }
}
