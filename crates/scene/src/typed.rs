//! One table of the tree as a typed value, with errors that name file, line, key, value and what is allowed.

use serde::de::DeserializeOwned;

use crate::Source;
use crate::de::{Fault, Trouble};
use crate::error::SceneError;
use crate::names::{left_out, nearest, not_yet};
use crate::reference::{self, Allowed, quoted};
use crate::tree::{Entry, Node, Table, Value};

/// A table of the scene on its way to a type.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    pub source: &'a Source,
    /// Its name with indices, `stage.0.thermostat`.
    pub path: &'a str,
    /// Its name in the reference, `stage.thermostat`.
    pub table: &'static str,
    /// Keys that are read elsewhere and that the type does not know.
    pub also: &'static [&'static str],
}

impl<'a> Section<'a> {
    pub fn new(source: &'a Source, path: &'a str, table: &'static str) -> Self {
        Self {
            source,
            path,
            table,
            also: &[],
        }
    }

    pub fn with(self, also: &'static [&'static str]) -> Self {
        Self { also, ..self }
    }

    /// The full name of a key of this table.
    pub fn name(&self, key: &str) -> String {
        match self.path {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }

    /// Reads the table, after a check of every number in it.
    pub fn read<T: DeserializeOwned>(&self, node: &Node) -> Result<T, SceneError> {
        let Some(table) = node.table() else {
            return Err(self
                .source
                .refuse(self.path, "is not a table")
                .found(node)
                .allowed(format!("a table, `[{}]`", self.path)));
        };
        let method = table.get(tag(table)).and_then(Node::text);
        self.check_numbers(table, method)?;
        let probe = |node: &Node| T::deserialize(node).err().map(|fault| fault.trouble);
        T::deserialize(node).map_err(|fault| self.explain(&fault, table, method, &probe))
    }

    /// Refuses numbers that are not finite, and those outside the range that the reference states.
    pub fn check_numbers(&self, table: &Table, method: Option<&str>) -> Result<(), SceneError> {
        for entry in &table.0 {
            let doc = reference::find(self.table, method, &entry.key);
            let allowed = doc.map(|doc| doc.allowed);
            let fits = match (&entry.node.value, allowed) {
                (Value::Number(x), Some(Allowed::Positive)) => x.is_finite() && *x > 0.0,
                (Value::Whole(x), Some(Allowed::Positive)) => *x > 0,
                (Value::Number(x), Some(Allowed::Between(from, to))) => (from..=to).contains(x),
                (Value::Whole(x), Some(Allowed::Between(from, to))) => {
                    (from..=to).contains(&(*x as f64))
                }
                (Value::Number(x), Some(Allowed::ZeroOrBetween(from, to))) => {
                    *x == 0.0 || (from..=to).contains(x)
                }
                (Value::Whole(x), Some(Allowed::ZeroOrBetween(from, to))) => {
                    *x == 0 || (from..=to).contains(&(*x as f64))
                }
                // No key of a scene has a use for a negative number.
                (Value::Number(x), _) => x.is_finite() && *x >= 0.0,
                (Value::Whole(x), Some(Allowed::Whole(from, to))) => (from..=to).contains(x),
                (Value::Whole(x), _) => *x >= 0,
                _ => true,
            };
            if !fits {
                let range = allowed;
                let allowed = allowed.unwrap_or(Allowed::NotNegative).text();
                let message = match &entry.node.value {
                    Value::Number(x) if !x.is_finite() => "is not a finite number",
                    Value::Number(x) if *x < 0.0 => "is negative",
                    Value::Whole(x) if *x < 0 => "is negative",
                    Value::Number(0.0) | Value::Whole(0) => "is zero",
                    Value::Whole(x) if allowed_above(range, *x as f64) => "is too small",
                    Value::Number(x) if allowed_above(range, *x) => "is too small",
                    _ => "is too large",
                };
                return Err(self
                    .source
                    .refuse(&self.name(&entry.key), message)
                    .found(&entry.node)
                    .allowed(allowed));
            }
        }
        Ok(())
    }

    /// The value of a single entry that is read apart from its table.
    pub fn number(&self, entry: &Entry, method: Option<&str>) -> Result<f64, SceneError> {
        self.single(entry, method)
    }

    /// The value of a single entry that is read apart from its table.
    pub fn count(&self, entry: &Entry) -> Result<u64, SceneError> {
        self.single(entry, None)
    }

    fn single<T: DeserializeOwned>(
        &self,
        entry: &Entry,
        method: Option<&str>,
    ) -> Result<T, SceneError> {
        let table = Table(vec![entry.clone()]);
        self.check_numbers(&table, method)?;
        T::deserialize(&entry.node)
            .map_err(|_| self.wrong_type(Some(&entry.key), "a value", &table, method))
    }

    /// The error for a value that its method refuses.
    pub fn impossible(&self, key: &str, found: &str, allowed: &str) -> SceneError {
        let name = self.name(key);
        self.source
            .refuse(&name, "is not allowed")
            .found(found)
            .allowed(allowed)
    }

    /// The scene error that a fault of the type amounts to.
    fn explain(
        &self,
        fault: &Fault,
        table: &Table,
        method: Option<&str>,
        probe: &dyn Fn(&Node) -> Option<Trouble>,
    ) -> SceneError {
        match &fault.trouble {
            Trouble::UnknownKey { found, known } => self.unknown_key(found, known),
            Trouble::Missing { key } => self.missing(key, table, method),
            Trouble::UnknownName { found, known } => {
                let key = culprit(fault, table, probe);
                self.unknown_name(key.as_deref().unwrap_or(tag(table)), found, known)
            }
            Trouble::WrongType { expected } => {
                let key = culprit(fault, table, probe);
                self.wrong_type(key.as_deref(), expected, table, method)
            }
            Trouble::Other(message) => {
                let key = culprit(fault, table, probe);
                let name = key.map_or_else(|| self.path.to_owned(), |key| self.name(&key));
                self.source
                    .refuse(&name, format!("cannot be read: {message}"))
            }
        }
    }

    pub fn unknown_key(&self, found: &str, known: &[&str]) -> SceneError {
        let name = self.name(found);
        let known: Vec<&str> = known.iter().chain(self.also).copied().collect();
        if let Some(message) = not_yet(found) {
            return self
                .source
                .refuse(&name, format!("cannot be used: {message}"))
                .found(format!("`{found}`"))
                .allowed(known.join(", "));
        }
        self.source
            .refuse(&name, "is not a known key")
            .found(format!("`{found}`"))
            .allowed(known.join(", "))
            .suggestion(nearest(found, known.iter().copied()))
    }

    fn missing(&self, key: &str, table: &Table, method: Option<&str>) -> SceneError {
        let allowed = reference::find(self.table, method, key).map(|doc| doc.allowed.text());
        let present: Vec<&str> = table.0.iter().map(|entry| entry.key.as_str()).collect();
        let found = match present.as_slice() {
            [] => "an empty table".to_owned(),
            keys => format!("a table with {}", keys.join(", ")),
        };
        self.source
            .refuse(&self.name(key), "is missing")
            .found(found)
            .allowed(allowed.unwrap_or_else(|| "a value".to_owned()))
    }

    /// The error for a name that nothing is called by.
    pub fn unknown_name(&self, key: &str, found: &str, known: &[&str]) -> SceneError {
        let name = self.name(key);
        let why = left_out(&name, found).map(str::to_owned);
        let error = self.source.refuse(
            &name,
            match why.or_else(|| not_yet(found)) {
                Some(message) => format!("cannot be \"{found}\": {message}"),
                None => "is not a known name".to_owned(),
            },
        );
        error
            .found(format!("{found:?}"))
            .allowed(quoted(known))
            .suggestion(nearest(found, known.iter().copied()))
    }

    fn wrong_type(
        &self,
        key: Option<&str>,
        expected: &str,
        table: &Table,
        method: Option<&str>,
    ) -> SceneError {
        let Some((key, node)) = key.and_then(|key| Some((key, table.get(key)?))) else {
            return self
                .source
                .refuse(self.path, "holds a value of the wrong type")
                .allowed(in_words(expected));
        };
        let allowed = reference::find(self.table, method, key).map(|doc| doc.allowed);
        let message = match (&node.value, allowed) {
            (Value::Number(_), Some(Allowed::Whole(..))) => "is not a whole number".to_owned(),
            _ => format!("is {}", node.kind()),
        };
        let allowed = allowed.map_or_else(|| in_words(expected), |allowed| allowed.text());
        self.source
            .refuse(&self.name(key), message)
            .found(node)
            .allowed(allowed)
    }
}

/// The key that names the method of a table: `kind`, `method` in `[bonds]`, or `rule` in `[mixing]`.
fn tag(table: &Table) -> &'static str {
    let is_there = |key: &&str| table.get(key).is_some();
    ["kind", "method", "rule"]
        .into_iter()
        .find(is_there)
        .unwrap_or("kind")
}

/// The key of a table that a fault is about.
///
/// An internally tagged enum copies its table before it looks at it, and so forgets the path of the
/// key. Each key is then tried alone beside `kind`, until one key gives the same fault.
fn culprit(
    fault: &Fault,
    table: &Table,
    probe: &dyn Fn(&Node) -> Option<Trouble>,
) -> Option<String> {
    if let Some(outermost) = fault.path.last() {
        return Some(outermost.clone());
    }
    if let Trouble::UnknownName { found, .. } = &fault.trouble {
        let named = table.0.iter().find(|e| e.node.text() == Some(found));
        return named.map(|entry| entry.key.clone());
    }
    let kind = table.entry(tag(table))?;
    let probed = |entries: Vec<Entry>| {
        let trouble = probe(&Node {
            value: Value::Table(Table(entries)),
            place: kind.place.clone(),
        });
        trouble.as_ref() == Some(&fault.trouble)
    };
    if probed(vec![kind.clone()]) {
        return Some(kind.key.clone());
    }
    let others = table.0.iter().filter(|entry| entry.key != kind.key);
    let guilty = others
        .into_iter()
        .find(|entry| probed(vec![kind.clone(), (*entry).clone()]));
    guilty.map(|entry| entry.key.clone())
}

/// Whether what is allowed lies above what was found.
fn allowed_above(allowed: Option<Allowed>, found: f64) -> bool {
    match allowed {
        Some(Allowed::Whole(from, _)) => found < from as f64,
        Some(Allowed::Between(from, _) | Allowed::ZeroOrBetween(from, _)) => found < from,
        _ => false,
    }
}

/// What serde expected, without the names of Rust's types.
fn in_words(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number".to_owned(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more".to_owned(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" => "a text in quotes".to_owned(),
        other => other.to_owned(),
    }
}
