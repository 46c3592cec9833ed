//! The table `[units]`: quantities that a scene writes with units, as plain numbers in reduced units.
//!
//! The unit that a key declares is its dimension: every key that has one takes a text such as `"94 K"`. Nothing behind this pass
//! knows of units.

use lennard_literature::units::{UnitError, Units, dimension_of, offered, offered_for, split};
use toml::{Table, Value};

use crate::document::{Document, join};
use crate::error::{Quantities, SceneError, Source};
use crate::names::{left_out, nearest};
use crate::reference::{self, KeyDoc, quoted};
use crate::section::Section;
use crate::tables::units::{UnitKeys, substances};

/// Puts plain numbers in the place of quantities with units, and says what units the scene has.
pub(crate) fn reduce(document: &mut Document) -> Result<Option<Units>, SceneError> {
    let source = document.source();
    let mut units = None;
    if let Some(table) = document.root.get("units").and_then(Value::as_table) {
        let section = Section::new(&source, "units", "units");
        let keys: UnitKeys = section.read(table)?;
        let name = section.needed(table, "substance", keys.substance)?;
        let alike = !["species", "molecule"].iter().any(|key| document.root.contains_key(*key));
        units = Units::of(&name).map(|units| Units { alike, ..units });
    }
    let mut pass = Pass { units, source: &source, quantities: Quantities::new() };
    pass.table("", "", &mut document.root)?;
    document.quantities = pass.quantities;
    Ok(units)
}

struct Pass<'a> {
    units: Option<Units>,
    source: &'a Source,
    quantities: Quantities,
}

impl Pass<'_> {
    /// A table by its name in the reference and its full name.
    fn table(&mut self, name: &str, path: &str, table: &mut Table) -> Result<(), SceneError> {
        let tag = reference::table(name).and_then(|doc| doc.tag.as_ref());
        let method = tag.and_then(|tag| Some(table.get(tag.key)?.as_str()?.to_owned()));
        let fits = |doc: &KeyDoc| {
            method.is_none() || doc.method.is_none() || doc.method == method.as_deref()
        };
        for (key, value) in table.iter_mut() {
            let (inner, path) = (join(name, key), join(path, key));
            match value {
                Value::Table(table) => self.table(&inner, &path, table)?,
                Value::Array(items) if items.iter().any(Value::is_table) => {
                    for (i, item) in items.iter_mut().enumerate() {
                        if let Value::Table(table) = item {
                            self.table(&inner, &join(&path, &i.to_string()), table)?;
                        }
                    }
                }
                value => {
                    let mut of_key =
                        reference::keys().iter().filter(|doc| doc.table == name && doc.key == key);
                    if let Some(doc) =
                        of_key.find(|doc| fits(doc)).filter(|doc| dimension_of(doc.unit).is_some())
                    {
                        self.value(&path, doc.unit, value)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The value of a key with a unit: a quantity, or lists with some.
    fn value(&mut self, path: &str, unit: &str, value: &mut Value) -> Result<(), SceneError> {
        match value {
            Value::Array(items) => {
                let mut items = items.iter_mut().enumerate();
                items.try_for_each(|(i, item)| self.value(&join(path, &i.to_string()), unit, item))
            }
            Value::String(text) => {
                let Some((number, written)) = split(text).filter(|(_, unit)| !unit.is_empty())
                else {
                    return Ok(());
                };
                let reduced = Units::reduce(self.units.as_ref(), number, written, unit);
                let reduced = reduced.map_err(|error| self.refused(path, text, unit, &error))?;
                self.quantities.insert(path.to_owned(), (std::mem::take(text), reduced));
                *value = reduced.into();
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn refused(&self, path: &str, text: &str, unit: &str, error: &UnitError) -> SceneError {
        let (allowed, nearest) = unit_in_words(text, unit, error);
        let refused = self.source.refuse(path, error.to_string()).found(format!("{text:?}"));
        refused.allowed(allowed).suggestion(nearest)
    }
}

/// Why a substance is not offered, where there is a reason.
#[must_use]
pub fn why_no_substance(name: &str) -> Option<&'static str> {
    left_out("substance", name)
}

/// What is allowed in the place of a quantity for a key or an option with a reduced unit, and the nearest unit.
#[must_use]
pub fn unit_in_words(text: &str, unit: &str, error: &UnitError) -> (String, Option<String>) {
    let plain = format!("a plain number, in {unit}");
    let mut fitting = offered_for(unit);
    let mut meant = None;
    match error {
        UnitError::NoSubstance => {
            let names = quoted(&substances());
            return (format!("{plain}; or with it a substance: {names}"), None);
        }
        UnitError::MassDensity => fitting.retain(|unit| *unit != "g/cm3"),
        UnitError::Unknown(symbol) => {
            let written = split(text).map_or(text, |(_, unit)| unit);
            meant = nearest(written, fitting.iter().copied());
            meant = meant.or_else(|| nearest(symbol, offered()));
        }
        UnitError::Dimension => {}
    }
    (format!("{plain}; or a number with {}", fitting.join(", ")), meant)
}
