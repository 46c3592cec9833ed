//! The scene reference: every table and key with what it may hold. Error messages, the range checks and
//! the tables of `inputs/README.md` are made from it.

use std::sync::OnceLock;

pub(crate) mod tables;

pub use lennard_core::options::Allowed;
pub(crate) use lennard_core::options::quoted;
pub(crate) use tables::{Form, Tag};
pub use tables::{KeyDoc, TableDoc};

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
