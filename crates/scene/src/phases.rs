//! What starts with two phases have in common: densities that are not written, and the box.

use lennard_core::number::short;
use lennard_core::{DVec3, PeriodicBox};

use crate::Scene;
use crate::error::SceneError;

/// A density that a table does not write.
pub(crate) struct MissingDensity {
    /// The key of the first that is missing.
    pub key: String,
    /// The keys that are missing, in words.
    pub allowed: String,
}

impl MissingDensity {
    /// What is missing of the two densities of a table, where one is at least.
    pub(crate) fn of(table: &str, keys: [&str; 2], written: [Option<f64>; 2]) -> Self {
        let all = keys.into_iter().zip(written);
        let missing: Vec<&str> =
            all.filter(|(_, written)| written.is_none()).map(|(key, _)| key).collect();
        let words: Vec<String> = missing.iter().map(|key| format!("`{key}`")).collect();
        Self {
            key: format!("{table}.{}", missing.first().unwrap_or(&keys[0])),
            allowed: format!("{} in [{table}]", words.join(" and ")),
        }
    }
}

impl Scene {
    /// The box of a start with two phases, refused under the name of its table.
    pub(crate) fn box_of_phases(
        &self,
        table: &str,
        sides: DVec3,
    ) -> Result<PeriodicBox, SceneError> {
        PeriodicBox::new(sides).map_err(|_| {
            self.source
                .refuse(table, "makes an impossible box")
                .found(format!("sides of {} and {} σ", short(sides.x), short(sides.z)))
                .allowed("finite sides above 0")
        })
    }
}
