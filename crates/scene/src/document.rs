//! The text of a scene as TOML values, and where each was written, with values given beside the file written over it.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;
use toml::de::{DeTable, DeValue, Deserializer, ValueDeserializer};
use toml::{Spanned, Table, Value};

use crate::error::{Place, Quantities, SceneError, Source};
use crate::names::nearest;

/// What stands for the measured stage in a key: `stage.measured.steps`.
const MEASURED: &str = "measured";
/// The largest scene file that is read, in bytes: far above any real one.
const LARGEST_FILE: usize = 1 << 20;

/// A document that was read: its values, and the place of each by its full name (`stage.0.steps`).
pub(crate) struct Document {
    file: String,
    /// The tables and keys outside all tables.
    pub root: Table,
    places: BTreeMap<String, Place>,
    /// Quantities that were written with a unit, by the full names of their keys.
    pub quantities: Quantities,
}

/// The full name of a key in a table; the root has no name.
pub(crate) fn join(table: &str, key: &str) -> String {
    match table {
        "" => key.to_owned(),
        table => format!("{table}.{key}"),
    }
}

impl Document {
    /// Reads the text of a file.
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        if text.len() > LARGEST_FILE {
            return Err(SceneError::new(file, "is too large for a scene")
                .found(format!("{} bytes", text.len()))
                .allowed(format!("at most {LARGEST_FILE} bytes")));
        }
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let place = |offset: usize| Place::Line(ends.partition_point(|end| *end < offset) + 1);
        let table = DeTable::parse(text).map_err(|error| {
            SceneError::new(file, "this is not TOML")
                .at(error.span().map(|span| place(span.start)))
                .found(error.message())
                .allowed("a TOML file: `[table]`, `key = value`, `# comment`")
        })?;
        let mut places = BTreeMap::new();
        note_table("", table.get_ref(), &place, &mut places);
        let root = Table::deserialize(Deserializer::from(table)).map_err(|error| {
            let span = error.span().unwrap_or_default();
            let (found, allowed) = unreadable(&text[span.clone()]);
            SceneError::new(file, "a number cannot be read")
                .at(Some(place(span.start)))
                .found(found)
                .allowed(allowed)
        })?;
        Ok(Self { file: file.to_owned(), root, places, quantities: BTreeMap::new() })
    }

    /// Where each key was written.
    pub fn source(&self) -> Source {
        Source::new(&self.file, self.places.clone()).with_quantities(self.quantities.clone())
    }

    /// Takes out a key of a table, such as `system.box`, where it is written.
    pub fn remove(&mut self, key: &str) {
        if let Some((table, inner)) = key.split_once('.')
            && let Some(Value::Table(table)) = self.root.get_mut(table)
        {
            table.remove(inner);
            self.forget(key);
        }
    }

    /// Whether a key was written in the file.
    fn is_of_file(&self, key: &str) -> bool {
        matches!(self.places.get(key), Some(Place::Line(_)))
    }

    /// Forgets the places of a key and of everything in it.
    fn forget(&mut self, name: &str) {
        let inside = |key: &str| key.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        self.places.retain(|key, _| key != name && !inside(key));
    }

    /// Writes values over the document, in their order: keys such as `stage.production.steps`, with values as TOML.
    pub fn overlay(&mut self, overrides: &[(String, String)]) -> Result<(), SceneError> {
        for (key, written) in overrides {
            let place = Place::Override(Arc::from(format!("{key}={written}")));
            let over = Override { file: self.file.clone(), place: place.clone() };
            let steps: Vec<&str> = key.split('.').map(str::trim).collect();
            if steps.iter().any(|step| step.is_empty()) {
                return Err(over
                    .refuse(key, "has an empty part")
                    .found(format!("{key:?}"))
                    .allowed("names joined by dots, as `system.n_atoms` or `stage.0.steps`"));
            }
            // `density` and `box` say the same thing twice: one beside the file drops the other.
            match key.as_str() {
                "system.density" => self.remove("system.box"),
                "system.box" => self.remove("system.density"),
                // Another truncation ends elsewhere than the one of the file.
                "truncation.kind" if self.is_of_file("truncation.switch_from") => {
                    self.remove("truncation.switch_from");
                }
                _ => {}
            }
            // What is no TOML is a text without its quotes.
            let parsed = DeValue::parse(written);
            let value = match parsed.clone() {
                Ok(value) => Value::deserialize(ValueDeserializer::from(value)).map_err(|_| {
                    let (found, allowed) = unreadable(written);
                    over.refuse(key, "holds a number that cannot be read")
                        .found(found)
                        .allowed(allowed)
                })?,
                Err(_) => Value::String(written.trim().to_owned()),
            };
            let created = over.set(&mut self.root, &steps, value, "")?;
            self.forget(&created.name);
            for table in created.tables {
                self.places.insert(table, place.clone());
            }
            if let Ok(value) = &parsed {
                note(&created.name, value, &|_| place.clone(), &mut self.places);
            }
            self.places.insert(created.name, place);
        }
        Ok(())
    }
}

/// What was written as a number that cannot be read, and what can be.
fn unreadable(written: &str) -> (String, &'static str) {
    let digits = written.trim().replace('_', "");
    match digits.contains(['.', 'e', 'E']) && !digits.starts_with("0x") {
        true => (format!("{digits}, a number beyond 64 bits"), "numbers below 1.8e308"),
        false => {
            (format!("{digits}, an integer beyond 64 bits"), "whole numbers from −2^63 to 2^63 − 1")
        }
    }
}

/// Notes where each key of a table was written, and everything in it.
fn note_table(
    name: &str,
    table: &DeTable<'_>,
    place: &dyn Fn(usize) -> Place,
    places: &mut BTreeMap<String, Place>,
) {
    for (key, value) in table {
        let name = join(name, key.get_ref());
        places.insert(name.clone(), place(key.span().start));
        note(&name, value, place, places);
    }
}

fn note(
    name: &str,
    value: &Spanned<DeValue<'_>>,
    place: &dyn Fn(usize) -> Place,
    places: &mut BTreeMap<String, Place>,
) {
    match value.get_ref() {
        DeValue::Table(table) => note_table(name, table, place, places),
        DeValue::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                let name = join(name, &i.to_string());
                places.insert(name.clone(), place(item.span().start));
                note(&name, item, place, places);
            }
        }
        _ => {}
    }
}

/// A value that is written over a document.
struct Override {
    file: String,
    place: Place,
}

/// What an override wrote: its full name with indices, and the tables that it made.
struct Written {
    name: String,
    tables: Vec<String>,
}

impl Override {
    fn refuse(&self, key: &str, message: &str) -> SceneError {
        SceneError::new(&self.file, message).at(Some(self.place.clone())).key(key)
    }

    /// Writes the value where the steps lead from a table of this name; tables on the way are made.
    fn set(
        &self,
        table: &mut Table,
        steps: &[&str],
        value: Value,
        prefix: &str,
    ) -> Result<Written, SceneError> {
        let (first, rest) = (steps[0], &steps[1..]);
        let name = join(prefix, first);
        if rest.is_empty() {
            table.insert(first.to_owned(), value);
            return Ok(Written { name, tables: Vec::new() });
        }
        let is_new = !table.contains_key(first);
        let inner = table.entry(first).or_insert_with(|| Value::Table(Table::new()));
        let mut written = self.set_in(inner, rest, value, name.clone())?;
        if is_new {
            written.tables.push(name);
        }
        Ok(written)
    }

    /// Writes the value where the steps lead from a value of this name.
    fn set_in(
        &self,
        inside: &mut Value,
        steps: &[&str],
        value: Value,
        name: String,
    ) -> Result<Written, SceneError> {
        match (inside, steps) {
            (inside, []) => {
                *inside = value;
                Ok(Written { name, tables: Vec::new() })
            }
            (Value::Table(inner), steps) => self.set(inner, steps, value, &name),
            (Value::Array(items), [which, rest @ ..]) => {
                let at = self.pick(items, which, &name)?;
                self.set_in(&mut items[at], rest, value, join(&name, &at.to_string()))
            }
            (other, _) => Err(self
                .refuse(&name, "holds a value, not a table")
                .found(in_short(other))
                .allowed("a key that ends here")),
        }
    }

    /// The member of an array of tables that is meant: by its index, or by its `name` or `kind`.
    fn pick(&self, items: &[Value], which: &str, array: &str) -> Result<usize, SceneError> {
        let label = |item: &'_ Value| {
            let table = item.as_table()?;
            let label = table.get("name").or_else(|| table.get("kind"))?.as_str()?;
            Some(label.to_owned())
        };
        let found = match which.parse::<usize>() {
            Ok(index) => (index < items.len()).then_some(index),
            Err(_) => items
                .iter()
                .position(|item| label(item).as_deref() == Some(which))
                .or_else(|| measured(items).filter(|_| array == "stage" && which == MEASURED)),
        };
        found.ok_or_else(|| {
            let names: Vec<String> = items.iter().filter_map(label).collect();
            let last = items.len().saturating_sub(1);
            let by_name = match names.as_slice() {
                [] => String::new(),
                names => format!(", or {}", names.join(", ")),
            };
            self.refuse(&join(array, which), "names no such entry")
                .found(format!("{which:?}"))
                .allowed(format!("an index from 0 to {last}{by_name}"))
                .suggestion(nearest(which, names.iter().map(String::as_str)))
        })
    }
}

/// The last stage that is measured: a stage that says so, or the last unless it says that it is not.
fn measured(stages: &[Value]) -> Option<usize> {
    let says = |i: usize| stages[i].get("measure").and_then(Value::as_bool);
    let last = stages.len().checked_sub(1)?;
    (0..=last).rev().find(|i| says(*i).unwrap_or(*i == last)).or(Some(last))
}

/// The kind of a value, in words.
pub(crate) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Boolean(_) => "true or false",
        Value::Integer(_) => "a whole number",
        Value::Float(_) => "a number",
        Value::String(_) => "a text",
        Value::Datetime(_) => "a date",
        Value::Array(_) => "an array",
        Value::Table(_) => "a table",
    }
}

/// The heading of a table or an array of tables, and any other value in short.
pub(crate) fn as_heading(key: &str, value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().all(Value::is_table) => format!("`[[{key}]]`"),
        Value::Table(_) => format!("`[{key}]`"),
        _ => in_short(value),
    }
}

/// The value as a scene file writes it, shortened where it is long.
pub(crate) fn in_short(value: &Value) -> String {
    /// Longest text and longest array that a message repeats.
    const LONGEST_TEXT: usize = 60;
    const LONGEST_ARRAY: usize = 9;
    match value {
        Value::Boolean(flag) => flag.to_string(),
        Value::Integer(whole) => whole.to_string(),
        Value::Float(number) => format!("{number:?}"),
        Value::String(text) if text.chars().count() > LONGEST_TEXT => {
            let start: String = text.chars().take(LONGEST_TEXT).collect();
            format!("{start:?}…")
        }
        Value::String(text) => format!("{text:?}"),
        Value::Datetime(date) => date.to_string(),
        Value::Array(items) => {
            let mut shown: Vec<String> = items.iter().take(LONGEST_ARRAY).map(in_short).collect();
            if items.len() > LONGEST_ARRAY {
                shown.push("…".to_owned());
            }
            format!("[{}]", shown.join(", "))
        }
        Value::Table(_) => "a table".to_owned(),
    }
}
