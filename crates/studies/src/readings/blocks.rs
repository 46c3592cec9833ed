//! What a reading gives.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::report::{Picture, Section};
use lennard_observables::Table;

/// What answers the question of the study: its first figures.
pub(super) const PICTURES: &str = "Result";
/// All points together, judged.
pub(super) const TOGETHER: &str = "All points together";
/// The points one by one.
pub(super) const POINTS: &str = "Points";
/// Differences from the equation of state, and every equation beside the points.
pub(super) const EQUATIONS: &str = "Equations beside the points";
/// A figure for each property.
pub(super) const PROPERTIES: &str = "Each property";
/// The titles of sections that readings share, in the order of a page: the first two are open.
pub(crate) const SHARED_SECTIONS: [&str; 5] = [PICTURES, TOGETHER, POINTS, EQUATIONS, PROPERTIES];
/// How many of them a page shows open.
pub(crate) const OPEN: usize = 2;

/// What a reading makes of the points.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Blocks {
    /// A sentence for the head of the page.
    #[serde(skip)]
    pub lead: String,
    /// Sections of the page; sections of one title stand together.
    #[serde(skip)]
    pub sections: Vec<Section>,
    /// Tables that are files.
    #[serde(skip)]
    pub tables: Vec<Table>,
    /// Tables for the terminal.
    #[serde(skip)]
    pub terminal: Vec<Table>,
    /// Sentences for the terminal.
    #[serde(skip)]
    pub sentences: Vec<String>,
    /// Entries of the record, `sweep.json`, by name: `agreement`, `critical_point`, `melting`, …
    #[serde(flatten)]
    pub entries: BTreeMap<&'static str, Value>,
    /// Why the study fails, where its points are to prove something and do not.
    #[serde(skip)]
    pub failure: Option<String>,
}

impl Blocks {
    /// Figures that answer the question of the study.
    pub(super) fn of_figures(figures: impl IntoIterator<Item = Picture>) -> Self {
        let figures: Vec<Picture> = figures.into_iter().collect();
        let section = (!figures.is_empty()).then(|| Section::new(PICTURES).figures(figures));
        Self { sections: section.into_iter().collect(), ..Self::default() }
    }

    /// The same with an entry of the record.
    pub(super) fn with_entry(mut self, key: &'static str, value: &impl serde::Serialize) -> Self {
        // A number that is none becomes `null`, as in every record.
        self.entries.insert(key, serde_json::to_value(value).unwrap_or_default());
        self
    }

    /// Adds what the next reading makes of the points.
    pub(crate) fn take(&mut self, next: Self) {
        self.lead += &next.lead;
        self.sections.extend(next.sections);
        self.tables.extend(next.tables);
        // Later readings stand first on the terminal: the table of the points before sums over them.
        self.terminal.splice(0..0, next.terminal);
        self.sentences.extend(next.sentences);
        self.entries.extend(next.entries);
        self.failure = self.failure.take().or(next.failure);
    }
}
