//! A scene written out again, with every default in its place.

use lennard_contacts::ContactOptions;
use lennard_forcefield::{
    CombiningOptions, KernelOptions, NeighborOptions, PotentialOptions, WallOptions,
};
use lennard_integrators::{BondOptions, IntegratorOptions};
use lennard_observables::ObservableOptions;
use serde::Serialize;

use crate::contact::ContactKeys;
use crate::half_crystal::CrystalKeys;
use crate::integrator::StepKeys;
use crate::methods::WithMethod;
use crate::mixture::{PairKeys, SpeciesKeys};
use crate::molecule::MoleculeOptions;
use crate::observable::ObservableKeys;
use crate::output::{CheckpointKeys, OutputKeys};
use crate::planar::ResolvedTruncation;
use crate::slab::SlabKeys;
use crate::stage::StageKeys;
use crate::system::SystemKeys;
use crate::walls::{FieldKeys, WallKeys};
use crate::{Accuracy, MixtureTables, ProgramParts, Scene};

#[derive(Serialize)]
struct Resolved<'a> {
    name: &'a str,
    system: SystemKeys,
    #[serde(skip_serializing_if = "Option::is_none")]
    slab: Option<SlabKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crystal: Option<CrystalKeys>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    species: Vec<SpeciesKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mixing: Option<&'a CombiningOptions>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pair: Vec<PairKeys>,
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
    integrator: WithMethod<'a, IntegratorOptions, StepKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    field: Option<FieldKeys>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<WithMethod<'a, ContactOptions, ContactKeys>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    wall: Vec<WithMethod<'a, WallOptions, WallKeys>>,
    stage: Vec<StageKeys>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    observable: Vec<WithMethod<'a, ObservableOptions, ObservableKeys>>,
    output: OutputKeys,
    checkpoint: CheckpointKeys,
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
            system: self.into(),
            slab: self.slab().map(SlabKeys::from),
            crystal: self.half_crystal().map(CrystalKeys::from),
            species: species.iter().map(SpeciesKeys::from).collect(),
            mixing: mixture.and_then(|mixture| mixture.rule.as_ref()),
            pair: mixture.map_or(Vec::new(), MixtureTables::pair_keys),
            molecule: self.molecule.as_ref().map(|m| &m.options),
            bonds: self.molecule.as_ref().map(|m| &m.bonds),
            accuracy: self.accuracy.as_ref(),
            potential: &self.potential,
            truncation: ResolvedTruncation::of(self),
            neighbor: &self.neighbor,
            kernel: &self.kernel,
            integrator: WithMethod {
                method: &self.integrator.method,
                shared: (&self.integrator).into(),
            },
            field: self.field_keys(),
            contact: self
                .contact
                .as_ref()
                .map(|table| WithMethod { method: &table.options, shared: table.into() }),
            wall: (self.walls.iter())
                .map(|table| WithMethod { method: &table.options, shared: table.into() })
                .collect(),
            stage: self.stages.iter().map(StageKeys::from).collect(),
            observable: (self.observables.iter())
                .map(|table| WithMethod { method: &table.options, shared: table.into() })
                .collect(),
            output: self.output_keys(),
            checkpoint: (&self.checkpoint).into(),
            program: &self.program,
        }
    }
}
