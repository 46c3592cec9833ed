//! The sweep file.

use std::io;
use std::path::{Path, PathBuf};

use lennard_scene::{Name, SceneError, shipped};
use serde::Deserialize;

use super::{Plan, Sweep, points};

/// Why a sweep cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The file cannot be read.
    #[error(
        "{}: cannot be read: {source}\n  allowed: the path of a sweep, or the name of a shipped sweep, such as sweep/isotherm{}",
        file.display(),
        nearest(file)
    )]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file is no sweep.
    #[error("{}: {message}", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// What is wrong and where.
        message: String,
    },
    /// A value is not allowed.
    #[error("{}: `{key}` is not allowed\n  found:   {found}\n  allowed: {allowed}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Which key.
        key: String,
        /// What it says.
        found: String,
        /// What it may say.
        allowed: String,
    },
    /// No point has this number or name.
    #[error("{}: there is no point `{found}`\n  allowed: a number from 0 to {last}, or the name of a point{}", file.display(), nearest_point(nearest.as_ref()))]
    NoPoint {
        /// The file.
        file: PathBuf,
        /// What was asked for.
        found: String,
        /// The number of the last point.
        last: usize,
        /// The name that may be meant.
        nearest: Option<String>,
    },
    /// The scene of a point is wrong.
    #[error("point {point}: {source}")]
    Scene {
        /// Name of the point.
        point: String,
        /// What is wrong.
        source: SceneError,
    },
    /// The start of a point cannot be made.
    #[error("point {point}: {source}")]
    Start {
        /// Name of the point.
        point: String,
        /// What is wrong.
        source: Box<lennard_engine::EngineError>,
    },
    /// A folder of a point holds something else.
    #[error("{}: {found}\n  allowed: an empty folder, or what this sweep wrote there; give another --out, or --force to replace the runs of this sweep", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What it holds.
        found: String,
    },
    /// The folder of a point cannot be claimed.
    #[error(transparent)]
    Claim(#[from] lennard_io::FolderError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] lennard_io::WriteError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] crate::report::ReportError),
}

fn nearest_point(name: Option<&String>) -> String {
    name.map_or_else(String::new, |name| format!("\n  nearest: {name}"))
}

/// A line with the shipped sweep that may be meant.
fn nearest(file: &Path) -> String {
    shipped::suggestion(file).map_or_else(String::new, |name| format!("\n  nearest: {name}"))
}

/// A value or a list of values.
#[derive(Debug, Clone, Deserialize)]
#[serde(
    untagged,
    expecting = "a sweep cannot take this value\n  allowed: one value, or a list of values; counts and seeds are whole numbers from 0"
)]
pub(super) enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

impl<T: Clone> OneOrMany<T> {
    pub(super) fn values(&self) -> Vec<T> {
        match self {
            Self::One(value) => vec![value.clone()],
            Self::Many(values) => values.clone(),
        }
    }
}

/// What can change from point to point.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Axes {
    pub(super) density: Option<OneOrMany<f64>>,
    pub(super) temperature: Option<OneOrMany<f64>>,
    pub(super) n_atoms: Option<OneOrMany<u64>>,
    pub(super) n_molecules: Option<OneOrMany<u64>>,
    pub(super) bond_length: Option<OneOrMany<f64>>,
    pub(super) r_cut: Option<OneOrMany<f64>>,
    pub(super) dt: Option<OneOrMany<f64>>,
    pub(super) seed: Option<OneOrMany<u64>>,
    /// How many times as many measured steps as the base scene.
    pub(super) longer: Option<OneOrMany<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    base: PathBuf,
    #[serde(default)]
    set: toml::Table,
    #[serde(default)]
    point: Vec<Axes>,
    grid: Option<Axes>,
}

/// Reads a sweep file with overrides for every point, and checks the scene of each.
///
/// # Errors
/// [`SweepError`] where the file or the scene of a point is wrong.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Sweep, SweepError> {
    plan(path, overrides)?.sweep()
}

/// Reads a sweep file with overrides for every point, and no scene.
///
/// # Errors
/// [`SweepError`] where the file is wrong.
pub fn plan(path: &Path, overrides: &[(String, String)]) -> Result<Plan, SweepError> {
    let text = shipped::read(path)
        .and_then(|bytes| {
            String::from_utf8(bytes).map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))
        })
        .map_err(|source| SweepError::Unreadable { file: path.to_owned(), source })?;
    let malformed = |message: String| SweepError::Malformed { file: path.to_owned(), message };
    let file: File = toml::from_str(&text).map_err(|e| {
        let is_scene =
            |table: &toml::Table| table.contains_key("system") && !table.contains_key("base");
        malformed(match toml::from_str(&text).is_ok_and(|table| is_scene(&table)) {
            true => "this is a scene and no sweep\n  found:   `[system]`, and no `base`\n  allowed: `lennard run` for this file, or a sweep, which names a scene as `base`".to_owned(),
            false => in_words(e.to_string().trim_end()),
        })
    })?;
    let name = match file.name {
        None => Name::of_file(path),
        Some(name) => Name::new(&*name).ok_or_else(|| SweepError::Value {
            file: path.to_owned(),
            key: "name".into(),
            found: format!("{name:?}"),
            allowed: Name::ALLOWED.into(),
        })?,
    };
    let base = shipped::beside(path, &file.base);
    let mut common: Vec<(String, String)> = Vec::new();
    flatten(&file.set, "", &mut common);
    common.extend(overrides.iter().cloned());
    let points = points::expand(path, &file.point, file.grid.as_ref())?;
    Ok(Plan { name, file: path.to_owned(), base, common, points })
}

/// What is wrong with the file, without the words of the reader for an integer that no key can hold.
fn in_words(message: &str) -> String {
    let beyond = |line: &str| {
        let (integer, _) = line.strip_prefix("invalid type: integer `")?.split_once("` as ")?;
        Some(format!(
            "{integer} is an integer beyond 64 bits\n  allowed: whole numbers from −2^63 to 2^63 − 1"
        ))
    };
    let lines = message.lines().map(|line| beyond(line).unwrap_or_else(|| line.to_owned()));
    lines.collect::<Vec<_>>().join("\n")
}

/// Tables inside `[set]` and dotted keys in quotes mean the same.
fn flatten(table: &toml::Table, prefix: &str, into: &mut Vec<(String, String)>) {
    for (key, value) in table {
        let key = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            toml::Value::Table(inner) => flatten(inner, &key, into),
            other => into.push((key, other.to_string())),
        }
    }
}
