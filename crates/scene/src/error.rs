//! What is wrong with a scene, and where.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use lennard_io::shown;

/// Where a key was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// On this line of the file, counted from 1.
    Line(usize),
    /// In an override, as typed: `system.seed=7`.
    Override(Arc<str>),
}

/// A scene that cannot be used. The error says file, line, key, what was found and what is allowed. Where a
/// name is wrong, it says the nearest valid name. Its [`Display`](fmt::Display) is the whole message,
/// several lines long.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct SceneError(Box<Details>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Details {
    file: String,
    place: Option<Place>,
    key: Option<String>,
    message: String,
    found: Option<String>,
    allowed: Option<String>,
    suggestion: Option<String>,
}

impl SceneError {
    pub(crate) fn new(file: impl Into<String>, message: impl Into<String>) -> Self {
        Self(Box::new(Details {
            file: file.into(),
            place: None,
            key: None,
            message: message.into(),
            found: None,
            allowed: None,
            suggestion: None,
        }))
    }

    pub(crate) fn at(mut self, place: Option<Place>) -> Self {
        self.0.place = place;
        self
    }

    pub(crate) fn key(mut self, key: impl Into<String>) -> Self {
        self.0.key = Some(key.into());
        self
    }

    /// Says what was found.
    #[must_use]
    pub fn found(mut self, found: impl fmt::Display) -> Self {
        self.0.found = Some(found.to_string());
        self
    }

    /// Says what is allowed.
    #[must_use]
    pub fn allowed(mut self, allowed: impl fmt::Display) -> Self {
        self.0.allowed = Some(allowed.to_string());
        self
    }

    /// Says which name may be meant.
    #[must_use]
    pub fn suggestion(mut self, suggestion: Option<impl Into<String>>) -> Self {
        self.0.suggestion = suggestion.map(Into::into);
        self
    }

    /// The same trouble at a place of another file.
    pub(crate) fn moved(mut self, file: &str, place: Option<Place>) -> Self {
        file.clone_into(&mut self.0.file);
        self.0.place = place;
        self
    }

    /// The same trouble without a line, for a scene that no file holds.
    #[must_use]
    pub fn without_line(mut self) -> Self {
        self.0.place = self.0.place.filter(|p| !matches!(p, Place::Line(_)));
        self
    }

    /// The scene file.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.0.file
    }

    /// The line in the file, counted from 1; `None` where the trouble is an override or the whole file.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self.0.place {
            Some(Place::Line(line)) => Some(line),
            _ => None,
        }
    }

    /// Without a place, where that is one of these overrides: the program added them, and the user never typed them.
    pub(crate) fn not_typed(mut self, added: &[(String, String)]) -> Self {
        let is_added = |text: &str| added.iter().any(|(k, v)| format!("{k}={v}") == text);
        self.0.place =
            self.0.place.filter(|place| !matches!(place, Place::Override(text) if is_added(text)));
        self
    }

    /// The override, as typed, where the trouble came from one.
    #[must_use]
    pub fn overridden_by(&self) -> Option<&str> {
        match &self.0.place {
            Some(Place::Override(text)) => Some(text),
            _ => None,
        }
    }

    /// The key with its tables, `stage.0.steps`.
    #[must_use]
    pub fn key_path(&self) -> Option<&str> {
        self.0.key.as_deref()
    }

    /// What is wrong, in a sentence.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// The value found.
    #[must_use]
    pub fn value_found(&self) -> Option<&str> {
        self.0.found.as_deref()
    }

    /// What is allowed.
    #[must_use]
    pub fn what_is_allowed(&self) -> Option<&str> {
        self.0.allowed.as_deref()
    }

    /// The nearest valid name.
    #[must_use]
    pub fn nearest(&self) -> Option<&str> {
        self.0.suggestion.as_deref()
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Details { file, place, key, message, found, allowed, suggestion } = &*self.0;
        write!(f, "{}", shown(file))?;
        match place {
            Some(Place::Line(line)) => write!(f, ", line {line}")?,
            Some(Place::Override(text)) => write!(f, ", override `{}`", shown(&**text))?,
            None => {}
        }
        let key = key.as_ref().map(|key| match place {
            Some(Place::Override(text)) => as_typed(key, text),
            _ => key.into(),
        });
        match key {
            Some(key) => write!(f, ": `{}` {}", shown(&*key), shown(message))?,
            None => write!(f, ": {}", shown(message))?,
        }
        let rest = [("found:  ", found), ("allowed:", allowed), ("nearest:", suggestion)];
        rest.into_iter().try_for_each(|(head, text)| match text {
            Some(text) => write!(f, "\n  {head} {}", shown(text)),
            None => Ok(()),
        })
    }
}

/// A key in the words of the override that it came from: `stage.production.steps` for `stage.2.steps`, where the override names
/// the stage.
fn as_typed(key: &str, text: &str) -> String {
    let (typed, _) = text.split_once('=').unwrap_or((text, ""));
    let mut typed = typed.split('.').map(str::trim);
    let is_index = |part: &str| part.parse::<usize>().is_ok();
    let parts = key.split('.').map(|part| match typed.next() {
        Some(name) if is_index(part) => name,
        _ => part,
    });
    parts.collect::<Vec<_>>().join(".")
}

/// The texts of quantities with units, and their values in reduced units, by the full names of their keys.
pub type Quantities = BTreeMap<String, (String, f64)>;

/// Where each key of a scene was written, so that trouble found later can still be put on a line.
#[derive(Debug, Clone, Default)]
pub struct Source {
    file: String,
    places: BTreeMap<String, Place>,
    quantities: Quantities,
}

/// Two scenes are equal when they say the same, wherever they were written.
impl PartialEq for Source {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Source {
    pub(crate) fn new(file: impl Into<String>, places: BTreeMap<String, Place>) -> Self {
        Self { file: file.into(), places, quantities: BTreeMap::new() }
    }

    /// With the quantities that were written with a unit.
    pub(crate) fn with_quantities(self, quantities: Quantities) -> Self {
        Self { quantities, ..self }
    }

    /// The keys that were written with a unit.
    #[must_use]
    pub fn quantities(&self) -> &Quantities {
        &self.quantities
    }

    /// Where the keys of one table were written, by their names in it.
    pub(crate) fn inside(&self, table: &str) -> Self {
        let key = |name: &str| Some(name.strip_prefix(table)?.strip_prefix('.')?.to_owned());
        let places = self.places.iter().filter_map(|(name, at)| Some((key(name)?, at.clone())));
        Self::new(&self.file, places.collect())
    }

    /// The scene file, as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where a key such as `truncation.r_cut` or `stage.0.steps` was written, or else the table that it
    /// would belong to; `None` where neither was written.
    #[must_use]
    pub fn place(&self, key: &str) -> Option<&Place> {
        let mut key = key;
        loop {
            if let Some(place) = self.places.get(key) {
                return Some(place);
            }
            key = &key[..key.rfind('.')?];
        }
    }

    /// The line of a key, counted from 1, or the line of its table. `None` where neither was
    /// written, or where the value came from an override.
    #[must_use]
    pub fn locate(&self, key: &str) -> Option<usize> {
        match self.place(key) {
            Some(Place::Line(line)) => Some(*line),
            _ => None,
        }
    }

    /// Whether the key was written at all, in the file or as an override.
    #[must_use]
    pub fn wrote(&self, key: &str) -> bool {
        self.places.contains_key(key)
    }

    /// The error for a value that turned out not to fit, with file and line.
    #[must_use]
    pub fn invalid(
        &self,
        key: &str,
        found: impl fmt::Display,
        allowed: impl fmt::Display,
    ) -> SceneError {
        self.refuse(key, "does not fit").found(found).allowed(allowed)
    }

    /// The error that a name is used twice, `first` being the key where it was before.
    pub(crate) fn twice(&self, key: &str, found: &str, first: &str) -> SceneError {
        let before = match self.place(first) {
            Some(Place::Line(line)) => format!("on line {line}"),
            Some(Place::Override(text)) => format!("in the override `{text}`"),
            None => format!("in {first}"),
        };
        self.refuse(key, "is written twice")
            .found(format!("{found:?}, first {before}"))
            .allowed("each at most once")
    }

    /// The error that the file has this trouble.
    #[must_use]
    pub fn without_key(&self, message: impl Into<String>) -> SceneError {
        SceneError::new(&self.file, message)
    }

    /// The error that a key has this trouble, with file and line.
    #[must_use]
    pub fn refuse(&self, key: &str, message: impl Into<String>) -> SceneError {
        SceneError::new(&self.file, message).at(self.place(key).cloned()).key(key)
    }
}
