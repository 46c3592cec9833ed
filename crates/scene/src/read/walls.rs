//! Reads the tables `[[wall]]`, `[field]` and `[contact]`.

use lennard_core::DVec3;
use toml::Value;

use crate::read::Reader;
use crate::section::Section;
use crate::tables::walls::{ContactKeys, FieldKeys, WallKeys};
use crate::{ContactTable, SceneError, WallTable};

impl Reader<'_> {
    /// The contacts; `None` where the scene has no such table.
    pub fn contact(&self) -> Result<Option<ContactTable>, SceneError> {
        if !self.source.wrote("contact") {
            return Ok(None);
        }
        let section = self.section("contact");
        let mut table = self.table("contact").clone();
        let ContactKeys { diameter } = section.shared(&mut table)?;
        let options = section.method(&table)?;
        Ok(Some(ContactTable { diameter, options }))
    }
}

/// What the walls take of the box along their axis beyond the cutoff, σ, where the scene does not say.
const DEFAULT_ROOM: f64 = 1.0;

impl Reader<'_> {
    /// The walls, for forces that end at `r_cut`.
    pub fn walls(&self, r_cut: f64) -> Result<Vec<WallTable>, SceneError> {
        let mut walls: Vec<WallTable> = Vec::new();
        for (i, table) in self.list("wall")?.into_iter().enumerate() {
            let path = format!("wall.{i}");
            let section = Section::new(self.source, &path, "wall");
            let mut table = table.clone();
            let WallKeys { axis, thickness } = section.shared(&mut table)?;
            let options = section.method(&table)?;
            if let Some(first) = walls.iter().position(|other| other.axis == axis) {
                let first = format!("wall.{first}.axis");
                let twice = self.source.twice(&section.name("axis"), axis.name(), &first);
                return Err(twice);
            }
            walls.push(WallTable {
                axis,
                thickness: thickness.unwrap_or(r_cut + DEFAULT_ROOM),
                options,
            });
        }
        Ok(walls)
    }

    /// The acceleration of the constant field, σ/τ²; zero without one.
    pub fn field(&self) -> Result<DVec3, SceneError> {
        let section = self.section("field");
        let table = self.table("field");
        let is_vector = |value: &Value| {
            let vector: Result<[f64; 3], _> = value.clone().try_into();
            vector.is_ok_and(|g| g.iter().all(|x| x.is_finite()))
        };
        // A number alone is refused as a vector, whatever its sign.
        if let Some(written) = table.get("acceleration").filter(|value| !is_vector(value)) {
            return Err(section.not_allowed("acceleration", written));
        }
        let keys: FieldKeys = section.read(table)?;
        Ok(DVec3::from_slice(&keys.acceleration))
    }
}
