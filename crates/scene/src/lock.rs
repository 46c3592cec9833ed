//! The lock file: settings that were chosen for the accuracy of a scene, with the scene that they belong to.
//!
//! It keeps what the choice depends on: a lock whose scene has another density, potential or thermostat is
//! refused. Seed, numbers of steps, observables and outputs may change freely.

mod text;
mod used;

pub use used::UsedLock;

use std::path::{Path, PathBuf};

use lennard_forcefield::{NeighborOptions, Precision, TruncationOptions};
use lennard_io::in_shell;
use serde::{Deserialize, Serialize};

use crate::error::{Place, SceneError};
use crate::integrator::IntegratorKeys;
use crate::read::Reader;
use crate::tree::{self, Node, Table, Value};
use crate::{Scene, Source, checks, shipped};
use text::{Pairs, identity};

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

/// A lock file that was read.
#[derive(Debug, Clone)]
pub struct Lock {
    file: String,
    chosen: Chosen,
    source: Source,
    scene: Vec<(String, Node)>,
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
        let root = tree::parse(text, file)?;
        let whole = Source::new(file, tree::places(&root));
        match root.get("schema") {
            Some(node) if node.text() == Some(SCHEMA) => {}
            Some(node) => {
                return Err(whole
                    .refuse("schema", "is not one that this version reads")
                    .found(node)
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
            root.get(key).and_then(Node::table).ok_or_else(|| {
                whole
                    .refuse(key, "is missing")
                    .found("nothing")
                    .allowed(format!("a table, `[{key}]`"))
            })
        };
        let settings = table("settings")?;
        let source = Source::new(file, tree::places(settings));
        let chosen = read_settings(settings, &source)?;
        let mut scene = Vec::new();
        flatten("", &Value::Table(table("scene")?.clone()), &mut scene);
        Ok(Self { file: file.to_owned(), chosen, source, scene })
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
            return Err(SceneError::new(
                &self.file,
                "there is nothing to take from this lock file",
            )
            .key("accuracy")
            .found(match scene.accuracy {
                None => format!("no [accuracy] in {}", scene.source.file()),
                Some(_) => format!("every setting written in {}", scene.source.file()),
            })
            .allowed("a scene with [accuracy] and settings left out"));
        }
        self.belongs_to(scene)?;
        let mut settled = scene.applying(&self.chosen);
        // What does not fit now was written in the lock.
        settled.source = self.source.clone();
        checks::whole_scene(&settled)?;
        settled.source = scene.source.clone();
        Ok(settled)
    }

    /// Whether the scene is the one that the settings were chosen for.
    fn belongs_to(&self, scene: &Scene) -> Result<(), SceneError> {
        let mut now = Vec::new();
        let text = toml::to_string(&identity(scene)).unwrap_or_default();
        flatten("", &Value::Table(tree::parse(&text, &self.file)?), &mut now);
        let file = scene.source.file();
        let value = |list: &[(String, Node)], key: &str| {
            let found = list.iter().find(|(k, _)| k == key);
            found.map_or_else(|| "nothing".to_owned(), |(_, node)| node.to_string())
        };
        let same = |key: &str| {
            let find = |list: &[(String, Node)]| {
                let found = list.iter().find(|(k, _)| k == key);
                found.map(|(_, node)| node.value.clone())
            };
            find(&now) == find(&self.scene)
        };
        let mut keys = now.iter().chain(&self.scene).map(|(key, _)| key);
        let Some(key) = keys.find(|key| !same(key)) else {
            return Ok(());
        };
        let node = self.scene.iter().find(|(k, _)| k == key);
        Err(SceneError::new(
            &self.file,
            "differs from the scene: the lock belongs to another scene",
        )
        .at(node.map(|(_, node)| node.place.clone()))
        .key(key)
        .found(format!("{} in the lock, {} in {file}", value(&self.scene, key), value(&now, key)))
        .allowed(format!(
            "the scene that the lock was made for, or a new lock: lennard tune {}",
            in_shell(file)
        )))
    }
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
}

fn read_settings(settings: &Table, source: &Source) -> Result<Chosen, SceneError> {
    let reader = Reader::new(settings, source);
    if !source.wrote("integrator.dt") {
        return Err(source
            .refuse("integrator.dt", "is missing")
            .found("nothing")
            .allowed("a finite number above 0"));
    }
    let threads = match settings.get("threads").map(|node| &node.value) {
        Some(Value::Whole(threads)) if (1..=MOST_THREADS).contains(threads) => *threads as usize,
        found => {
            let found = found.and_then(|_| settings.get("threads"));
            return Err(source
                .refuse("threads", "is not allowed")
                .found(found.map_or_else(|| "nothing".to_owned(), Node::to_string))
                .allowed(format!("a whole number from 1 to {MOST_THREADS}")));
        }
    };
    let pairs: Pairs = reader.plain("kernel")?;
    let mut step = reader.node("integrator").clone();
    let IntegratorKeys { dt } = reader.section("integrator").take(&mut step)?;
    Ok(Chosen {
        truncation: reader.plain("truncation")?,
        dt,
        precision: pairs.precision,
        neighbor: reader.plain("neighbor")?,
        threads,
    })
}

/// Every value below a table with its full name.
fn flatten(prefix: &str, value: &Value, out: &mut Vec<(String, Node)>) {
    let join = |key: &str| match prefix {
        "" => key.to_owned(),
        prefix => format!("{prefix}.{key}"),
    };
    let mut add = |name: String, node: &Node| match &node.value {
        inner @ (Value::Table(_) | Value::Array(_)) => flatten(&name, inner, out),
        _ => out.push((name, node.clone())),
    };
    match value {
        Value::Table(table) => {
            for entry in &table.0 {
                let mut node = entry.node.clone();
                if !matches!(node.value, Value::Table(_) | Value::Array(_)) {
                    node.place = entry.place.clone();
                }
                add(join(&entry.key), &node);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                add(join(&i.to_string()), item);
            }
        }
        _ => {
            let place = Place::Line(1);
            out.push((prefix.to_owned(), Node { value: value.clone(), place }));
        }
    }
}
