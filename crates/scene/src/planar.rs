//! `truncation.tail_correction = "planar"`: whether a scene can have it.

use lennard_forcefield::{PotentialOptions, TruncationKind, TruncationOptions};
use lennard_observables::ObservableOptions;
use serde::Serialize;

use crate::error::SceneError;
use crate::{Scene, Start};

/// The key.
pub(crate) const KEY: &str = "truncation.tail_correction";
/// What is written for a planar tail.
pub(crate) const PLANAR: &str = "planar";
/// The attraction of a Mie potential must fall at least as fast as r⁻⁶.
const SLOWEST: u32 = 6;

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

/// Whether a planar tail goes with the rest of the scene.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    if !scene.planar_tail {
        return Ok(());
    }
    let refuse = |message: &str, found: String, allowed: &str| {
        Err(scene.source.refuse(KEY, message).found(found).allowed(allowed))
    };
    let kind = scene.truncation.kind;
    if kind != TruncationKind::Cut {
        return refuse(
            "goes with the plain cutoff alone",
            format!("\"{PLANAR}\" with kind \"{}\"", kind.spec().name),
            "kind \"cut\", or no tail correction",
        );
    }
    let falls = match scene.potential {
        PotentialOptions::LennardJones(_) => true,
        PotentialOptions::Mie(mie) => mie.attractive >= SLOWEST,
        _ => false,
    };
    if !falls {
        return refuse(
            "is not derived for this potential",
            format!("\"{PLANAR}\" with {}", scene.potential.spec().title),
            "Lennard-Jones, or Mie with an attraction of r⁻⁶ or steeper",
        );
    }
    let others = [
        (scene.molecule.is_some(), "molecules"),
        (scene.mixture.is_some(), "several species"),
        (scene.accuracy.is_some(), "`[accuracy]`"),
        (scene.contact.is_some(), "contacts"),
    ];
    let with = others.into_iter().find(|(there, _)| *there);
    let with = with.map(|(_, with)| with.to_owned());
    if let Some(with) = with.or(scene.confined_by()) {
        return refuse(
            "is not derived for this fluid",
            format!("\"{PLANAR}\" with {with}"),
            "atoms of one species in a periodic box",
        );
    }
    if scene.stages.iter().any(|stage| stage.barostat.is_some()) {
        return refuse(
            "needs a box that does not change",
            format!("\"{PLANAR}\" with a barostat"),
            "constant volume",
        );
    }
    let heat = |o: &ObservableOptions| o.name() == "thermal-conductivity";
    if scene.observables.iter().any(|table| heat(&table.options)) {
        return refuse(
            "gives no energy of single particles",
            format!("\"{PLANAR}\" with observable \"thermal-conductivity\""),
            "other observables",
        );
    }
    if matches!(scene.system.start, Start::Lattice { .. }) && scene.surfaces().is_none() {
        return refuse(
            "needs flat surfaces across z",
            format!("\"{PLANAR}\" and a start that fills its box"),
            "true in a homogeneous fluid, or a start with `[slab]`, `system.vacuum` or `configuration`",
        );
    }
    Ok(())
}
