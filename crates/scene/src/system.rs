//! The table `[system]`: where the particles start.

use std::path::Path;

use lennard_core::DVec3;
use lennard_core::options::OptionValue;
use lennard_io::FileUnits;
use lennard_literature::ModelKind;
use serde::{Deserialize, Deserializer, Serialize};
use toml::Value;

use crate::document::in_short;
use crate::error::SceneError;
use crate::read::{Reader, Resolve};
use crate::reference::{
    self, COLDEST, DENSEST, HOTTEST, LONGEST_SIDE, MOST_ATOMS, THINNEST, as_toml,
};
use crate::{Geometry, Lattice, Scene, Start, System};

lennard_core::options! {
    /// The keys of `[system]`.
    pub(crate) struct SystemKeys {
        /// Arrangement at the start. In a cube, fcc takes 4m³ particles, bcc 2m³, sc m³; in another box, 4abc, 2abc or abc with nearly cubic cells (edges within 10 % of each other). `random` takes any number, relaxed until nothing overlaps.
        lattice: Option<Lattice> = None, else "`\"fcc\"`", Names(Lattice::names);
        /// Number of particles.
        n_atoms: Option<usize> = None, else "needed", Whole(1, MOST_ATOMS);
        /// Number of molecules, in place of `n_atoms`: their centres stand on the lattice, their axes along its body diagonals.
        n_molecules: Option<usize> = None, else "needed with `[molecule]`", Whole(1, MOST_ATOMS);
        /// Number density of the start; the box is a cube.
        density: Option<f64> = None, else "this or `box`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Box sides. With a `configuration`, the box of a file that names none.
        sides as "box": Option<Sides> = None, else "this or `density`", Words("one side, or three sides [Lx, Ly, Lz], each a finite number above 0"), in "σ";
        /// Empty length added to the box along z, with the particles in the middle: a slab between two surfaces. `density` and `box` then describe the filled part.
        vacuum: Option<f64> = None, else "`0.0`", Between(0.0, LONGEST_SIDE), in "σ";
        /// Start from these positions, in the `box`. Takes the place of `lattice`, `n_atoms` and `density`. With molecules, the sites of each follow each other. Along an axis with walls they count from the lower wall.
        positions: Option<Vec<[f64; 3]>> = None, else "none", Words("a list with one position [x, y, z] for each particle"), in "σ";
        /// Velocities of the `positions`. Their total momentum is kept.
        velocities: Option<Vec<[f64; 3]>> = None, else "velocities of `temperature`", Words("a list with one velocity [vx, vy, vz] for each of `positions`"), in "σ/τ";
        /// Particles that never move: their mass is infinite.
        held: Option<Numbers> = None, else "none", Words("a list of numbers of particles, from 1, each once, and not all of them");
        /// Start from this file (extended XYZ, LAMMPS dump or data, GRO, NIST columns; each may be compressed by gzip), relative to the scene file. Takes the place of `lattice`, `n_atoms` and `density`.
        configuration: Option<String> = None, else "none", Words("the path of a file that can be read");
        /// One σ in the unit of length of the `configuration` file, where that is not σ: 0.3405 for argon in nm, 3.405 in ångström.
        length_scale: Option<f64> = None, else "the file holds reduced units", Between(1e-12, 1e12), in "file units per σ";
        /// One τ in the unit of time of the `configuration` file, for its velocities: 2.156 for argon in ps.
        time_scale: Option<f64> = None, else "needed with `length_scale`, where the file has velocities", Between(1e-12, 1e12), in "file units per τ";
        /// Temperature of the first velocities (where neither scene nor file gives them) and of every thermostat that names no other.
        temperature: Option<f64> = None, else "needed; `0.0` with `positions`", ZeroOrBetween(COLDEST, HOTTEST), in "ε/k_B";
        /// Seed of every random stream.
        seed: u64 = 1, Whole(0, i64::MAX);
    }
}

/// Numbers of particles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Numbers(Vec<u64>);

/// The table with every default in its place.
impl From<&Scene> for SystemKeys {
    fn from(scene: &Scene) -> Self {
        let System { start, temperature, seed, held } = &scene.system;
        let held: Vec<u64> = held.iter().map(|i| *i as u64 + 1).collect();
        let mut keys = Self {
            temperature: Some(*temperature),
            seed: *seed,
            held: (!held.is_empty()).then_some(Numbers(held)),
            ..Self::default()
        };
        let mut place = |geometry: &Geometry| match geometry {
            Geometry::Density(density) => keys.density = Some(*density),
            Geometry::Box(sides) => keys.sides = Some(Sides(*sides)),
        };
        match start {
            Start::Lattice { lattice, n_atoms, geometry, vacuum } => {
                place(geometry);
                keys.lattice = Some(*lattice);
                match &scene.molecule {
                    None => keys.n_atoms = Some(*n_atoms),
                    Some(_) => keys.n_molecules = Some(*n_atoms),
                }
                keys.vacuum = Some(*vacuum);
            }
            Start::Slab(slab) => keys.n_atoms = Some(slab.n_atoms),
            Start::HalfCrystal(start) => keys.n_atoms = Some(start.n_atoms),
            Start::Listed { sides, positions, velocities } => {
                let in_rows = |all: &Vec<DVec3>| all.iter().map(DVec3::to_array).collect();
                place(&Geometry::Box(*sides));
                keys.positions = Some(in_rows(positions));
                keys.velocities = velocities.as_ref().map(in_rows);
            }
            Start::Configuration { path, geometry, units } => {
                (keys.length_scale, keys.time_scale) = (units.length, units.time);
                if let Some(geometry) = geometry {
                    place(geometry);
                }
                keys.configuration = Some(path.to_string_lossy().into_owned());
            }
        }
        keys
    }
}

/// One side of a cube, or three sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct Sides([f64; 3]);

macro_rules! written_as_toml {
    ($($value:ident)*) => {$(
        impl OptionValue for $value {
            fn written(&self) -> String {
                as_toml(self)
            }
        }
    )*};
}

written_as_toml! { Sides Numbers }

impl<'de> Deserialize<'de> for Sides {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Sides;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("one side, or three sides [Lx, Ly, Lz]")
            }

            fn visit_f64<E>(self, side: f64) -> Result<Sides, E> {
                Ok(Sides([side; 3]))
            }

            fn visit_i64<E>(self, side: i64) -> Result<Sides, E> {
                Ok(Sides([side as f64; 3]))
            }

            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut seq: A,
            ) -> Result<Sides, A::Error> {
                let mut sides = [0.0; 3];
                for (i, side) in sides.iter_mut().enumerate() {
                    *side = seq
                        .next_element()?
                        .ok_or_else(|| serde::de::Error::invalid_length(i, &self))?;
                }
                match seq.next_element::<serde::de::IgnoredAny>()? {
                    None => Ok(Sides(sides)),
                    Some(_) => Err(serde::de::Error::invalid_length(sides.len() + 1, &self)),
                }
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl Reader<'_> {
    /// The table; `counted` is the number of particles that the species have together, where they are counted, and `model`
    /// the model of atoms of one species.
    pub fn system(
        &self,
        resolve: Resolve<'_>,
        counted: Option<usize>,
        model: Option<ModelKind>,
    ) -> Result<System, SceneError> {
        let written = self.table("system");
        if let Some(sides) = written.get("box") {
            self.refuse_triclinic(sides)?;
        }
        let table: SystemKeys = self.section("system").read(written)?;
        let geometry = match (table.density, table.sides) {
            (Some(_), Some(_)) => {
                return Err(self
                    .source
                    .refuse("system.box", "and `density` are both given")
                    .found("both")
                    .allowed("one of them (and `vacuum` for empty space beside the particles)"));
            }
            (Some(density), None) => Some(Geometry::Density(density)),
            (None, Some(Sides(sides))) => Some(Geometry::Box(sides)),
            (None, None) => None,
        };
        const OF_LATTICES: [&str; 5] = ["lattice", "n_atoms", "n_molecules", "density", "vacuum"];
        let excludes = |own: &str, keys: &[&str], allowed: &str| {
            let mut given = keys.iter().filter_map(|key| Some((key, written.get(*key)?)));
            let Some((key, value)) = given.next() else {
                return Ok(());
            };
            Err(self
                .source
                .refuse(&format!("system.{key}"), format!("does not go with `{own}`"))
                .found(in_short(value))
                .allowed(allowed))
        };
        if table.velocities.is_some() && table.positions.is_none() {
            return Err(self
                .source
                .refuse("system.velocities", "has no positions beside it")
                .found("`velocities` alone")
                .allowed("`positions` with one position for each velocity"));
        }
        let units = FileUnits { length: table.length_scale, time: table.time_scale };
        let alone = match units {
            _ if table.configuration.is_some() => units.time.filter(|_| units.length.is_none()),
            units => units.length.or(units.time),
        };
        if let Some(found) = alone {
            let key = if units.length.is_some() { "length_scale" } else { "time_scale" };
            return Err(self
                .source
                .refuse(&format!("system.{key}"), "is of a file in other units")
                .found(found)
                .allowed("`configuration` with the file, and `length_scale` beside it"));
        }
        let is_listed = table.positions.is_some();
        let phases = ["slab", "crystal"];
        let both = phases.iter().filter(|t| self.source.wrote(t));
        let side_by_side: Vec<&&str> = both.collect();
        if let [_, other, ..] = side_by_side[..] {
            return Err(self
                .source
                .refuse(other, "does not go with `[slab]`")
                .found("both")
                .allowed("`[slab]` for liquid and vapor, `[crystal]` for crystal and liquid"));
        }
        let side_by_side = side_by_side.first().map(|table| **table);
        if let Some(phases) = side_by_side
            && (is_listed || table.configuration.is_some())
        {
            let (own, says) = match is_listed {
                true => ("positions", "positions say"),
                false => ("configuration", "configuration file says"),
            };
            return Err(self
                .source
                .refuse(phases, format!("does not go with `{own}`"))
                .found(format!("`[{phases}]` and `{own}`"))
                .allowed(format!("one of them: the {says} where the particles are")));
        }
        let start = match (&table.configuration, &table.positions) {
            (None, Some(positions)) => {
                excludes("positions", &OF_LATTICES, "nothing: the positions say it")?;
                self.listed(positions, table.velocities.as_deref(), geometry)?
            }
            (Some(path), _) => {
                excludes(
                    "configuration",
                    &[&OF_LATTICES[..], &["positions"]].concat(),
                    "no such key: the configuration file has it",
                )?;
                let path = resolve(self.source, "system.configuration", Path::new(path))?;
                Start::Configuration { path, geometry, units }
            }
            (None, None) if let Some(phases) = side_by_side => {
                let of_table = format!("[{phases}]");
                excludes(
                    &of_table,
                    &["lattice", "density", "box", "vacuum"],
                    &format!(
                        "nothing: the box follows from `n_atoms` and the keys of `{of_table}`"
                    ),
                )?;
                let temperature = table.temperature.ok_or_else(|| self.needed("temperature"))?;
                let n_atoms = self.count(table.n_atoms.or(counted), table.n_molecules)?;
                match phases {
                    "slab" => Start::Slab(self.slab(n_atoms, temperature, model)?),
                    _ => Start::HalfCrystal(self.half_crystal(n_atoms, temperature, model)?),
                }
            }
            (None, None) => Start::Lattice {
                lattice: table.lattice.unwrap_or_default(),
                n_atoms: self.count(table.n_atoms.or(counted), table.n_molecules)?,
                geometry: geometry.ok_or_else(|| self.needed("density"))?,
                vacuum: table.vacuum.unwrap_or(0.0),
            },
        };
        Ok(System {
            start,
            temperature: match table.temperature {
                // Bodies that are listed are at rest unless the scene says otherwise.
                None if is_listed => 0.0,
                temperature => temperature.ok_or_else(|| self.needed("temperature"))?,
            },
            seed: table.seed,
            held: match &table.held {
                Some(Numbers(numbers)) => self.held(numbers)?,
                None => Vec::new(),
            },
        })
    }

    /// The number of particles, or of molecules where the scene has some.
    fn count(&self, atoms: Option<usize>, molecules: Option<usize>) -> Result<usize, SceneError> {
        let bonded = self.source.wrote("molecule");
        let (own, other) = match bonded {
            true => ("n_molecules", ("n_atoms", atoms)),
            false => ("n_atoms", ("n_molecules", molecules)),
        };
        if let (key, Some(found)) = other {
            let message = match bonded {
                true => "does not go with `[molecule]`",
                false => "has no `[molecule]` beside it",
            };
            return Err(self
                .source
                .refuse(&format!("system.{key}"), message)
                .found(found)
                .allowed(format!("`{own}`")));
        }
        let count = if bonded { molecules } else { atoms };
        count.ok_or_else(|| self.needed(own))
    }

    fn needed(&self, key: &str) -> SceneError {
        let allowed = reference::find("system", None, key).map(|doc| doc.allowed.text());
        let or = match key {
            "density" => ", or `box` with three sides",
            "n_atoms" | "n_molecules" => ", or `positions`, or `configuration` with a file",
            _ => "",
        };
        self.source
            .refuse(&format!("system.{key}"), "is missing")
            .found("nothing")
            .allowed(format!("{}{or}", allowed.unwrap_or_default()))
    }

    fn refuse_triclinic(&self, sides: &Value) -> Result<(), SceneError> {
        /// Numbers of a box with tilt factors, and of three cell vectors.
        const TRICLINIC: [usize; 2] = [6, 9];
        let Value::Array(items) = sides else {
            return Ok(());
        };
        if TRICLINIC.contains(&items.len()) || items.iter().any(Value::is_array) {
            return Err(self
                .source
                .refuse("system.box", "cannot be used: triclinic boxes are not available yet")
                .found(in_short(sides))
                .allowed("one side, or three sides [Lx, Ly, Lz], of a box with right angles"));
        }
        let is_side = |item: &Value| match item {
            Value::Float(x) => x.is_finite() && *x > 0.0,
            Value::Integer(x) => *x > 0,
            _ => false,
        };
        match items.iter().all(is_side) {
            true => Ok(()),
            false => Err(self.section("system").not_allowed("box", sides)),
        }
    }
}
