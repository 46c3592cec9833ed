//! How a lock file is written, and what of a scene it holds.

use std::fmt::Write as _;
use std::path::Path;

use lennard_forcefield::{NeighborOptions, Precision, TruncationOptions};
use lennard_io::{in_shell, shown};
use serde::{Deserialize, Serialize};

use super::{Chosen, Judged, Lock, SCHEMA};
use crate::Scene;
use crate::integrator::IntegratorKeys;

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    version: &'static str,
    processor: &'a str,
    settings: Settings,
    judged: &'a [Judged],
    scene: toml::Table,
}

#[derive(Serialize)]
struct Settings {
    threads: usize,
    truncation: TruncationOptions,
    integrator: IntegratorKeys,
    kernel: Pairs,
    neighbor: NeighborOptions,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Pairs {
    pub precision: Precision,
}

impl Settings {
    fn of(chosen: &Chosen) -> Self {
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
        let all = toml::Table::try_from(Settings::of(self)).expect("every setting fits TOML");
        let mut found = Vec::new();
        for (table, values) in &all {
            for (key, value) in values.as_table().into_iter().flatten() {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                found.push((format!("{table}.{key}"), value));
            }
        }
        found
    }
}

impl Lock {
    /// The text of a lock file. `scene` is the scene before any lock was applied; `processor` names the machine.
    ///
    /// # Panics
    /// Where a number does not fit TOML, which none does.
    #[must_use]
    pub fn text(scene: &Scene, chosen: &Chosen, judged: &[Judged], processor: &str) -> String {
        let document = Document {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            processor,
            settings: Settings::of(chosen),
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
        text += &toml::to_string(&document).expect("every value of a lock fits TOML");
        text
    }
}

/// What the choice of settings depends on, of a scene that still leaves them free.
pub(super) fn identity(scene: &Scene) -> toml::Table {
    let mut all = scene.resolved_table();
    for key in ["name", "observable", "output", "checkpoint"] {
        all.remove(key);
    }
    let mut drop = |table: &str, key: &str| {
        if let Some(toml::Value::Table(table)) = all.get_mut(table) {
            table.remove(key);
        }
    };
    drop("system", "seed");
    drop("kernel", "isa");
    for key in ["mode", "skin"] {
        if !scene.source.wrote(&format!("neighbor.{key}")) {
            drop("neighbor", key);
        }
    }
    if let Some(toml::Value::Array(stages)) = all.get_mut("stage") {
        for stage in stages.iter_mut().filter_map(toml::Value::as_table_mut) {
            stage.remove("steps");
        }
    }
    // The folder may move with the scene.
    for (table, key) in [("system", "configuration"), ("potential", "file")] {
        if let Some(toml::Value::Table(table)) = all.get_mut(table)
            && let Some(toml::Value::String(path)) = table.get_mut(key)
            && let Some(name) = Path::new(path.as_str()).file_name()
        {
            *path = name.to_string_lossy().into_owned();
        }
    }
    all
}
