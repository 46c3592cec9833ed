//! The lock file: settings that were chosen for the accuracy of a scene, with the scene that they belong to.
//!
//! It keeps what the choice depends on: a lock whose scene has another density, potential or thermostat is
//! refused. Seed, numbers of steps, observables and outputs may change freely.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use lennard_forcefield::{KernelOptions, NeighborOptions, Precision, TruncationOptions};
use lennard_io::{in_shell, shown};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::document::{Document, in_short, join};
use crate::error::SceneError;
use crate::read::Reader;
use crate::tables::stages::IntegratorKeys;
use crate::{Scene, Source, checks, shipped};

/// Name and version of the format.
const SCHEMA: &str = lennard_io::schema!("lock", 1);
/// The most threads that a lock may name.
const MOST_THREADS: i64 = 65_535;

/// Settings that were chosen for a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// How the potential ends.
    pub truncation: TruncationOptions,
    /// Time step, τ.
    pub dt: f64,
    /// Precision of the pair terms.
    pub precision: Precision,
    /// How neighbors are found.
    pub neighbor: NeighborOptions,
    /// Threads that pay on the machine where the choice was made.
    pub threads: usize,
}

/// One quantity of a choice: what was wanted, what a model predicts and what was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// The key of `[accuracy]`.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The largest error that is accepted.
    pub target: f64,
    /// The error that the models predict.
    pub predicted: f64,
    /// Standard error of the prediction.
    pub predicted_error: f64,
    /// The error measured.
    pub measured: f64,
    /// Standard error of the measurement.
    pub measured_error: f64,
}

/// The settings as a lock file writes them: tables of a scene, and the threads.
#[derive(Serialize)]
struct Settings {
    threads: usize,
    truncation: TruncationOptions,
    integrator: IntegratorKeys,
    kernel: Pairs,
    neighbor: NeighborOptions,
}

#[derive(Serialize)]
struct Pairs {
    precision: Precision,
}

impl From<&Chosen> for Settings {
    fn from(chosen: &Chosen) -> Self {
        Self {
            threads: chosen.threads,
            truncation: chosen.truncation,
            integrator: IntegratorKeys { dt: chosen.dt },
            kernel: Pairs { precision: chosen.precision },
            neighbor: chosen.neighbor,
        }
    }
}

impl Chosen {
    /// The settings except for the threads as keys and values of a scene, such as `("truncation.r_cut", "3.1")`.
    ///
    /// # Panics
    /// Where a number does not fit TOML, which none does.
    #[must_use]
    pub fn overrides(&self) -> Vec<(String, String)> {
        let all = Table::try_from(Settings::from(self)).expect("every setting fits TOML");
        let mut overrides = Vec::new();
        for (table, values) in &all {
            for (key, value) in values.as_table().into_iter().flatten() {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                overrides.push((join(table, key), value));
            }
        }
        overrides
    }

    /// Reads the settings of a lock file.
    fn read(settings: &Table, source: &Source) -> Result<Self, SceneError> {
        let reader = Reader::new(settings, source, None);
        for key in ["truncation", "integrator", "kernel", "neighbor"] {
            if let Some(value) = settings.get(key).filter(|value| !value.is_table()) {
                return Err(source
                    .refuse(key, "is not a table")
                    .found(in_short(value))
                    .allowed(format!("a table, `[settings.{key}]`")));
            }
        }
        if !source.wrote("integrator.dt") {
            return Err(source
                .refuse("integrator.dt", "is missing")
                .found("nothing")
                .allowed("a finite number above 0"));
        }
        let threads = settings.get("threads");
        let in_range = |threads: &i64| (1..=MOST_THREADS).contains(threads);
        let Some(n) = threads.and_then(Value::as_integer).filter(in_range) else {
            return Err(source
                .refuse("threads", "is not allowed")
                .found(threads.map_or_else(|| "nothing".to_owned(), in_short))
                .allowed(format!("a whole number from 1 to {MOST_THREADS}")));
        };
        let kernel: KernelOptions = reader.plain("kernel")?;
        let mut step = reader.table("integrator").clone();
        let IntegratorKeys { dt } = reader.section("integrator").shared(&mut step)?;
        Ok(Self {
            truncation: reader.plain("truncation")?,
            dt,
            precision: kernel.precision,
            neighbor: reader.plain("neighbor")?,
            threads: n as usize,
        })
    }
}

/// A lock file that was read.
#[derive(Debug, Clone)]
pub struct Lock {
    chosen: Chosen,
    /// Where the settings were written.
    settings: Source,
    /// Where everything was written.
    source: Source,
    /// Every value of the scene that the lock belongs to, by its full name.
    scene: BTreeMap<String, Value>,
}

impl Lock {
    /// Where the lock file of a scene lies unless it is named: `gas.lock.toml` beside `gas.toml`, and in the present folder for a
    /// shipped scene.
    #[must_use]
    pub fn beside(scene: &Path) -> PathBuf {
        let lock = scene.with_extension("lock.toml");
        match lock.file_name() {
            Some(name) if shipped::is_shipped(scene) => PathBuf::from(name),
            _ => lock,
        }
    }

    /// Reads a lock file.
    ///
    /// # Errors
    /// [`SceneError`] with file, line and key for the first thing that is wrong.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| {
            SceneError::new(&file, "the lock file cannot be read")
                .found(error)
                .allowed("a lock file that `lennard tune` wrote")
        })?;
        Self::parse(&text, &file)
    }

    /// Reads a lock file from its text; `file` stands for its name in messages.
    ///
    /// # Errors
    /// As [`Lock::load`].
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        let document = Document::parse(text, file)?;
        let source = document.source();
        match document.root.get("schema") {
            Some(schema) if schema.as_str() == Some(SCHEMA) => {}
            Some(other) => {
                return Err(source
                    .refuse("schema", "is not one that this version reads")
                    .found(in_short(other))
                    .allowed(format!("{SCHEMA:?}")));
            }
            None => {
                return Err(SceneError::new(file, "this is no lock file")
                    .key("schema")
                    .found("nothing")
                    .allowed(format!("{SCHEMA:?}, as `lennard tune` writes it")));
            }
        }
        let table = |key: &str| {
            document.root.get(key).and_then(Value::as_table).ok_or_else(|| {
                source
                    .refuse(key, "is missing")
                    .found("nothing")
                    .allowed(format!("a table, `[{key}]`"))
            })
        };
        let settings = source.inside("settings");
        let chosen = Chosen::read(table("settings")?, &settings)?;
        let scene = flat(table("scene")?);
        Ok(Self { chosen, settings, source, scene })
    }

    /// The settings in it.
    #[must_use]
    pub fn chosen(&self) -> &Chosen {
        &self.chosen
    }

    /// The scene with the settings of the lock, ready to be run.
    ///
    /// # Errors [`SceneError`] where the scene leaves nothing to a lock, or where the settings do not fit. Also
    /// where the lock belongs to another scene: the error names the key that differs.
    pub fn settle(&self, scene: &Scene) -> Result<Scene, SceneError> {
        if scene.free.is_empty() {
            let message = "there is nothing to take from this lock file";
            return Err(SceneError::new(self.source.file(), message)
                .key("accuracy")
                .found(match scene.accuracy {
                    None => format!("no [accuracy] in {}", scene.source.file()),
                    Some(_) => format!("every setting written in {}", scene.source.file()),
                })
                .allowed("a scene with [accuracy] and settings left out"));
        }
        self.belongs_to(scene)?;
        // What does not fit now was written in the lock.
        let settled = Scene { source: self.settings.clone(), ..scene.applying(&self.chosen) };
        checks::whole_scene(&settled)?;
        Ok(Scene { source: scene.source.clone(), ..settled })
    }

    /// Whether the scene is the one that the settings were chosen for.
    fn belongs_to(&self, scene: &Scene) -> Result<(), SceneError> {
        let now = flat(&identity(scene));
        let mut keys = now.keys().chain(self.scene.keys());
        let Some(key) = keys.find(|key| now.get(*key) != self.scene.get(*key)) else {
            return Ok(());
        };
        let value = |values: &BTreeMap<String, Value>| {
            values.get(key).map_or_else(|| "nothing".to_owned(), in_short)
        };
        let file = scene.source.file();
        let message = "differs from the scene: the lock belongs to another scene";
        let place = self.scene.get(key).and_then(|_| self.source.place(&join("scene", key)));
        Err(SceneError::new(self.source.file(), message)
            .at(place.cloned())
            .key(key)
            .found(format!("{} in the lock, {} in {file}", value(&self.scene), value(&now)))
            .allowed(format!(
                "the scene that the lock was made for, or a new lock: lennard tune {}",
                in_shell(file)
            )))
    }

    /// The text of a lock file. `scene` is the scene before any lock was applied; `processor` names the machine.
    ///
    /// # Panics
    /// Where a number does not fit TOML, which none does.
    #[must_use]
    pub fn text(scene: &Scene, chosen: &Chosen, judged: &[Judged], processor: &str) -> String {
        #[derive(Serialize)]
        struct Written<'a> {
            schema: &'static str,
            version: &'static str,
            processor: &'a str,
            settings: Settings,
            judged: &'a [Judged],
            scene: Table,
        }
        let written = Written {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            processor,
            settings: chosen.into(),
            judged,
            scene: identity(scene),
        };
        let mut text = String::new();
        let file = scene.source.file();
        let _ = writeln!(
            text,
            "# Settings for the accuracy that {} asks for, chosen by `lennard tune {}`.\n\
             # `lennard run` takes them from here, as long as the scene is the one below; seed, numbers of steps,\n\
             # observables and outputs may change.\n",
            shown(file),
            in_shell(file)
        );
        text += &toml::to_string(&written).expect("every value of a lock fits TOML");
        text
    }
}

/// What the choice of settings depends on, of a scene that still leaves them free.
fn identity(scene: &Scene) -> Table {
    let mut all = scene.resolved_table();
    for key in ["name", "observable", "output", "checkpoint"] {
        all.remove(key);
    }
    let mut dropped = vec![("system", "seed"), ("kernel", "isa")];
    let written = |key: &&str| scene.source.wrote(&join("neighbor", key));
    dropped.extend(
        ["mode", "skin"].into_iter().filter(|key| !written(key)).map(|key| ("neighbor", key)),
    );
    for (table, key) in dropped {
        if let Some(Value::Table(table)) = all.get_mut(table) {
            table.remove(key);
        }
    }
    let stages = all.get_mut("stage").and_then(Value::as_array_mut);
    for stage in stages.into_iter().flatten().filter_map(Value::as_table_mut) {
        stage.remove("steps");
    }
    // The folder may move with the scene.
    for (table, key) in [("start", "file"), ("potential", "file")] {
        if let Some(Value::String(path)) = all.get_mut(table).and_then(|table| table.get_mut(key))
            && let Some(name) = Path::new(path.as_str()).file_name()
        {
            *path = name.to_string_lossy().into_owned();
        }
    }
    all
}

/// Every value below a table by its full name.
fn flat(table: &Table) -> BTreeMap<String, Value> {
    fn add(name: String, value: &Value, to: &mut BTreeMap<String, Value>) {
        match value {
            Value::Table(table) => {
                table.iter().for_each(|(key, value)| add(join(&name, key), value, to));
            }
            Value::Array(items) => {
                let items = items.iter().enumerate();
                items.for_each(|(i, item)| add(join(&name, &i.to_string()), item, to));
            }
            _ => drop(to.insert(name, value.clone())),
        }
    }
    let mut values = BTreeMap::new();
    table.iter().for_each(|(key, value)| add(key.clone(), value, &mut values));
    values
}

impl Scene {
    /// The scene with chosen settings in the place of those that it leaves free; what it fixes by hand stays.
    #[must_use]
    pub fn applying(&self, chosen: &Chosen) -> Self {
        let mut scene = self.clone();
        let free = |key: &str| self.free.contains(&key);
        let fixed = |key: &str| self.source.wrote(key);
        let to = &mut scene.truncation;
        if free("truncation.kind") {
            to.kind = chosen.truncation.kind;
            to.switch_from = chosen.truncation.switch_from;
        }
        if free("truncation.r_cut") {
            to.r_cut = chosen.truncation.r_cut;
        }
        if free("truncation.tail_correction") {
            to.tail_correction = chosen.truncation.tail_correction;
        }
        if free("integrator.dt") {
            scene.integrator.dt = chosen.dt;
        }
        if free("kernel.precision") {
            scene.kernel.precision = chosen.precision;
        }
        // The list changes no physics: it is taken wherever the scene says nothing.
        if !fixed("neighbor.mode") {
            scene.neighbor.mode = chosen.neighbor.mode;
        }
        if !fixed("neighbor.skin") {
            scene.neighbor.skin = chosen.neighbor.skin;
        }
        scene.free = Vec::new();
        scene
    }

    /// Reads a scene file as [`Scene::load`] does, with the settings of its lock file where it asks for an accuracy and
    /// there is one. Without one, a scene that leaves settings to be chosen is refused where it would be built.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong with scene or lock.
    pub fn load_settled(
        file: &Path,
        overrides: &[(String, String)],
        lock: Option<&Path>,
    ) -> Result<(Self, Option<UsedLock>), SceneError> {
        let scene = Self::load(file, overrides)?;
        let path = match lock {
            Some(named) => named.to_path_buf(),
            None => {
                let beside = Lock::beside(file);
                if scene.free.is_empty() || !beside.exists() {
                    return Ok((scene, None));
                }
                beside
            }
        };
        let lock = Lock::load(&path)?;
        let threads = lock.chosen().threads;
        Ok((lock.settle(&scene)?, Some(UsedLock { path, threads })))
    }
}

/// A lock file that was used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsedLock {
    /// Where it lies.
    pub path: PathBuf,
    /// Threads that pay, as it says.
    pub threads: usize,
}
