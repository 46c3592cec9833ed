//! From the text of a scene to a [`Scene`], table by table.

use std::path::{Path, PathBuf};

use lennard_forcefield::{PotentialOptions, TablePath, TruncationOptions};
use serde::Deserialize;
use toml::{Table, Value};

use crate::document::{Document, in_short};
use crate::error::{Place, SceneError};
use crate::names::{nearest, no_key};
use crate::reference::{self, Form, MOST_ENTRIES};
use crate::removed::{RemovedKind, removed};
use crate::section::Section;
use crate::{
    MixtureTables, Name, ProgramParts, Scene, Source, accuracy, checks, model_kind, planar,
    shipped, study,
};

impl Scene {
    /// Reads a scene file, with overrides such as `("stage.production.steps", "1000")` over it.
    ///
    /// A relative path of a `configuration` or a table is taken from the folder of the scene file.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        Self::load_after(path, overrides, |_| {})
    }

    /// Reads a scene file that has settings of its own as a scene that asks for the usual accuracy
    /// ([`Accuracy::USUAL`](crate::Accuracy::USUAL)). The keys that an accuracy chooses are taken out of the file. Keys
    /// among `overrides` stay fixed.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_freed(path: &Path, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        let usual = accuracy::usual_overrides();
        let all: Vec<_> = usual.iter().chain(overrides).cloned().collect();
        Self::load_after(path, &all, accuracy::free).map_err(|error| error.not_typed(&usual))
    }

    /// Reads a scene file, with a change to what stands there before overrides are written over it.
    fn load_after(
        path: &Path,
        overrides: &[(String, String)],
        change: fn(&mut Document),
    ) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = shipped::read(path).map_err(|error| {
            SceneError::new(&file, "the scene file cannot be read")
                .found(error)
                .allowed(
                    "the path of a scene file, or the name of a shipped scene, such as fluid/gas",
                )
                .suggestion(shipped::suggestion(path))
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..good].iter().filter(|b| **b == b'\n').count() + 1;
            SceneError::new(&file, "this is not text")
                .at(Some(Place::Line(line)))
                .found("bytes that are not UTF-8")
                .allowed("a TOML file in UTF-8")
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let resolve = |source: &Source, key: &str, written: &Path| {
            let joined = folder.join(written);
            joined.canonicalize().map_err(|error| {
                source
                    .refuse(key, "cannot be read")
                    .found(format!("{} ({error})", joined.display()))
                    .allowed("the path of a file that can be read, relative to the scene file")
            })
        };
        let mut document = Document::parse(&text, &file)?;
        change(&mut document);
        read(document, &file, overrides, &resolve)
    }

    /// Reads a scene from its text; `name` stands for the file in messages. Only the table of a potential is read besides.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn parse(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        read(Document::parse(text, name)?, name, overrides, &|_, _, path| Ok(path.to_owned()))
    }
}

/// Makes the written path of a key one that can be opened, or says why not.
pub(crate) type Resolve<'a> = &'a dyn Fn(&Source, &str, &Path) -> Result<PathBuf, SceneError>;

fn read(
    mut document: Document,
    file: &str,
    overrides: &[(String, String)],
    resolve: Resolve<'_>,
) -> Result<Scene, SceneError> {
    document.overlay(overrides)?;
    let source = document.source();
    let reader = Reader::new(&document.root, &source);
    reader.known_tables()?;
    let mixture = reader.mixture()?;
    let potential = reader.potential(resolve)?;
    let (truncation, planar_tail) = reader.truncation(mixture.is_some(), &potential)?;
    let system = reader.system(
        resolve,
        mixture.as_ref().and_then(MixtureTables::total_count),
        mixture
            .is_none()
            .then(|| model_kind::of_atoms(&potential, &truncation, truncation.r_cut, planar_tail)),
    )?;
    let name = reader.name(file)?;
    let mut observables = reader.observables()?;
    let mut output = reader.output()?;
    reader.one_thermo_interval(&mut observables, &mut output)?;
    let mut scene = Scene {
        name,
        accuracy: reader.accuracy()?,
        free: Vec::new(),
        potential,
        truncation,
        planar_tail,
        neighbor: reader.plain("neighbor")?,
        kernel: reader.plain("kernel")?,
        integrator: reader.integrator()?,
        walls: Vec::new(),
        contact: reader.contact()?,
        acceleration: reader.field()?,
        stages: reader.stages(system.temperature)?,
        molecule: reader.molecule()?,
        mixture,
        observables,
        output,
        checkpoint: reader.checkpoint()?,
        program: reader.program()?,
        system,
        source: source.clone(),
    };
    scene.walls = reader.walls(scene.end_of_pairs())?;
    scene.free = accuracy::left_free(&scene);
    checks::whole_scene(&scene)?;
    Ok(scene)
}

/// How the tables are written that stand in no other table.
const ROOT: [Form; 2] = [Form::Once, Form::Many];

/// The table that a run writes where its program has parts of its own; no message offers it, and the reference has not got it.
const WRITTEN_BY_RUNS: &str = "program";

pub(crate) struct Reader<'a> {
    root: &'a Table,
    pub source: &'a Source,
    empty: Table,
}

impl<'a> Reader<'a> {
    pub fn new(root: &'a Table, source: &'a Source) -> Self {
        Self { root, source, empty: Table::new() }
    }

    /// Refuses keys outside every table, and unknown tables.
    fn known_tables(&self) -> Result<(), SceneError> {
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
                    .source
                    .refuse(key, "is written the wrong way")
                    .found(match value {
                        Value::Table(_) => format!("`[{key}]`"),
                        Value::Array(items) if items.iter().all(Value::is_table) => {
                            format!("`[[{key}]]`")
                        }
                        _ => in_short(value),
                    })
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
                .source
                .refuse(key, "belongs to a sweep, and this file is read as a scene")
                .found(format!("`{key}`"))
                .allowed("`lennard sweep` for this file, or a scene without it");
        }
        if let Some(instead) = removed(RemovedKind::Key, key) {
            let error = self.source.refuse(key, "was removed");
            return error.found(format!("`{key}`")).allowed(instead);
        }
        if let Some(message) = no_key(key) {
            return self
                .source
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
        self.source
            .refuse(key, format!("is not a known {what}"))
            .found(format!("`{key}`"))
            .allowed(known.join(", "))
            .suggestion(suggestion)
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
    fn potential(&self, resolve: Resolve<'_>) -> Result<PotentialOptions, SceneError> {
        let potential: PotentialOptions =
            self.section("potential").method(self.table("potential"))?;
        let Some(file) = potential.file() else {
            return Ok(potential);
        };
        let path = resolve(self.source, "potential.file", file.path())?;
        let file = TablePath::from(path.to_string_lossy().into_owned());
        potential.with_file(file).map_err(|error| {
            let key = format!("potential.{}", error.key);
            self.source.refuse(&key, "cannot be used").found(error.found).allowed(error.allowed)
        })
    }

    /// The truncation, and whether its tail is planar; cutoffs of a mixture are in σ of the scene unless it says otherwise.
    /// Where there is no potential, there is no tail.
    fn truncation(
        &self,
        has_species: bool,
        potential: &PotentialOptions,
    ) -> Result<(TruncationOptions, bool), SceneError> {
        let mut table = self.table("truncation").clone();
        let tail = table.get_mut("tail_correction");
        let tail = tail.filter(|tail| tail.as_str() == Some(planar::PLANAR));
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

    fn name(&self, file: &str) -> Result<Name, SceneError> {
        let Some(written) = self.root.get("name") else {
            return Ok(Name::of_file(Path::new(file)));
        };
        let name = written.as_str().and_then(Name::new);
        name.ok_or_else(|| self.section("").not_allowed("name", written))
    }

    /// The parts that the program of a run added.
    fn program(&self) -> Result<ProgramParts, SceneError> {
        let table = self.table(WRITTEN_BY_RUNS).clone();
        ProgramParts::deserialize(Value::Table(table)).map_err(|error| {
            self.source.refuse(WRITTEN_BY_RUNS, format!("cannot be read: {}", error.message()))
        })
    }

    /// The tables of a list.
    pub fn list(&self, name: &str) -> Result<Vec<&Table>, SceneError> {
        let items = self.root.get(name).and_then(Value::as_array);
        let tables: Vec<&Table> = items.into_iter().flatten().filter_map(Value::as_table).collect();
        match tables.len() {
            n if n > MOST_ENTRIES => Err(self
                .source
                .refuse(name, "is written too often")
                .found(format!("{n} times"))
                .allowed(format!("at most {MOST_ENTRIES} times"))),
            _ => Ok(tables),
        }
    }
}
