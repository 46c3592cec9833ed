//! The table `[system]`: where the particles start.

use std::path::PathBuf;

use lennard_literature::ModelKind;
use serde::{Deserialize, Deserializer};

use crate::error::SceneError;
use crate::read::{Reader, Resolve};
use crate::reference;
use crate::tree::{Node, Value};
use crate::{Geometry, Lattice, Start, System};

const DEFAULT_SEED: u64 = 1;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SystemTable {
    lattice: Option<Lattice>,
    n_atoms: Option<usize>,
    n_molecules: Option<usize>,
    density: Option<f64>,
    #[serde(rename = "box")]
    sides: Option<Sides>,
    vacuum: Option<f64>,
    positions: Option<Vec<[f64; 3]>>,
    velocities: Option<Vec<[f64; 3]>>,
    #[serde(default)]
    held: Vec<u64>,
    configuration: Option<PathBuf>,
    temperature: Option<f64>,
    seed: Option<u64>,
}

/// One side of a cube, or three sides.
struct Sides([f64; 3]);

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
        let node = self.node("system");
        if let Some(sides) = node.table().and_then(|table| table.get("box")) {
            self.refuse_triclinic(sides)?;
        }
        let table: SystemTable = self.section("system").read(node)?;
        let given = |key: &str| node.table().is_some_and(|table| table.get(key).is_some());
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
            let Some(key) = keys.iter().find(|key| given(key)) else {
                return Ok(());
            };
            Err(self
                .source
                .refuse(
                    &format!("system.{key}"),
                    format!("does not go with `{own}`"),
                )
                .found(node.table().and_then(|t| t.get(key)).unwrap_or(&self.empty))
                .allowed(allowed))
        };
        if table.velocities.is_some() && table.positions.is_none() {
            return Err(self
                .source
                .refuse("system.velocities", "has no positions beside it")
                .found("`velocities` alone")
                .allowed("`positions` with one position for each velocity"));
        }
        let is_listed = table.positions.is_some();
        if self.source.wrote("slab") && (is_listed || table.configuration.is_some()) {
            let (own, says) = match is_listed {
                true => ("positions", "positions say"),
                false => ("configuration", "configuration file says"),
            };
            return Err(self
                .source
                .refuse("slab", format!("does not go with `{own}`"))
                .found(format!("`[slab]` and `{own}`"))
                .allowed(format!("one of them: the {says} where the particles are")));
        }
        let start = match (table.configuration, &table.positions) {
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
                let path = resolve(self.source, "system.configuration", &path)?;
                Start::Configuration { path, geometry }
            }
            (None, None) if self.source.wrote("slab") => {
                excludes(
                    "[slab]",
                    &["lattice", "density", "box", "vacuum"],
                    "nothing: the box follows from `n_atoms` and the keys of `[slab]`",
                )?;
                let temperature = table
                    .temperature
                    .ok_or_else(|| self.needed("temperature"))?;
                let n_atoms = self.count(table.n_atoms.or(counted), table.n_molecules)?;
                Start::Slab(self.slab(n_atoms, temperature, model)?)
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
            seed: table.seed.unwrap_or(DEFAULT_SEED),
            held: self.held(&table.held)?,
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

    fn refuse_triclinic(&self, sides: &Node) -> Result<(), SceneError> {
        /// Numbers of a box with tilt factors, and of three cell vectors.
        const TRICLINIC: [usize; 2] = [6, 9];
        let triclinic = match &sides.value {
            Value::Array(items) => {
                TRICLINIC.contains(&items.len())
                    || items
                        .iter()
                        .any(|item| matches!(item.value, Value::Array(_)))
            }
            _ => false,
        };
        if triclinic {
            return Err(self
                .source
                .refuse(
                    "system.box",
                    "cannot be used: triclinic boxes are not available yet",
                )
                .found(sides)
                .allowed("one side, or three sides [Lx, Ly, Lz], of a box with right angles"));
        }
        if let Value::Array(items) = &sides.value {
            for item in items {
                let good = match item.value {
                    Value::Number(x) => x.is_finite() && x > 0.0,
                    Value::Whole(x) => x > 0,
                    _ => false,
                };
                if !good {
                    return Err(self.refuse_value("system", "box", "system.box", sides));
                }
            }
        }
        Ok(())
    }
}
