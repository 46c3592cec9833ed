//! What a simulation has measured.

use lennard_core::Table;
use lennard_io::{AverageRecord, RunRecord};

use crate::{Error, Result};

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
    /// [`Error::NoSuchResult`] with the names that there are.
    pub fn average(&self, name: &str) -> Result<&AverageRecord> {
        let averages = &self.record.averages;
        let known = || averages.keys().map(String::as_str);
        averages.get(name).ok_or_else(|| missing("average", name, known()))
    }

    /// A table by its name, such as `rdf`; [`Table::numbers`] gives a column.
    ///
    /// # Errors
    /// [`Error::NoSuchResult`] with the names that there are.
    pub fn table(&self, name: &str) -> Result<&Table> {
        let known = || self.tables.iter().map(|t| t.name.as_str());
        let found = self.tables.iter().find(|t| t.name == name);
        found.ok_or_else(|| missing("table", name, known()))
    }
}

fn missing<'a>(kind: &'static str, name: &str, known: impl Iterator<Item = &'a str>) -> Error {
    let known: Vec<&str> = known.collect();
    Error::NoSuchResult {
        kind,
        name: name.to_owned(),
        nearest: lennard_scene::nearest(name, known.iter().copied()),
        known: known.join(", "),
    }
}
