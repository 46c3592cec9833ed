//! Scenes from TOML text and files.

use lennard_engine::text_to_run;
use lennard_scene::{Scene, reference, shipped};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors;

/// Values written over a scene, as `("system.seed", "7")`.
pub type Overrides = Vec<(String, String)>;

/// A scene with every default written out, as TOML.
#[pyfunction]
pub fn resolve(text: &str, name: &str, overrides: Overrides) -> PyResult<String> {
    from_text(text, name, &overrides).map(|scene| text_to_run(&scene))
}

/// A scene from a text, whose lines mean nothing to the user. It may have no stages yet.
pub fn from_text(text: &str, name: &str, overrides: &Overrides) -> PyResult<Scene> {
    let scene = Scene::parse_to_grow(text, name, overrides);
    scene.map_err(|e| errors::of_scene(&e.without_line()))
}

/// The same of a scene file.
#[pyfunction]
pub fn resolve_file(path: std::path::PathBuf, overrides: Overrides) -> PyResult<String> {
    let path = shipped::locate(&path);
    let loaded = Scene::load_settled(&path, &overrides, None);
    let (scene, _) = loaded.map_err(|e| errors::of_scene(&e))?;
    Ok(scene.resolved_toml())
}

/// Every key of a scene with what it may hold, as JSON.
#[pyfunction]
pub fn key_reference() -> String {
    let keys = reference::keys().iter().map(|doc| {
        json!({
            "table": doc.table,
            "method": doc.method,
            "key": doc.key,
            "allowed": doc.allowed.text(),
            "names": match doc.allowed {
                reference::Allowed::Names(names) => names(),
                _ => Vec::new(),
            },
            "default": doc.default,
            "unit": doc.unit,
            "meaning": doc.meaning,
        })
    });
    serde_json::Value::Array(keys.collect()).to_string()
}
