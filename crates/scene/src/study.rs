//! The file of a study: a scene, and what changes from point to point.
//!
//! ```toml
//! base = "../verlet-1967/state-point.toml"          # the scene
//! reading = "table"                                 # what is read from the points
//! [set]                                             # keys of every point
//! "system.n_atoms" = 500
//! [[point]]                                         # a point, or the product of its lists
//! density = 0.8
//! [zip]                                             # lists of one length: the first values together, then the second ones
//! "truncation.kind" = ["cut", "shift"]
//! "truncation.tail_correction" = [true, false]
//! [grid]                                            # the product of lists
//! dt = [0.002, 0.004]
//! "stage.production.steps" = { times = [1, 2] }     # multiples of the value that the scene has
//! ```
//!
//! The points are `[[point]]` × `[zip]` × `[grid]`. A key is a [short name](SHORT_KEYS), or any key that `--set` takes.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::document::{Document, as_heading, in_short, join};
use crate::error::{Place, SceneError, Source};
use crate::names::nearest;
use crate::{Name, Scene, reference, shipped};

/// A short name for a key of the scene, and how tables and figures call it.
#[derive(Debug, PartialEq, Eq)]
pub struct ShortKey {
    /// The name in a study.
    pub name: &'static str,
    /// The key of the scene; `None` where no scene has it.
    pub key: Option<&'static str>,
    /// What stands before the value in the name of a point; empty for what is no part of a name.
    pub prefix: &'static str,
    /// The label of an axis.
    pub label: &'static str,
    /// The symbol in a legend.
    pub symbol: &'static str,
}

/// The name of the seed, which makes independent runs of one state.
pub const SEED: &str = "seed";
/// How many times as many measured steps as the base scene a point has.
pub const LONGER: &str = "longer";

const fn short(
    name: &'static str,
    key: &'static str,
    prefix: &'static str,
    label: &'static str,
    symbol: &'static str,
) -> ShortKey {
    ShortKey { name, key: Some(key), prefix, label, symbol }
}

/// Every short name, in the order in which values stand in the name of a point. Keys without a short name stand before `r_cut`.
pub const SHORT_KEYS: [ShortKey; 9] = [
    short("density", "system.density", "rho", "density ρ / σ⁻³", "ρ"),
    short("temperature", "system.temperature", "T", "T / (ε/k_B)", "T"),
    short("n_atoms", "system.n_atoms", "N", "number of particles N", "N"),
    short("n_molecules", "system.n_molecules", "M", "number of molecules M", "M"),
    short("bond_length", "molecule.bond_length", "L", "bond length L / σ", "L"),
    short("r_cut", "truncation.r_cut", "rc", "cutoff r_cut / σ", "r_cut"),
    short("dt", "integrator.dt", "dt", "time step dt / τ", "dt"),
    short(SEED, "system.seed", "seed", "seed", "seed"),
    ShortKey { name: LONGER, key: None, prefix: "", label: "times as long", symbol: LONGER },
];
/// How a key ends whose values multiply the value of the scene.
const TIMES: &str = ".times";
/// Keys without a short name stand before this one.
const AFTER_OTHERS: &str = "r_cut";

/// The keys of a study file.
pub(crate) const KEYS: [&str; 7] = ["name", "base", "reading", "set", "point", "zip", "grid"];

/// A value of an axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxisValue {
    /// The value as `--set` takes it.
    pub text: String,
    /// The value in a name or a table.
    pub words: String,
}

/// A key that changes from point to point, with its values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// A short name, or a key of the scene.
    pub key: String,
    /// Where it stands in the file: `grid.density`.
    pub path: String,
    /// Its values.
    pub values: Vec<AxisValue>,
    /// Whether its values multiply the value of the scene: `{ times = [0.5, 2.0] }`.
    pub times: bool,
}

impl Axis {
    /// Its short name, where it has one.
    #[must_use]
    pub fn short(&self) -> Option<&'static ShortKey> {
        SHORT_KEYS.iter().find(|short| short.name == self.key)
    }

    /// The key of the scene; `None` where no scene has it.
    #[must_use]
    pub fn scene_key(&self) -> Option<&str> {
        self.short().map_or(Some(&*self.key), |short| short.key)
    }

    /// Its place in the name of a point.
    #[must_use]
    pub fn rank(&self) -> usize {
        let place = |name: &str| SHORT_KEYS.iter().position(|short| short.name == name);
        let others = place(AFTER_OTHERS).unwrap_or_default();
        place(&self.key).map_or(2 * others, |place| 2 * place + 1)
    }
}

/// A table of axes: a `[[point]]`, the `[zip]` or the `[grid]`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AxisTable {
    /// What its rows are called, in place of their values; empty where nothing is given.
    pub names: Vec<String>,
    /// Its axes, in the order of a name.
    pub axes: Vec<Axis>,
}

/// A study file, read.
#[derive(Debug, Clone)]
pub struct StudyFile {
    /// Name of the study: the file's stem unless the file gives another.
    pub name: Name,
    /// The file of its base scene.
    pub base: PathBuf,
    /// What is read from the points; empty where the file does not say it.
    pub readings: Vec<String>,
    /// Keys of all points, with their values as `--set` takes them.
    pub set: Vec<(String, String)>,
    /// The `[[point]]` tables.
    pub points: Vec<AxisTable>,
    /// The `[zip]` table.
    pub zip: Option<AxisTable>,
    /// The `[grid]` table.
    pub grid: Option<AxisTable>,
    /// Where each key was written.
    pub source: Source,
}

impl StudyFile {
    /// Reads a study file.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = shipped::read(path).map_err(|error| {
            let allowed =
                "the path of a sweep, or the name of a shipped sweep, such as sweep/isotherm";
            SceneError::new(&file, format!("cannot be read: {error}"))
                .allowed(allowed)
                .suggestion(shipped::suggestion(path))
        })?;
        let text = String::from_utf8(bytes).map_err(|_| {
            SceneError::new(&file, "this is not text")
                .found("bytes that are not UTF-8")
                .allowed("a TOML file in UTF-8")
        })?;
        let document = Document::parse(&text, &file)?;
        Reader { source: document.source(), root: document.root }.read(path)
    }

    /// Whether a key takes multiples of the value that the scene has.
    #[must_use]
    pub fn has_multiples(&self) -> bool {
        let tables = self.points.iter().chain(&self.zip).chain(&self.grid);
        tables.flat_map(|table| &table.axes).any(|axis| axis.times)
    }

    /// Puts the multiples of the values that a scene has in the place of their factors.
    ///
    /// # Errors
    /// [`SceneError`] where a factor is no number above 0, or multiplies what is no number.
    pub fn multiply(&mut self, scene: &Scene) -> Result<(), SceneError> {
        let resolved = scene.resolved_table();
        let tables = self.points.iter_mut().chain(&mut self.zip).chain(&mut self.grid);
        for axis in tables.flat_map(|table| &mut table.axes).filter(|axis| axis.times) {
            let refuse =
                |message: &str, found: &str| self.source.refuse(&axis.path, message).found(found);
            let key = axis.scene_key().unwrap_or_default().to_owned();
            let (table, name) = key.rsplit_once('.').unwrap_or(("", &key));
            let own = resolved.get(table).and_then(|table| table.get(name));
            let Some(own) =
                own.and_then(|own| own.as_float().or(own.as_integer().map(|n| n as f64)))
            else {
                return Err(refuse("multiplies what is no number", &format!("`{key}`"))
                    .allowed("a key of a table of the scene that holds a number, such as `dt`"));
            };
            for value in &mut axis.values {
                let factor = value.text.parse().ok().filter(|factor: &f64| *factor > 0.0);
                let Some(factor) = factor else {
                    return Err(refuse("is not allowed", &value.text).allowed("numbers above 0"));
                };
                value.text = format!("{:?}", own * factor);
                value.words = (own * factor).to_string();
            }
        }
        Ok(())
    }

    /// The trouble of a scene at the place of the study that caused it. That is `[set]`, or one of the values of the point.
    /// `None` where the trouble does not come from the study.
    #[must_use]
    pub fn trace<'a>(
        &self,
        error: &SceneError,
        mut chosen: impl Iterator<Item = (&'a Axis, &'a AxisValue)>,
    ) -> Option<SceneError> {
        let override_text = error.overridden_by()?;
        let is_it = |key: &str, value: &str| format!("{key}={value}") == override_text;
        let of_axis = chosen.find_map(|(axis, value)| {
            let key = axis.scene_key()?;
            is_it(key, &value.text).then(|| (axis.path.clone(), key.to_owned()))
        });
        let of_set = || {
            let (key, _) = self.set.iter().find(|(key, value)| is_it(key, value))?;
            Some((format!("set.{key}"), key.clone()))
        };
        let (path, key) = of_axis.or_else(of_set)?;
        Some(error.clone().traced(&self.source, &path, &key))
    }
}

struct Reader {
    root: Table,
    source: Source,
}

impl Reader {
    fn read(&self, path: &Path) -> Result<StudyFile, SceneError> {
        let has = |key: &str| self.root.get(key).is_some();
        if has("system") && !has("base") {
            return Err(self
                .source
                .without_key("this is a scene and no sweep")
                .found("`[system]`, and no `base`")
                .allowed(
                    "`lennard run` for this file, or a sweep, which names a scene as `base`",
                ));
        }
        if let Some(key) = self.root.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(self.unknown(key, key, &KEYS));
        }
        let Some(base) = self.root.get("base") else {
            return Err(self
                .source
                .without_key("no scene is named")
                .found("no `base`")
                .allowed("`base = \"path/of/a/scene.toml\"`, or the name of a shipped scene"));
        };
        let base = self.text("base", base)?;
        let name = match self.root.get("name") {
            None => Name::of_file(path),
            Some(node) => self.name("name", node)?,
        };
        let readings = match self.root.get("reading") {
            None => Vec::new(),
            Some(Value::Array(items)) => self.texts("reading", items)?,
            Some(value) => vec![self.text("reading", value)?],
        };
        let mut set = Vec::new();
        if let Some(table) = self.table("set")? {
            flatten(table, "", &mut |key, value| set.push((key, value.to_string())));
            set.sort_by_key(|(key, _)| self.source.locate(&format!("set.{key}")));
        }
        Ok(StudyFile {
            name,
            base: shipped::beside(path, Path::new(&base)),
            readings,
            set,
            points: self.points()?,
            zip: self.table("zip")?.map(|table| self.zip(table)).transpose()?,
            grid: self.table("grid")?.map(|table| self.axes(table, "grid")).transpose()?,
            source: self.source.clone(),
        })
    }

    fn points(&self) -> Result<Vec<AxisTable>, SceneError> {
        let Some(value) = self.root.get("point") else {
            return Ok(Vec::new());
        };
        let tables = match value {
            Value::Array(items) => items.iter().map(Value::as_table).collect::<Option<Vec<_>>>(),
            _ => None,
        };
        let tables = tables.ok_or_else(|| self.no_table("point", value, "`[[point]]`"))?;
        let numbered = tables.into_iter().enumerate();
        numbered.map(|(i, table)| self.axes(table, &format!("point.{i}"))).collect()
    }

    fn table(&self, key: &str) -> Result<Option<&Table>, SceneError> {
        let Some(value) = self.root.get(key) else {
            return Ok(None);
        };
        let refused = || self.no_table(key, value, &format!("a table, `[{key}]`"));
        value.as_table().map(Some).ok_or_else(refused)
    }

    /// The lists of `[zip]`, which have one length.
    fn zip(&self, table: &Table) -> Result<AxisTable, SceneError> {
        let zip = self.axes(table, "zip")?;
        let Some(first) = zip.axes.first() else {
            return Ok(zip);
        };
        let length = first.values.len();
        let mut lengths = zip.axes.iter().map(|axis| (axis.path.as_str(), axis.values.len()));
        let names = (!zip.names.is_empty()).then_some(("zip.name", zip.names.len()));
        match lengths.by_ref().chain(names).find(|(_, n)| *n != length) {
            None => Ok(zip),
            Some((path, n)) => Err(self
                .source
                .refuse(path, "has another length than the lists beside it")
                .found(format!("{n} values, and {length} of `{}`", first.key))
                .allowed("lists of one length: `[zip]` takes the first value of each, then the second; `[grid]` multiplies lists")),
        }
    }

    fn axes(&self, table: &Table, at: &str) -> Result<AxisTable, SceneError> {
        let mut written: Vec<(String, &Value)> = Vec::new();
        flatten(table, "", &mut |key, value| written.push((key, value)));
        written.sort_by_key(|(key, _)| self.source.locate(&join(at, key)));
        let mut read = AxisTable::default();
        for (written_key, value) in written {
            let path = join(at, &written_key);
            let (written_key, times) = match written_key.strip_suffix(TIMES) {
                Some(key) => (key.to_owned(), true),
                None => (written_key, false),
            };
            let items = match value {
                Value::Array(items) => items.as_slice(),
                _ => std::slice::from_ref(value),
            };
            if written_key == "name" && at != "grid" {
                let names = items.iter().map(|item| self.name(&path, item));
                read.names = names.map(|name| Ok(name?.to_string())).collect::<Result<_, _>>()?;
                continue;
            }
            let by_name = |s: &&ShortKey| s.name == written_key || s.key == Some(&*written_key);
            let key = match SHORT_KEYS.iter().find(by_name) {
                Some(short) => short.name.to_owned(),
                None if is_in_number(&written_key) => {
                    let found = written_key.rsplit('.').next().unwrap_or_default();
                    let refused = self.source.refuse(&path, "is not a known key");
                    return Err(refused
                        .found(format!("`{found}`"))
                        .allowed("`times`, or a list of values"));
                }
                None if written_key.contains('.') || reference::table(&written_key).is_some() => {
                    written_key
                }
                None => {
                    let known: Vec<&str> = SHORT_KEYS.iter().map(|short| short.name).collect();
                    return Err(self.unknown(&path, &written_key, &known));
                }
            };
            if let Some(first) = read.axes.iter().find(|axis| axis.key == key) {
                return Err(self.source.twice(&path, &key, &first.path));
            }
            let values = items.iter().map(AxisValue::of).collect();
            read.axes.push(Axis { key, path, values, times });
        }
        read.axes.sort_by_key(Axis::rank);
        Ok(read)
    }

    fn unknown(&self, path: &str, key: &str, known: &[&str]) -> SceneError {
        let tables = reference::tables().iter().map(|doc| doc.table);
        let is_axis = path != key;
        let others = match is_axis {
            true => ", or a key of the scene as `--set` takes it, such as \"truncation.kind\"",
            false => "",
        };
        let names = known.iter().copied().chain(tables.filter(|_| is_axis));
        self.source
            .refuse(path, "is not a known key")
            .found(format!("`{key}`"))
            .allowed(format!("{}{others}", known.join(", ")))
            .suggestion(nearest(key, names))
    }

    fn no_table(&self, key: &str, value: &Value, allowed: &str) -> SceneError {
        let refused = self.source.refuse(key, "is written the wrong way");
        refused.found(as_heading(key, value)).allowed(allowed)
    }

    fn texts(&self, key: &str, items: &[Value]) -> Result<Vec<String>, SceneError> {
        items.iter().map(|item| self.text(key, item)).collect()
    }

    fn text(&self, key: &str, value: &Value) -> Result<String, SceneError> {
        let text = value.as_str().map(str::to_owned);
        text.ok_or_else(|| self.source.invalid(key, in_short(value), "a text, such as \"table\""))
    }

    fn name(&self, key: &str, value: &Value) -> Result<Name, SceneError> {
        let name = value.as_str().and_then(Name::new);
        let refused = || self.source.refuse(key, "is not allowed").found(in_short(value));
        name.ok_or_else(|| refused().allowed(Name::ALLOWED))
    }
}

/// Whether a key stands inside a key that holds a number.
fn is_in_number(key: &str) -> bool {
    let holds = |of: &str| SHORT_KEYS.iter().any(|s| s.name == of || s.key == Some(of));
    key.rsplit_once('.').is_some_and(|(of, _)| holds(of))
}

impl AxisValue {
    fn of(value: &Value) -> Self {
        Self { text: value.to_string(), words: in_words(value) }
    }
}

/// Gives each key below a table to `take`: tables inside and dotted keys in quotes mean the same.
fn flatten<'a>(table: &'a Table, prefix: &str, take: &mut dyn FnMut(String, &'a Value)) {
    for (key, value) in table {
        let key = join(prefix, key);
        match value {
            Value::Table(inner) => flatten(inner, &key, take),
            _ => take(key, value),
        }
    }
}

/// The value in the name of a point: texts as they are, and the entries of a table one after the other.
fn in_words(value: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join("-");
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        Value::Array(items) => joined(items.iter().map(in_words).collect()),
        Value::Table(table) => joined(
            table
                .iter()
                .map(|(key, value)| match value {
                    Value::String(text) => text.clone(),
                    value => format!("{key}{}", in_words(value)),
                })
                .collect(),
        ),
        _ => value.to_string(),
    }
}

impl SceneError {
    /// The same trouble at the place in `source` that wrote the key `from` of the scene as `path`.
    fn traced(mut self, source: &Source, path: &str, from: &str) -> Self {
        let place: Option<Place> = source.place(path).cloned();
        if self.key_path() == Some(from) {
            self = self.key(path);
        }
        self.moved(source.file(), place)
    }
}
