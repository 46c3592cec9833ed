//! One table of a document as a typed value, with errors that name file, line, key, value and what is allowed.
//!
//! The reference knows the keys of a table, their types and their ranges: it checks every value, the name of the method
//! first. What it describes in words alone, such as lists, is left to serde.

use lennard_core::options::Options;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use crate::Source;
use crate::document::{in_short, join, kind};
use crate::error::{Place, SceneError};
use crate::methods::Method;
use crate::names::{left_out, nearest, no_key};
use crate::reference::{self, Allowed, KeyDoc, Tag, quoted};
use crate::removed::{RemovedKind, removed};

/// The largest number of a key whose range names no end: far beyond, forces overflow.
const LARGEST: f64 = 1e12;

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
        table.get(self.tag()?.key)?.as_str()
    }

    /// What is known of a key of a table that names this method.
    fn doc(&self, method: Option<&str>, key: &str) -> Option<&'static KeyDoc> {
        reference::find(self.table, method, key)
    }

    /// The full name of a key of this table.
    pub fn name(&self, key: &str) -> String {
        join(self.path, key)
    }

    /// Reads a table whose keys all belong to `T`. Where a method is named beside the file, keys of the file that belong to
    /// another method go with that method.
    pub fn read<T: DeserializeOwned>(&self, table: &Table) -> Result<T, SceneError> {
        let mut table = table.clone();
        if let Some(method) = self.method_in(&table).map(str::to_owned) {
            table.retain(|key, _| !self.is_of_replaced_method(&method, key));
        }
        let table = &table;
        let tag = self.tag();
        if let Some(tag) = tag.filter(|tag| !table.contains_key(tag.key)) {
            return Err(self.missing(tag.key, table));
        }
        let method = self.method_in(table);
        // A wrong name of the method makes its keys unknown: it comes first.
        let named = tag.and_then(|tag| table.get_key_value(tag.key));
        for (key, value) in named.into_iter().chain(table) {
            match self.doc(method, key) {
                Some(doc) => self.check(key, value, doc)?,
                None => return Err(self.unknown_key(key, method)),
            }
        }
        self.typed(table)
    }

    /// Whether a key of the file belongs to another method than the one that was named beside the file.
    fn is_of_replaced_method(&self, method: &str, key: &str) -> bool {
        let is_beside =
            |key: &str| matches!(self.source.place(&self.name(key)), Some(Place::Override(_)));
        let is_of_any = || reference::keys().iter().any(|d| d.table == self.table && d.key == key);
        self.tag().is_some_and(|tag| is_beside(tag.key))
            && !is_beside(key)
            && self.doc(Some(method), key).is_none()
            && is_of_any()
    }

    /// Takes the keys that `S` declares out of a table, and reads them. The keys of the method stay.
    pub fn shared<S: Options + DeserializeOwned>(
        &self,
        table: &mut Table,
    ) -> Result<S, SceneError> {
        let mut shared = Table::new();
        for key in S::KEYS {
            if let Some(value) = table.remove(key.key) {
                shared.insert(key.key.to_owned(), value);
            }
        }
        for (key, value) in &shared {
            if let Some(doc) = self.doc(self.method_in(table), key) {
                self.check(key, value, doc)?;
            }
        }
        self.typed(&shared)
    }

    /// Reads the method that a table names with its own keys, once shared keys are taken.
    pub fn method<M: Method>(&self, table: &Table) -> Result<M, SceneError> {
        let mut table = table.clone();
        if let Some(tag) = self.tag()
            && let Some(usual) = tag.usual()
        {
            table.entry(tag.key).or_insert_with(|| usual.into());
        }
        let method: M = self.read(&table)?;
        method.check().map_err(|e| self.impossible(e.key, &e.found, &e.allowed))?;
        Ok(method)
    }

    /// The value of a key that a table must write.
    pub fn needed<V>(&self, table: &Table, key: &str, value: Option<V>) -> Result<V, SceneError> {
        value.ok_or_else(|| self.missing(key, table))
    }

    /// The values of a table as their type. A value that does not fit is found by its key alone.
    fn typed<T: DeserializeOwned>(&self, table: &Table) -> Result<T, SceneError> {
        let read = |table: Table| T::deserialize(Value::Table(table));
        read(table.clone()).map_err(|error| {
            let named = self.tag().and_then(|tag| table.get_key_value(tag.key));
            let is_misread = |entry: &(&String, &Value)| {
                let entries = named.into_iter().chain([*entry]);
                read(entries.map(|(k, v)| (k.clone(), v.clone())).collect()).is_err()
            };
            match table.iter().find(is_misread) {
                Some((key, value)) => {
                    self.of_wrong_kind(key, value, self.doc(self.method_in(table), key))
                }
                None => self.source.refuse(self.path, format!("cannot be read: {error}")),
            }
        })
    }

    /// Refuses a value of another type than the reference states, and a number outside its range.
    fn check(&self, key: &str, value: &Value, doc: &KeyDoc) -> Result<(), SceneError> {
        let allowed = doc.allowed;
        let number = match value {
            Value::Float(x) => Some(*x),
            Value::Integer(x) => Some(*x as f64),
            _ => None,
        };
        // A fraction in the place of a whole number has the wrong type, whatever its size.
        let fraction = matches!((value, allowed), (Value::Float(_), Allowed::Whole(..)));
        let range = if fraction { Allowed::NotNegative } else { allowed };
        if let Some(x) = number.filter(|x| !range.admits(*x)) {
            return Err(self.refuse(key, value, misfit(x, allowed)).allowed(allowed.text()));
        }
        let is_open = matches!(allowed, Allowed::Positive | Allowed::NotNegative);
        if is_open && number.is_some_and(|x| x > LARGEST) {
            let range = format!("{}, at most {LARGEST:e}", allowed.text());
            return Err(self.refuse(key, value, "is too large").allowed(range));
        }
        match (value, allowed) {
            (Value::String(name), Allowed::Names(names)) if !names().contains(&name.as_str()) => {
                Err(self.unknown_name(key, name, &names()))
            }
            (Value::Datetime(_), _) => Err(self.of_wrong_kind(key, value, Some(doc))),
            (Value::String(_), Allowed::Names(_)) | (Value::Boolean(_), Allowed::Flag) => Ok(()),
            (_, Allowed::Words(_)) => Ok(()),
            (_, Allowed::Names(_) | Allowed::Flag) => {
                Err(self.of_wrong_kind(key, value, Some(doc)))
            }
            _ if number.is_none() || fraction => Err(self.of_wrong_kind(key, value, Some(doc))),
            _ => Ok(()),
        }
    }

    fn refuse(&self, key: &str, value: &Value, message: impl Into<String>) -> SceneError {
        let name = self.name(key);
        let found = match self.source.quantities().get(&name) {
            Some((text, _)) => format!("{text:?}, {} in reduced units", in_short(value)),
            None => in_short(value),
        };
        self.source.refuse(&name, message).found(found)
    }

    /// The error for a value of another type than its key takes.
    fn of_wrong_kind(&self, key: &str, value: &Value, doc: Option<&KeyDoc>) -> SceneError {
        let allowed = doc.map(|doc| doc.allowed);
        let message = match (value, allowed) {
            (Value::Float(_), Some(Allowed::Whole(..))) => "is not a whole number".to_owned(),
            _ => format!("is {}", kind(value)),
        };
        let allowed = allowed.map_or_else(|| "another value".to_owned(), |allowed| allowed.text());
        self.refuse(key, value, message).allowed(allowed)
    }

    /// The error for a value that its method refuses.
    pub fn impossible(&self, key: &str, found: &str, allowed: &str) -> SceneError {
        let name = self.name(key);
        self.source.refuse(&name, "is not allowed").found(found).allowed(allowed)
    }

    /// The error for a value that the reference does not allow.
    pub fn not_allowed(&self, key: &str, value: &Value) -> SceneError {
        let allowed = self.doc(None, key).map(|doc| doc.allowed.text());
        self.refuse(key, value, "is not allowed").allowed(allowed.unwrap_or_default())
    }

    /// The error for a key that the table has not got, beside its method.
    fn unknown_key(&self, found: &str, method: Option<&str>) -> SceneError {
        let name = self.name(found);
        let mut docs: Vec<_> = reference::keys_of(self.table, method).collect();
        docs.sort_by_key(|doc| doc.method.is_none());
        let known: Vec<&str> = docs.iter().map(|doc| doc.key).collect();
        let refuse =
            |message: String| self.source.refuse(&name, message).found(format!("`{found}`"));
        if let Some(instead) = removed(RemovedKind::Key, &join(self.table, found)) {
            return refuse("was removed".to_owned()).allowed(instead);
        }
        if let Some(message) = no_key(found) {
            return refuse(format!("cannot be used: {message}")).allowed(known.join(", "));
        }
        let of_others =
            reference::keys().iter().filter(|doc| doc.table == self.table && doc.key == found);
        let others: Vec<&str> = of_others.filter_map(|doc| doc.method).collect();
        if let (Some(tag), [_, ..]) = (self.tag(), &others[..]) {
            let message = format!("goes with {} = {} alone", tag.key, quoted(&others));
            return refuse(message).allowed(known.join(", "));
        }
        refuse("is not a known key".to_owned())
            .allowed(known.join(", "))
            .suggestion(nearest(found, known.iter().copied()))
    }

    fn missing(&self, key: &str, table: &Table) -> SceneError {
        let allowed = self.doc(self.method_in(table), key).map(|doc| doc.allowed.text());
        let present: Vec<&str> = table.keys().map(String::as_str).collect();
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
        let refuse =
            |message: String| self.source.refuse(&name, message).found(format!("{found:?}"));
        let gone = match self.table {
            "observable" => removed(RemovedKind::Observable, found),
            table => removed(RemovedKind::Method, &join(table, found)),
        };
        if let Some(instead) = gone {
            return refuse("was removed".to_owned()).allowed(instead);
        }
        // The reason names what to take: a similar name beside it would contradict.
        if let Some(message) = left_out(&name, found) {
            return refuse(format!("cannot be \"{found}\": {message}")).allowed(quoted(known));
        }
        refuse("is not a known name".to_owned())
            .allowed(quoted(known))
            .suggestion(nearest(found, known.iter().copied()))
    }
}

/// What is wrong with a number outside its range.
fn misfit(x: f64, allowed: Allowed) -> &'static str {
    match x {
        x if !x.is_finite() => "is not a finite number",
        x if x < 0.0 => "is negative",
        0.0 => "is zero",
        x if allowed.smallest().is_some_and(|smallest| x < smallest) => "is too small",
        _ => "is too large",
    }
}
