//! The scene reference: every table and key with what it may hold. Error messages, the range checks and
//! the tables of `inputs/README.md` are made from it.

mod tables;

use std::fmt::Write as _;
use std::sync::OnceLock;

pub use lennard_core::options::Allowed;
pub(crate) use lennard_core::options::{MOST_STEPS, quoted};
use serde::Serialize;
pub use tables::TableDoc;
pub(crate) use tables::{Form, Tag};

use crate::Name;

/// The most particles that a scene may ask for; their numbers must fit in 32 bits with room to spare.
pub(crate) const MOST_ATOMS: i64 = 1_000_000_000;
/// The longest box side in σ: beyond it, image flags and the last digits of positions get scarce.
pub(crate) const LONGEST_SIDE: f64 = 1e6;
/// The shortest length of a slab, σ: below it there is no liquid.
pub(crate) const SHORTEST_SIDE: f64 = 1.0;
/// The lowest and the highest temperature of a heat bath, ε/k_B: far outside, numbers overflow or vanish on the way.
pub(crate) const COLDEST: f64 = 1e-9;
pub(crate) const HOTTEST: f64 = 1e6;
/// The lowest and the highest number density, σ⁻³: one particle in the longest box, and far beyond any solid.
pub(crate) const THINNEST: f64 = 1e-18;
pub(crate) const DENSEST: f64 = 1e3;
/// The lowest and the highest pressure of a barostat, ε/σ³: far outside, numbers vanish or overflow on the way.
pub(crate) const LEAST_PRESSURE: f64 = 1e-12;
pub(crate) const LARGEST_PRESSURE: f64 = 1e6;
/// The shortest and the longest time step, τ: far below, the time of a run no longer moves.
pub(crate) const SHORTEST_STEP: f64 = 1e-9;
pub(crate) const LONGEST_STEP: f64 = 1e3;
/// The most stages, and the most observables.
pub(crate) const MOST_ENTRIES: usize = 1000;

/// One key of a scene file.
#[derive(Debug, Clone)]
pub struct KeyDoc {
    /// Its table: `system`, `stage`, `stage.thermostat`; empty for a key outside all tables.
    pub table: &'static str,
    /// The method that the key belongs to, where it belongs to one alone (`soft-sphere`).
    pub method: Option<&'static str>,
    /// The key.
    pub key: &'static str,
    /// What it may hold.
    pub allowed: Allowed,
    /// The value where it is not written, in words.
    pub default: String,
    /// Its unit, empty for a plain number or a name.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

lennard_core::options! {
    /// The keys outside all tables.
    pub(crate) struct TopKeys {
        /// Name of the scene; the output folder is called after it.
        name: Option<String> = None, else "the file's name without `.toml`", Words(Name::ALLOWED);
    }
}

/// A value as a scene file writes it.
pub(crate) fn as_toml(value: &impl Serialize) -> String {
    toml::Value::try_from(value).map_or_else(|error| error.to_string(), |value| value.to_string())
}

/// Every key of a scene file, table by table.
#[must_use]
pub fn keys() -> &'static [KeyDoc] {
    static ALL: OnceLock<Vec<KeyDoc>> = OnceLock::new();
    ALL.get_or_init(|| tables().iter().flat_map(TableDoc::keys).collect())
}

/// Every table of a scene file.
#[must_use]
pub fn tables() -> &'static [TableDoc] {
    tables::TABLES
}

/// What is known of a table: its name has no indices (`stage.thermostat`).
pub(crate) fn table(name: &str) -> Option<&'static TableDoc> {
    tables().iter().find(|doc| doc.table == name)
}

/// The keys of a table that holds for every method, and the keys of one method.
pub(crate) fn keys_of(table: &str, method: Option<&str>) -> impl Iterator<Item = &'static KeyDoc> {
    let of_method = move |doc: &KeyDoc| doc.method.is_none() || doc.method == method;
    keys().iter().filter(move |doc| doc.table == table && of_method(doc))
}

/// What is known of a key: `table` without indices (`stage.thermostat`).
pub(crate) fn find(table: &str, method: Option<&str>, key: &str) -> Option<&'static KeyDoc> {
    keys_of(table, method).find(|doc| doc.key == key)
}

/// The scene reference as Markdown: a section a table, a row a key.
#[must_use]
pub fn markdown() -> String {
    let mut out = String::new();
    for table in tables() {
        let _ = write!(out, "### {}\n\n{}\n\n", table.heading(), table.meaning);
        out.push_str("| Key | Allowed | Default | Unit | Meaning |\n|---|---|---|---|---|\n");
        for doc in keys().iter().filter(|doc| doc.table == table.table) {
            let only = match doc.method {
                Some(method) => format!(" (`{method}`)"),
                None => String::new(),
            };
            let _ = writeln!(
                out,
                "| `{}`{only} | {} | {} | {} | {} |",
                doc.key,
                doc.allowed.text(),
                doc.default,
                doc.unit,
                doc.meaning
            );
        }
        out.push('\n');
    }
    out
}
