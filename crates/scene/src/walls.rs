//! The tables `[[wall]]` and `[field]`: what confines a fluid, and what must hold of it.

use lennard_core::random::Streams;
use lennard_core::{Axis, DVec3, Masses, PeriodicBox};
use lennard_forcefield::{
    ConstantField, SlitPlanes, Surface, WallContext, WallOptions, WallPair, Walls,
};
use toml::Value;

use crate::Scene;
use crate::error::SceneError;
use crate::read::Reader;
use crate::reference::LONGEST_SIDE;
use crate::section::Section;

/// What the walls take of the box along their axis beyond the cutoff, σ, where the scene does not say.
const DEFAULT_ROOM: f64 = 1.0;

/// A table `[[wall]]`: walls at both ends of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct WallTable {
    /// The axis of the normal.
    pub axis: Axis,
    /// Length of the box along the axis behind the planes, σ: the distance between the images of the fluid.
    pub thickness: f64,
    /// The walls with their own keys.
    pub options: WallOptions,
}

lennard_core::options! {
    /// The keys of `[[wall]]` that all kinds have.
    pub(crate) struct WallKeys {
        /// The axis across which the walls stand.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Length of the box behind the planes, which keeps the fluid out of reach of its images; at least `r_cut` + 0.1.
        thickness: Option<f64> = None, else "`r_cut` + 1.0", Between(1e-6, LONGEST_SIDE), in "σ";
    }
}

lennard_core::options! {
    /// The keys of `[field]`.
    pub(crate) struct FieldKeys {
        /// Acceleration of every particle.
        acceleration: Vec<f64> = vec![0.0; 3], Words("three finite numbers [gx, gy, gz]; 0 along an axis without walls"), in "σ/τ²";
    }
}

impl From<&WallTable> for WallKeys {
    fn from(table: &WallTable) -> Self {
        Self { axis: table.axis, thickness: Some(table.thickness) }
    }
}

impl Reader<'_> {
    /// The walls, for forces that end at `r_cut`.
    pub fn walls(&self, r_cut: f64) -> Result<Vec<WallTable>, SceneError> {
        let mut walls: Vec<WallTable> = Vec::new();
        for (i, table) in self.list("wall")?.into_iter().enumerate() {
            let path = format!("wall.{i}");
            let section = Section::new(self.source, &path, "wall");
            let mut table = table.clone();
            let WallKeys { axis, thickness } = section.take(&mut table)?;
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

impl Scene {
    /// The constant field as its table says it; `None` without one.
    pub(crate) fn field_keys(&self) -> Option<FieldKeys> {
        (self.acceleration != DVec3::ZERO)
            .then(|| FieldKeys { acceleration: self.acceleration.to_array().to_vec() })
    }

    /// Where pair forces and contacts end, σ: the longest cutoff of two species, or the largest contact distance.
    pub(crate) fn end_of_pairs(&self) -> f64 {
        self.longest_cutoff().max(self.largest_contact())
    }

    /// The walls of this scene in a box; `None` where it has none.
    #[must_use]
    pub fn walls_in(&self, cell: &PeriodicBox) -> Option<Walls> {
        let context = self.context_of_walls();
        let pairs = self
            .walls
            .iter()
            .map(|table| WallPair::new(&table.options, self.planes(table, cell), &context));
        let noise = Streams::new(self.system.seed).noise("walls");
        (!self.walls.is_empty()).then(|| Walls::new(pairs.collect(), noise))
    }

    fn context_of_walls(&self) -> WallContext {
        WallContext { temperature: self.system.temperature }
    }

    /// What the walls of a table do to a particle, at the lower end.
    pub(crate) fn surface(&self, table: &WallTable) -> Surface {
        table.options.surface(&self.context_of_walls(), false)
    }

    /// The planes of each pair of walls in a box.
    #[must_use]
    pub fn slits(&self, cell: &PeriodicBox) -> Vec<SlitPlanes> {
        let tables = self.walls.iter();
        tables.map(|table| self.planes(table, cell)).collect()
    }

    fn planes(&self, table: &WallTable, cell: &PeriodicBox) -> SlitPlanes {
        let r_cut = self.end_of_pairs();
        SlitPlanes::new(cell, table.axis.index(), table.thickness, r_cut)
    }

    /// The field of this scene for particles of these masses; `None` where it has none.
    #[must_use]
    pub fn field_on(&self, masses: &Masses) -> Option<ConstantField> {
        let g = self.acceleration;
        (g != DVec3::ZERO).then(|| ConstantField::new(g, masses.clone()))
    }

    /// What the walls add to the box and to the lower corner of the filled part, σ; a lattice stands clear of them.
    pub(crate) fn room_of_walls(&self, is_lattice: bool) -> (DVec3, DVec3) {
        let (mut sides, mut corner) = (DVec3::ZERO, DVec3::ZERO);
        for table in &self.walls {
            let axis = table.axis.index();
            let clearance = match is_lattice {
                true => self.surface(table).clearance(),
                false => 0.0,
            };
            sides[axis] += table.thickness + 2.0 * clearance;
            corner[axis] += 0.5 * table.thickness + clearance;
        }
        (sides, corner)
    }
}
