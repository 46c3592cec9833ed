//! The tables of a document as the tables of a scene.

use std::path::{Path, PathBuf};

use lennard_forcefield::{PotentialOptions, TablePath, TruncationOptions};
use lennard_literature::units::Units;
use serde::Deserialize;
use toml::{Table, Value};

use crate::document::as_heading;
use crate::limits::MOST_ENTRIES;
use crate::names::no_key;
use crate::reference::{self, Form};
use crate::section::Section;
use crate::tables::PLANAR;
use crate::{Name, ProgramParts, RemovedKind, SceneError, Source, nearest, removed, study};

mod molecule;
mod output;
mod species;
mod stages;
mod start;
mod walls;

/// Makes the written path of a key one that can be opened, or says why not.
pub(crate) type Resolve<'a> = &'a dyn Fn(&Source, &str, &Path) -> Result<PathBuf, SceneError>;

/// How the tables are written that stand in no other table.
const ROOT: [Form; 2] = [Form::Once, Form::Many];

/// The table that a run writes where its program has parts of its own; no message offers it, and the reference has not got it.
const WRITTEN_BY_RUNS: &str = "program";

pub(crate) struct Reader<'a> {
    root: &'a Table,
    pub source: &'a Source,
    pub units: Option<Units>,
    empty: Table,
}

impl<'a> Reader<'a> {
    pub fn new(root: &'a Table, source: &'a Source, units: Option<Units>) -> Self {
        Self { root, source, units, empty: Table::new() }
    }

    /// Refuses keys outside every table, and unknown tables.
    pub fn known_tables(&self) -> Result<(), SceneError> {
        for (key, value) in self.root {
            if key == "name" || key == WRITTEN_BY_RUNS {
                continue;
            }
            let Some(doc) = reference::table(key).filter(|doc| ROOT.contains(&doc.form)) else {
                return Err(self.unknown_table(key, value));
            };
            let is_many = doc.form == Form::Many;
            let heading = match is_many {
                false => format!("a table, {}", doc.heading()),
                true => format!("an array of tables, {}", doc.heading()),
            };
            let fits = match value {
                Value::Table(_) => !is_many,
                Value::Array(items) => is_many && items.iter().all(Value::is_table),
                _ => false,
            };
            if !fits {
                return Err(self
                    .refuse(key, "is written the wrong way")
                    .found(as_heading(key, value))
                    .allowed(heading));
            }
        }
        Ok(())
    }

    fn unknown_table(&self, key: &str, value: &Value) -> SceneError {
        let written = |form: Form| reference::tables().iter().filter(move |doc| doc.form == form);
        let tables = ROOT.into_iter().flat_map(written).map(|doc| doc.table);
        let known: Vec<&str> = tables.chain(["name"]).collect();
        if study::KEYS.contains(&key) {
            return self
                .refuse(key, "belongs to a sweep, and this file is read as a scene")
                .found(format!("`{key}`"))
                .allowed("`lennard sweep` for this file, or a scene without it");
        }
        if let Some(instead) = removed(RemovedKind::Key, key) {
            let error = self.refuse(key, "was removed");
            return error.found(format!("`{key}`")).allowed(instead);
        }
        if let Some(message) = no_key(key) {
            return self
                .refuse(key, format!("cannot be used: {message}"))
                .found(format!("`{key}`"))
                .allowed(known.join(", "));
        }
        let what = match value {
            Value::Table(_) => "table",
            Value::Array(_) => "array",
            _ => "key outside all tables",
        };
        let home = reference::keys().iter().find(|doc| doc.key == key);
        let suggestion = nearest(key, known.iter().copied())
            .or_else(|| home.map(|doc| format!("{} in [{}]", doc.key, doc.table)));
        self.refuse(key, format!("is not a known {what}"))
            .found(format!("`{key}`"))
            .allowed(known.join(", "))
            .suggestion(suggestion)
    }

    /// The error that a key has this trouble, with file and line.
    fn refuse(&self, key: &str, message: impl Into<String>) -> SceneError {
        self.source.refuse(key, message)
    }

    /// A table; an empty one where it is not written.
    pub fn table(&self, name: &str) -> &Table {
        self.root.get(name).and_then(Value::as_table).unwrap_or(&self.empty)
    }

    pub fn section(&'a self, table: &'static str) -> Section<'a> {
        Section::new(self.source, table, table)
    }

    /// A table whose type has a default for every key.
    pub fn plain<T: serde::de::DeserializeOwned>(
        &self,
        table: &'static str,
    ) -> Result<T, SceneError> {
        self.section(table).read(self.table(table))
    }

    /// The potential, with the file that it may read at a path that can be opened.
    pub fn potential(&self, resolve: Resolve<'_>) -> Result<PotentialOptions, SceneError> {
        let potential: PotentialOptions =
            self.section("potential").method(self.table("potential"))?;
        let Some(file) = potential.file() else {
            return Ok(potential);
        };
        let path = resolve(self.source, "potential.file", file.path())?;
        let file = TablePath::from(path.to_string_lossy().into_owned());
        potential.with_file(file).map_err(|error| {
            let key = format!("potential.{}", error.key);
            self.refuse(&key, "cannot be used").found(error.found).allowed(error.allowed)
        })
    }

    /// The truncation, and whether its tail is planar; cutoffs of a mixture are in σ of the scene unless it says otherwise.
    /// Where there is no potential, there is no tail.
    pub fn truncation(
        &self,
        has_species: bool,
        potential: &PotentialOptions,
    ) -> Result<(TruncationOptions, bool), SceneError> {
        let mut table = self.table("truncation").clone();
        let tail = table.get_mut("tail_correction");
        let tail = tail.filter(|tail| tail.as_str() == Some(PLANAR));
        let is_planar = tail.is_some();
        if let Some(tail) = tail {
            // The tail is a force beside the pairs, and no number is added to means.
            *tail = false.into();
        }
        let mut truncation: TruncationOptions = self.section("truncation").read(&table)?;
        let acts = potential.own_end().is_none_or(|end| end.r > 0.0);
        if !acts && !self.source.wrote("truncation.tail_correction") {
            truncation.tail_correction = false;
        }
        if has_species {
            truncation.r_cut_in.get_or_insert_default();
        }
        Ok((truncation, is_planar))
    }

    pub fn name(&self, file: &str) -> Result<Name, SceneError> {
        let Some(written) = self.root.get("name") else {
            return Ok(Name::of_file(Path::new(file)));
        };
        let name = written.as_str().and_then(Name::new);
        name.ok_or_else(|| self.section("").not_allowed("name", written))
    }

    /// The parts that the program of a run added.
    pub fn program(&self) -> Result<ProgramParts, SceneError> {
        let table = self.table(WRITTEN_BY_RUNS).clone();
        ProgramParts::deserialize(Value::Table(table)).map_err(|error| {
            self.refuse(WRITTEN_BY_RUNS, format!("cannot be read: {}", error.message()))
        })
    }

    /// The tables of a list.
    pub fn list(&self, name: &str) -> Result<Vec<&Table>, SceneError> {
        let items = self.root.get(name).and_then(Value::as_array);
        let tables: Vec<&Table> = items.into_iter().flatten().filter_map(Value::as_table).collect();
        match tables.len() {
            n if n > MOST_ENTRIES => Err(self
                .refuse(name, "is written too often")
                .found(format!("{n} times"))
                .allowed(format!("at most {MOST_ENTRIES} times"))),
            _ => Ok(tables),
        }
    }
}
