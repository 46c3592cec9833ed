//! What earlier versions had: keys, options, commands, observables, methods, columns and names, each with its new way.
//!
//! The list is `removed.toml`. A refusal of an unknown key, observable, method, option or command looks here first.

use std::sync::LazyLock;

use serde::Deserialize;

/// The kind of a thing that was removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RemovedKind {
    /// A key or a table of a scene file, with its tables and without indices: `system.vacuum`.
    Key,
    /// An option of a command: `plan --nodes`.
    Option,
    /// A command of the program.
    Command,
    /// A kind of observable.
    Observable,
    /// A method of a table: `integrator.bit-reversible-verlet`.
    Method,
    /// A column of a table that a run writes. No refusal can meet it.
    Column,
    /// A public name of the libraries, which the compiler refuses.
    Name,
}

/// A line of `removed.toml`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Removed {
    /// The kind of the thing.
    pub kind: RemovedKind,
    /// Its name.
    pub name: String,
    /// The new way, in words.
    pub instead: String,
}

#[derive(Deserialize)]
struct List {
    removed: Vec<Removed>,
}

/// Everything that was removed.
///
/// # Panics
/// Where `removed.toml` is not such a list, which a test would find.
#[must_use]
pub fn all_removed() -> &'static [Removed] {
    static ALL: LazyLock<Vec<Removed>> = LazyLock::new(|| {
        let list = toml::from_str::<List>(include_str!("../removed.toml"));
        list.expect("a list of what was removed").removed
    });
    &ALL
}

/// The new way of a thing that was removed; `None` for any other name.
#[must_use]
pub fn removed(kind: RemovedKind, name: &str) -> Option<&'static str> {
    let mut all = all_removed().iter();
    let found = all.find(|one| one.kind == kind && one.name == name);
    found.map(|one| one.instead.as_str())
}
