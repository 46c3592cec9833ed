//! `truncation.tail_correction = "planar"`: whether a scene can have it.

use lennard_forcefield::TruncationOptions;
use serde::Serialize;

use crate::Scene;
use crate::error::SceneError;

/// The key.
pub(crate) const KEY: &str = "truncation.tail_correction";
/// What is written for a planar tail.
pub(crate) const PLANAR: &str = "planar";

/// The truncation, with the word for a planar tail in the place of a flag.
#[derive(Serialize)]
#[serde(untagged)]
pub(crate) enum ResolvedTruncation<'a> {
    Plain(&'a TruncationOptions),
    Planar(toml::Table),
}

impl<'a> ResolvedTruncation<'a> {
    pub fn of(scene: &'a Scene) -> Self {
        let options = &scene.truncation;
        let table = scene.planar_tail.then(|| toml::Table::try_from(options).ok()).flatten();
        match table {
            Some(mut table) => {
                table.insert("tail_correction".into(), PLANAR.into());
                Self::Planar(table)
            }
            None => Self::Plain(options),
        }
    }
}

impl Scene {
    /// Refuses a planar tail for a study of homogeneous fluids.
    pub(crate) fn planar_tail_for(&self, study: &str) -> Result<(), SceneError> {
        if !self.planar_tail {
            return Ok(());
        }
        Err(self
            .source
            .refuse(KEY, format!("does not go with `{study}`"))
            .found(format!("\"{PLANAR}\""))
            .allowed("a homogeneous fluid, with true or false"))
    }
}
