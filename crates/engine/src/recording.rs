//! What runs in memory keep, and what was measured.

use std::time::Duration;

use lennard_core::{DVec3, Table};
use lennard_io::{AverageRecord, RunRecord};
use lennard_scene::{RemovedKind, removed};

use crate::error::EngineError;

/// A state of the trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptFrame {
    /// Step.
    pub step: u64,
    /// Time, τ.
    pub time: f64,
    /// Box sides, σ.
    pub lengths: DVec3,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ; empty where `output.velocities` is off.
    pub velocities: Vec<DVec3>,
    /// Forces, `[N]`, ε/σ; empty where `output.forces` is off.
    pub forces: Vec<DVec3>,
}

/// What runs in memory have kept so far; a run that goes on adds to it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// The rows that a run with files writes to `thermo.csv`, column by column.
    pub thermo: Vec<Vec<f64>>,
    /// The frames that it writes to its trajectory.
    pub frames: Vec<KeptFrame>,
    /// Wall time.
    pub wall: Duration,
}

/// Means with their errors, and tables.
#[derive(Debug, Clone)]
pub struct Results {
    /// All of it but the tables, as `run.json` of a run with files has it. It holds the scene, the averages, the comparison with
    /// the literature, how well the energy was conserved, and remarks.
    pub record: RunRecord,
    /// The tables of the observables, such as `rdf`.
    pub tables: Vec<Table>,
}

impl Results {
    /// A mean by its name, such as `pressure`. Its standard error contains the correlation in time; where a mean is no result,
    /// the error is NaN and `reason` says why.
    ///
    /// # Errors
    /// [`EngineError::NoSuchResult`] with the names that there are.
    pub fn average(&self, name: &str) -> Result<&AverageRecord, EngineError> {
        let averages = &self.record.averages;
        let known = || averages.keys().map(String::as_str);
        averages.get(name).ok_or_else(|| missing("average", name, known()))
    }

    /// A table by its name, such as `rdf`; [`Table::numbers`] gives a column.
    ///
    /// # Errors
    /// [`EngineError::NoSuchResult`] with the names that there are.
    pub fn table(&self, name: &str) -> Result<&Table, EngineError> {
        let known = || self.tables.iter().map(|t| t.name.as_str());
        let found = self.tables.iter().find(|t| t.name == name);
        found.ok_or_else(|| missing("table", name, known()))
    }
}

fn missing<'a>(
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> EngineError {
    let known: Vec<&str> = known.collect();
    let (nearest, known) = match removed(RemovedKind::Column, name) {
        Some(instead) => (None, instead.to_owned()),
        None => (lennard_scene::nearest(name, known.iter().copied()), known.join(", ")),
    };
    EngineError::NoSuchResult { kind, name: name.to_owned(), known, nearest }
}
