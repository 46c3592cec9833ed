//! The scene file as a tree of values, each knowing where it was written.

use std::collections::BTreeMap;
use std::fmt;

use toml::de::{DeTable, DeValue};

use crate::error::{Place, SceneError};

/// The largest scene file that is read, in bytes: far above any real one.
const LARGEST_FILE: usize = 1 << 20;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Flag(bool),
    Whole(i64),
    Number(f64),
    Text(String),
    Date(String),
    Array(Vec<Node>),
    Table(Table),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub value: Value,
    pub place: Place,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub key: String,
    /// Where the key stands; the value may begin on a later line.
    pub place: Place,
    pub node: Node,
}

/// Keys in the order in which they were written.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Table(pub Vec<Entry>);

impl Table {
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|entry| &entry.node)
    }

    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.0.iter().find(|entry| entry.key == key)
    }

    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.0.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    pub fn remove(&mut self, key: &str) -> Option<Entry> {
        let at = self.0.iter().position(|entry| entry.key == key)?;
        Some(self.0.remove(at))
    }

    /// Writes a value, over an older one where there is one.
    pub fn set(&mut self, key: &str, node: Node) {
        let place = node.place.clone();
        match self.0.iter_mut().find(|entry| entry.key == key) {
            Some(entry) => (entry.place, entry.node) = (place, node),
            None => self.0.push(Entry { key: key.to_owned(), place, node }),
        }
    }
}

impl Node {
    pub fn table(&self) -> Option<&Table> {
        match &self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// What kind of value it is, in words.
    pub fn kind(&self) -> &'static str {
        match &self.value {
            Value::Flag(_) => "true or false",
            Value::Whole(_) => "a whole number",
            Value::Number(_) => "a number",
            Value::Text(_) => "a text",
            Value::Date(_) => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

/// The value as TOML would have it, shortened where it is long.
impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Longest text and longest array that a message repeats.
        const LONGEST_TEXT: usize = 60;
        const LONGEST_ARRAY: usize = 9;
        match &self.value {
            Value::Flag(flag) => write!(f, "{flag}"),
            Value::Whole(whole) => write!(f, "{whole}"),
            Value::Number(number) => write!(f, "{number:?}"),
            Value::Text(text) if text.chars().count() > LONGEST_TEXT => {
                let start: String = text.chars().take(LONGEST_TEXT).collect();
                write!(f, "{start:?}…")
            }
            Value::Text(text) => write!(f, "{text:?}"),
            Value::Date(date) => write!(f, "{date}"),
            Value::Array(items) => {
                write!(f, "[")?;
                for (i, item) in items.iter().take(LONGEST_ARRAY).enumerate() {
                    let comma = if i == 0 { "" } else { ", " };
                    write!(f, "{comma}{item}")?;
                }
                let rest = if items.len() > LONGEST_ARRAY { ", …" } else { "" };
                write!(f, "{rest}]")
            }
            Value::Table(_) => write!(f, "a table"),
        }
    }
}

/// Line numbers from byte offsets.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(at, _)| at).collect())
    }

    fn place(&self, offset: usize) -> Place {
        Place::Line(self.0.partition_point(|end| *end < offset) + 1)
    }
}

/// Reads a scene file's text.
pub(crate) fn parse(text: &str, file: &str) -> Result<Table, SceneError> {
    if text.len() > LARGEST_FILE {
        return Err(SceneError::new(file, "is too large for a scene")
            .found(format!("{} bytes", text.len()))
            .allowed(format!("at most {LARGEST_FILE} bytes")));
    }
    let lines = Lines::new(text);
    let syntax = |error: &toml::de::Error| {
        SceneError::new(file, "this is not TOML")
            .at(error.span().map(|span| lines.place(span.start)))
            .found(error.message())
            .allowed("a TOML file: `[table]`, `key = value`, `# comment`")
    };
    let document = DeTable::parse(text).map_err(|error| syntax(&error))?;
    table(document.get_ref(), &|offset| lines.place(offset)).map_err(|(place, found, allowed)| {
        SceneError::new(file, "a number cannot be read")
            .at(Some(place))
            .found(found)
            .allowed(allowed)
    })
}

/// Reads the value of an override: TOML where it is TOML, a bare word as a text. A number that cannot be read is no
/// text: it is given back as what was found, with what is allowed.
pub(crate) fn parse_value(text: &str, place: &Place) -> Result<Node, (String, &'static str)> {
    match DeValue::parse(text) {
        Ok(value) => node(value.get_ref(), 0, &|_| place.clone())
            .map_err(|(_, found, allowed)| (found, allowed)),
        Err(_) => Ok(Node { value: Value::Text(text.trim().to_owned()), place: place.clone() }),
    }
}

/// Where an unreadable number is, the number, and what is allowed.
type Unreadable = (Place, String, &'static str);

fn table(from: &DeTable<'_>, place: &dyn Fn(usize) -> Place) -> Result<Table, Unreadable> {
    let mut entries = Vec::with_capacity(from.len());
    for (key, value) in from {
        let start = key.span().start;
        entries.push((
            start,
            Entry {
                key: key.get_ref().to_string(),
                place: place(start),
                node: node(value.get_ref(), value.span().start, place)?,
            },
        ));
    }
    entries.sort_by_key(|(start, _)| *start);
    Ok(Table(entries.into_iter().map(|(_, entry)| entry).collect()))
}

fn node(
    from: &DeValue<'_>,
    start: usize,
    place: &dyn Fn(usize) -> Place,
) -> Result<Node, Unreadable> {
    let value = match from {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(number) => {
            let digits = number.as_str().replace('_', "");
            let read = i64::from_str_radix(&digits, number.radix());
            Value::Whole(read.map_err(|_| {
                let found = format!("{digits}, an integer beyond 64 bits");
                (place(start), found, "whole numbers from −2^63 to 2^63 − 1")
            })?)
        }
        DeValue::Float(number) => {
            let digits = number.as_str().replace('_', "");
            let read = digits.parse::<f64>();
            Value::Number(read.map_err(|_| (place(start), digits, "a decimal number"))?)
        }
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|item| node(item.get_ref(), item.span().start, place))
                .collect::<Result<_, _>>()?,
        ),
        DeValue::Table(entries) => Value::Table(table(entries, place)?),
    };
    Ok(Node { value, place: place(start) })
}

/// The place of every key, by its full name (`stage.0.steps`).
pub(crate) fn places(root: &Table) -> BTreeMap<String, Place> {
    fn walk(prefix: &str, node: &Node, out: &mut BTreeMap<String, Place>) {
        match &node.value {
            Value::Table(table) => {
                for entry in &table.0 {
                    let name = format!("{prefix}.{}", entry.key);
                    out.insert(name.clone(), entry.place.clone());
                    walk(&name, &entry.node, out);
                }
            }
            Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    let name = format!("{prefix}.{i}");
                    out.insert(name.clone(), item.place.clone());
                    walk(&name, item, out);
                }
            }
            _ => {}
        }
    }
    let mut out = BTreeMap::new();
    for entry in &root.0 {
        out.insert(entry.key.clone(), entry.place.clone());
        walk(&entry.key, &entry.node, &mut out);
    }
    out
}
