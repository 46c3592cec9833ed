//! The scene reference: every table and key with what it may hold. Error messages, the range checks and
//! the tables of `inputs/README.md` are made from it.

use std::fmt::Write as _;
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
