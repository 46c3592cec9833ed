//! The exchange of a stage: how it is read, and what it needs.

use lennard_core::options::Options;
use lennard_integrators::{ExchangeOptions, Exchanged};
use toml::Value;

use crate::error::SceneError;
use crate::integrator::kinds_that;
use crate::read::Reader;
use crate::section::Section;
use crate::{Scene, Stage};

impl Reader<'_> {
    /// The exchange of a stage: "none", a name, or a table.
    pub fn exchange(
        &self,
        stage: &str,
        written: &Value,
    ) -> Result<Option<ExchangeOptions>, SceneError> {
        let path = format!("{stage}.exchange");
        let section = Section::new(self.source, &path, "stage.exchange");
        let Some(named) = self.part(stage, "exchange", &Exchanged::names(), written)? else {
            return Ok(None);
        };
        let options: ExchangeOptions = section.read(&named)?;
        options.check().map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        if !options.slabs.is_multiple_of(2) {
            return Err(section.impossible("slabs", &options.slabs.to_string(), "an even number"));
        }
        Ok(Some(options))
    }
}

/// Whether each exchange is in a homogeneous fluid of equal atoms at constant energy.
pub(crate) fn exchanges_fit(scene: &Scene) -> Result<(), SceneError> {
    for (i, stage) in scene.stages.iter().enumerate() {
        if stage.exchange.is_some() {
            fits(scene, stage, &format!("stage.{i}.exchange"))?;
        }
    }
    Ok(())
}

fn fits(scene: &Scene, stage: &Stage, key: &str) -> Result<(), SceneError> {
    let refuse = |message: &str, found: String, allowed: String| {
        Err(scene.source.refuse(key, message).found(found).allowed(allowed))
    };
    if let Some(bath) = &stage.thermostat {
        // A barostat stands beside a thermostat.
        return refuse(
            "is at constant energy",
            format!("an exchange with thermostat {:?}", bath.name()),
            "a stage without thermostat; a stage before it may have one".into(),
        );
    }
    if scene.molecule.is_some() {
        return refuse(
            "is for atoms alone",
            "an exchange and `[molecule]`".into(),
            "a scene of atoms".into(),
        );
    }
    let species = scene.mixture.as_ref().map_or(1, |m| m.species.len());
    if species > 1 {
        return refuse(
            "is between particles of one species",
            format!("an exchange with {species} species"),
            "a scene of one species".into(),
        );
    }
    if let Some(confined) = scene.confined_by() {
        return refuse(
            "needs a periodic fluid",
            format!("an exchange with {confined}"),
            "a scene without walls and field".into(),
        );
    }
    let method = lennard_integrators::build(&scene.integrator.method);
    if !method.spec().is_kick_drift_kick {
        return refuse(
            "needs a method that starts each step from the velocities",
            format!("an exchange with integrator {:?}", method.spec().name),
            kinds_that(|e| e.spec.is_kick_drift_kick),
        );
    }
    Ok(())
}
