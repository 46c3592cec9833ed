//! A scene written out again, with every default in its place.

use lennard_core::DVec3;
use lennard_forcefield::{
    CombiningOptions, KernelOptions, NeighborOptions, PotentialOptions, TruncationOptions,
};
use lennard_integrators::BondOptions;
use serde::Serialize;

use crate::tables::PLANAR;
use crate::tables::species::{PairKeys, SpeciesKeys};
use crate::tables::stages::StageKeys;
use crate::tables::start::{
    FileKeys, LatticeKeys, Numbers, PositionKeys, RandomKeys, Sides, StartKeys, SystemKeys,
};
use crate::tables::units::UnitKeys;
use crate::tables::walls::FieldKeys;
use crate::{
    Accuracy, Arrangement, Checkpoint, ContactTable, Geometry, IntegratorTable, MoleculeOptions,
    ObservableTable, Output, ProgramParts, Scene, System, WallTable,
};

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

#[derive(Serialize)]
struct Resolved<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<UnitKeys>,
    system: SystemKeys,
    start: StartKeys,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    species: Vec<SpeciesKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mixing: Option<&'a CombiningOptions>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pair: Vec<&'a PairKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    molecule: Option<&'a MoleculeOptions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bonds: Option<&'a BondOptions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<&'a Accuracy>,
    potential: &'a PotentialOptions,
    truncation: ResolvedTruncation<'a>,
    neighbor: &'a NeighborOptions,
    kernel: &'a KernelOptions,
    integrator: &'a IntegratorTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    field: Option<FieldKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a ContactTable>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    wall: &'a [WallTable],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stage: Vec<StageKeys>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    observable: &'a [ObservableTable],
    output: &'a Output,
    checkpoint: &'a Checkpoint,
    #[serde(skip_serializing_if = "ProgramParts::is_empty")]
    program: &'a ProgramParts,
}

impl Scene {
    /// The scene as TOML with every default written out, but not what an accuracy leaves to be chosen;
    /// reading it gives an equal scene.
    ///
    /// # Panics
    /// Where a number does not fit TOML, which no scene that was read from a file holds.
    #[must_use]
    pub fn resolved_toml(&self) -> String {
        let body = if self.free.is_empty() {
            toml::to_string(&self.resolved())
        } else {
            toml::to_string(&self.resolved_table())
        };
        let body = body.expect("every value of a scene fits TOML");
        format!("# The scene as it was run, with every default written out.\n\n{body}")
    }

    /// The scene as a table, without what an accuracy leaves to be chosen.
    ///
    /// # Panics
    /// As [`Scene::resolved_toml`].
    pub(crate) fn resolved_table(&self) -> toml::Table {
        let mut all =
            toml::Table::try_from(self.resolved()).expect("every value of a scene fits TOML");
        for free in &self.free {
            if let Some((table, key)) = free.split_once('.')
                && let Some(toml::Value::Table(table)) = all.get_mut(table)
            {
                table.remove(key);
            }
        }
        all
    }

    fn resolved(&self) -> Resolved<'_> {
        let mixture = self.mixture.as_ref();
        let species = mixture.map_or(&[][..], |mixture| &mixture.species);
        Resolved {
            name: &self.name,
            units: self
                .units
                .map(|units| UnitKeys { substance: Some(units.substance.name.to_owned()) }),
            system: self.into(),
            start: (&self.system.start).into(),
            species: species.iter().map(SpeciesKeys::from).collect(),
            mixing: mixture.and_then(|mixture| mixture.rule.as_ref()),
            pair: mixture.map_or(Vec::new(), |m| m.pairs.iter().map(|pair| &pair.keys).collect()),
            molecule: self.molecule.as_ref().map(|m| &m.options),
            bonds: self.molecule.as_ref().map(|m| &m.bonds),
            accuracy: self.accuracy.as_ref(),
            potential: &self.potential,
            truncation: ResolvedTruncation::of(self),
            neighbor: &self.neighbor,
            kernel: &self.kernel,
            integrator: &self.integrator,
            field: self.field_keys(),
            contact: self.contact.as_ref(),
            wall: &self.walls,
            stage: self.stages.iter().map(StageKeys::from).collect(),
            observable: &self.observables,
            output: &self.output,
            checkpoint: &self.checkpoint,
            program: &self.program,
        }
    }
}

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
        let (n, geometry) = match start {
            Arrangement::Lattice { n_atoms, geometry, .. } => (Some(*n_atoms), Some(*geometry)),
            Arrangement::Slab(slab) => (Some(slab.n_atoms), None),
            Arrangement::HalfCrystal(start) => (Some(start.n_atoms), None),
            Arrangement::Listed { sides, .. } => (None, Some(Geometry::Box(*sides))),
            Arrangement::File { geometry, .. } => (None, *geometry),
        };
        match &scene.molecule {
            None => keys.n_atoms = n,
            Some(_) => keys.n_molecules = n,
        }
        match geometry {
            Some(Geometry::Density(density)) => keys.density = Some(density),
            Some(Geometry::Box(sides)) => keys.sides = Some(Sides(sides)),
            None => {}
        }
        keys
    }
}

impl From<&Arrangement> for StartKeys {
    fn from(start: &Arrangement) -> Self {
        match start {
            Arrangement::Lattice { lattice: Some(lattice), vacuum, .. } => {
                Self::Lattice(LatticeKeys { lattice: *lattice, vacuum: *vacuum })
            }
            Arrangement::Lattice { lattice: None, vacuum, .. } => {
                Self::Random(RandomKeys { vacuum: *vacuum })
            }
            Arrangement::Slab(slab) => Self::Slab(slab.into()),
            Arrangement::HalfCrystal(start) => Self::HalfCrystal(start.into()),
            Arrangement::Listed { positions, velocities, .. } => {
                let in_rows = |all: &Vec<DVec3>| all.iter().map(DVec3::to_array).collect();
                Self::Positions(PositionKeys {
                    positions: Some(in_rows(positions)),
                    velocities: velocities.as_ref().map(in_rows),
                })
            }
            Arrangement::File { path, units, .. } => Self::File(FileKeys {
                file: Some(path.to_string_lossy().into_owned()),
                length_scale: units.length,
                time_scale: units.time,
            }),
        }
    }
}
