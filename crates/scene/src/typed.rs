//! One table of the tree as a typed value, with errors that name file, line, key, value and what is allowed.

use lennard_core::options::Options;
use serde::de::DeserializeOwned;

use crate::Source;
use crate::de::{Fault, Trouble};
use crate::error::SceneError;
use crate::methods::Method;
use crate::names::{left_out, nearest, no_key};
use crate::reference::{self, Allowed, Tag, quoted};
use crate::tags::with_tag;
use crate::tree::{Entry, Node, Table, Value};

/// A table of the scene on its way to a type.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    pub source: &'a Source,
    /// Its name with indices, `stage.0.thermostat`.
    pub path: &'a str,
    /// Its name in the reference, `stage.thermostat`.
    pub table: &'static str,
}

impl<'a> Section<'a> {
    pub fn new(source: &'a Source, path: &'a str, table: &'static str) -> Self {
        Self { source, path, table }
    }

    /// The key that names the method of the table; `None` for a table without methods.
    fn tag(&self) -> Option<&'static Tag> {
        reference::table(self.table)?.tag.as_ref()
    }

    /// The name of the method that a table writes.
    fn method_in<'t>(&self, table: &'t Table) -> Option<&'t str> {
        table.get(self.tag()?.key).and_then(Node::text)
    }

    /// The full name of a key of this table.
    pub fn name(&self, key: &str) -> String {
        match self.path {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }

    /// Reads a table whose keys all belong to `T`, after a check of every number in it.
    pub fn read<T: DeserializeOwned>(&self, node: &Node) -> Result<T, SceneError> {
        let table = self.table_of(node)?;
        self.typed(node, table, self.method_in(table))
    }

    /// Takes the keys that `S` declares out of a table, and reads them. The keys of the method stay.
    pub fn take<S: Options + DeserializeOwned>(&self, node: &mut Node) -> Result<S, SceneError> {
        let table = self.table_of(node)?;
        let declared = |entry: &&Entry| S::KEYS.iter().any(|key| key.key == entry.key);
        let (shared, own) = table.0.iter().partition::<Vec<&Entry>, _>(declared);
        let [shared, own] = [shared, own].map(|part| Node {
            value: Value::Table(Table(part.into_iter().cloned().collect())),
            place: node.place.clone(),
        });
        let shared = self.typed(&shared, self.table_of(&shared)?, self.method_in(table))?;
        *node = own;
        Ok(shared)
    }

    /// Reads the method that a table names with its own keys, once shared keys are taken.
    pub fn method<M: Method>(&self, node: &Node) -> Result<M, SceneError> {
        let usual = self.tag().and_then(|tag| Some((tag.key, tag.usual()?)));
        let method: M = match usual {
            Some((key, usual)) => self.read(&with_tag(node, key, usual))?,
            None => self.read(node)?,
        };
        method.check().map_err(|e| self.impossible(e.key, &e.found, &e.allowed))?;
        Ok(method)
    }

    /// The value of a key that a table must write.
    pub fn needed<V>(&self, node: &Node, key: &str, value: Option<V>) -> Result<V, SceneError> {
        match value {
            Some(value) => Ok(value),
            None => Err(self.missing(key, self.table_of(node)?, None)),
        }
    }

    fn table_of<'n>(&self, node: &'n Node) -> Result<&'n Table, SceneError> {
        node.table().ok_or_else(|| {
            self.source
                .refuse(self.path, "is not a table")
                .found(node)
                .allowed(format!("a table, `[{}]`", self.path))
        })
    }

    fn typed<T: DeserializeOwned>(
        &self,
        node: &Node,
        table: &Table,
        method: Option<&str>,
    ) -> Result<T, SceneError> {
        self.check_numbers(table, method)?;
        let probe = |node: &Node| T::deserialize(node).err().map(|fault| fault.trouble);
        T::deserialize(node).map_err(|fault| self.explain(&fault, table, method, &probe))
    }

    /// Refuses numbers that are not finite, and those outside the range that the reference states.
    fn check_numbers(&self, table: &Table, method: Option<&str>) -> Result<(), SceneError> {
        for entry in &table.0 {
            let doc = reference::find(self.table, method, &entry.key);
            let allowed = doc.map(|doc| doc.allowed);
            let fits = match (&entry.node.value, allowed.unwrap_or(Allowed::NotNegative)) {
                // A fraction in the place of a whole number has the wrong type, which is said later.
                (Value::Number(x), Allowed::Whole(..)) => Allowed::NotNegative.admits(*x),
                (Value::Number(x), allowed) => allowed.admits(*x),
                (Value::Whole(x), allowed) => allowed.admits(*x as f64),
                _ => true,
            };
            if !fits {
                let smallest = allowed.and_then(|allowed| allowed.smallest());
                let is_below = |x: f64| smallest.is_some_and(|smallest| x < smallest);
                let message = match &entry.node.value {
                    Value::Number(x) if !x.is_finite() => "is not a finite number",
                    Value::Number(x) if *x < 0.0 => "is negative",
                    Value::Whole(x) if *x < 0 => "is negative",
                    Value::Number(0.0) | Value::Whole(0) => "is zero",
                    Value::Whole(x) if is_below(*x as f64) => "is too small",
                    Value::Number(x) if is_below(*x) => "is too small",
                    _ => "is too large",
                };
                return Err(self
                    .source
                    .refuse(&self.name(&entry.key), message)
                    .found(&entry.node)
                    .allowed(allowed.unwrap_or(Allowed::NotNegative).text()));
            }
        }
        Ok(())
    }

    /// The error for a value that its method refuses.
    pub fn impossible(&self, key: &str, found: &str, allowed: &str) -> SceneError {
        let name = self.name(key);
        self.source.refuse(&name, "is not allowed").found(found).allowed(allowed)
    }

    /// The scene error that a fault of the type amounts to.
    fn explain(
        &self,
        fault: &Fault,
        table: &Table,
        method: Option<&str>,
        probe: &dyn Fn(&Node) -> Option<Trouble>,
    ) -> SceneError {
        let tag = self.tag().map(|tag| tag.key);
        let culprit = || culprit(fault, table, tag, probe);
        match &fault.trouble {
            Trouble::UnknownKey { found, known } => self.unknown_key(found, known, method),
            Trouble::Missing { key } => self.missing(key, table, method),
            Trouble::UnknownName { found, known } => {
                let key = culprit();
                self.unknown_name(key.as_deref().or(tag).unwrap_or("kind"), found, known)
            }
            Trouble::WrongType { expected } => {
                let key = culprit();
                self.wrong_type(key.as_deref(), expected, table, method)
            }
            Trouble::Other(message) => {
                let key = culprit();
                let name = key.map_or_else(|| self.path.to_owned(), |key| self.name(&key));
                self.source.refuse(&name, format!("cannot be read: {message}"))
            }
        }
    }

    /// The error for a key that neither the type knows nor, beside a method, the table.
    fn unknown_key(&self, found: &str, known: &[&str], method: Option<&str>) -> SceneError {
        let name = self.name(found);
        let mut known = known.to_vec();
        if self.tag().is_some() {
            let others = reference::keys_of(self.table, method).map(|doc| doc.key);
            let others: Vec<&str> = others.filter(|key| !known.contains(key)).collect();
            known.extend(others);
        }
        if let Some(message) = no_key(found) {
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
        // The reason names what to take: a similar name beside it would contradict.
        let (message, suggestion) = match left_out(&name, found) {
            Some(message) => (format!("cannot be \"{found}\": {message}"), None),
            None => ("is not a known name".to_owned(), nearest(found, known.iter().copied())),
        };
        self.source
            .refuse(&name, message)
            .found(format!("{found:?}"))
            .allowed(quoted(known))
            .suggestion(suggestion)
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
        self.source.refuse(&self.name(key), message).found(node).allowed(allowed)
    }
}

/// The key of a table that a fault is about.
///
/// An internally tagged enum copies its table before it looks at it, and so forgets the path of the
/// key. Each key is then tried alone beside the name of the method, until one key gives the same fault.
fn culprit(
    fault: &Fault,
    table: &Table,
    tag: Option<&str>,
    probe: &dyn Fn(&Node) -> Option<Trouble>,
) -> Option<String> {
    if let Some(outermost) = fault.path.last() {
        return Some(outermost.clone());
    }
    if let Trouble::UnknownName { found, .. } = &fault.trouble {
        let named = table.0.iter().find(|e| e.node.text() == Some(found));
        return named.map(|entry| entry.key.clone());
    }
    let kind = table.entry(tag?)?;
    let probed = |entries: Vec<Entry>| {
        let trouble =
            probe(&Node { value: Value::Table(Table(entries)), place: kind.place.clone() });
        trouble.as_ref() == Some(&fault.trouble)
    };
    if probed(vec![kind.clone()]) {
        return Some(kind.key.clone());
    }
    let others = table.0.iter().filter(|entry| entry.key != kind.key);
    let guilty = others.into_iter().find(|entry| probed(vec![kind.clone(), (*entry).clone()]));
    guilty.map(|entry| entry.key.clone())
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
