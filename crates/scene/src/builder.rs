//! A scene put together in a program, key by key.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::{Scene, SceneError, shipped};

/// The name of a scene that no file holds.
const NAME: &str = "scene";

/// A scene on its way: a file, a text or nothing, with values written over it.
///
/// It has the keys of a scene file and no defaults of its own. [`SceneBuilder::build`] reads it as a file is read, so that
/// errors are the errors of scene files.
#[derive(Debug, Clone)]
pub struct SceneBuilder {
    base: Base,
    overrides: Vec<(String, String)>,
    lock: Option<PathBuf>,
}

#[derive(Debug, Clone)]
enum Base {
    Text(String),
    File(PathBuf),
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneBuilder {
    /// A scene in which nothing is written yet.
    #[must_use]
    pub fn new() -> Self {
        Self::from_toml("")
    }

    /// The text of a scene file. Relative paths in it are taken from the current folder.
    #[must_use]
    pub fn from_toml(text: impl Into<String>) -> Self {
        Self::over(Base::Text(text.into()))
    }

    /// A scene file, or a scene that comes with the program by its name, such as `verlet-1967/liquid`.
    #[must_use]
    pub fn open(path: impl AsRef<Path>) -> Self {
        Self::over(Base::File(shipped::locate(path.as_ref())))
    }

    fn over(base: Base) -> Self {
        Self { base, overrides: Vec::new(), lock: None }
    }

    /// Writes a value: the key is `system.density`, `stage.production.steps` or `stage.0.steps`.
    ///
    /// Later values stand over earlier ones. A key without the table that it stands in makes the table.
    #[must_use]
    pub fn set(mut self, key: impl Into<String>, value: impl Into<Value>) -> Self {
        self.overrides.push((key.into(), value.into().to_string()));
        self
    }

    /// Writes all stages, in the place of those that are there: one table of keys for each.
    #[must_use]
    pub fn stages(self, stages: impl IntoIterator<Item = Table>) -> Self {
        self.list("stage", stages)
    }

    /// Writes all observables, in the place of those that are there: one table of keys for each.
    #[must_use]
    pub fn observables(self, observables: impl IntoIterator<Item = Table>) -> Self {
        self.list("observable", observables)
    }

    fn list(self, key: &str, tables: impl IntoIterator<Item = Table>) -> Self {
        let tables = tables.into_iter().map(Value::Table);
        self.set(key, tables.collect::<Vec<_>>())
    }

    /// The lock file with the settings of a scene that asks for an accuracy, where it is not beside the scene.
    #[must_use]
    pub fn lock(mut self, path: impl Into<PathBuf>) -> Self {
        self.lock = Some(path.into());
        self
    }

    /// Reads the scene.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn build(&self) -> Result<Scene, SceneError> {
        match &self.base {
            Base::Text(text) => {
                let scene = Scene::parse(text, NAME, &self.overrides)?;
                match &self.lock {
                    Some(lock) => crate::Lock::load(lock)?.settle(&scene),
                    None => Ok(scene),
                }
            }
            Base::File(path) => {
                let loaded = Scene::load_settled(path, &self.overrides, self.lock.as_deref());
                loaded.map(|(scene, _)| scene)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml::toml;

    fn small() -> SceneBuilder {
        SceneBuilder::new()
            .set("system.n_atoms", 108)
            .set("system.density", 0.8)
            .set("system.temperature", 1.5)
            .set("truncation.r_cut", 2.2)
            .stages([
                toml! { name = "melt" steps = 10 thermostat = { kind = "bussi", tau = 0.5 } },
                toml! { name = "production" steps = 20 },
            ])
            .observables([toml! { kind = "rdf" every = 5 }])
    }

    #[test]
    fn keys_one_by_one_make_the_scene_that_their_text_makes() {
        let text = r#"
            [system]
            n_atoms = 108
            density = 0.8
            temperature = 1.5
            [truncation]
            r_cut = 2.2
            [[stage]]
            name = "melt"
            steps = 10
            thermostat = { kind = "bussi", tau = 0.5 }
            [[stage]]
            name = "production"
            steps = 20
            [[observable]]
            kind = "rdf"
            every = 5
        "#;
        let built = small().build().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(built, SceneBuilder::from_toml(text).build().unwrap());
        assert_eq!(built, Scene::parse(text, "scene", &[]).unwrap());
        let longer = small().set("stage.production.steps", 40).build().unwrap();
        assert_eq!(longer.total_steps(), 50);
    }

    #[test]
    fn a_shipped_scene_is_opened_by_its_name() {
        let opened = SceneBuilder::open("verlet-1967/liquid")
            .set("system.n_atoms", 256)
            .set("truncation.r_cut", 2.5);
        let scene = opened.build().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.name, "liquid");
        assert!(matches!(scene.system.start, crate::Arrangement::Lattice { n_atoms: 256, .. }));
    }

    #[test]
    fn errors_are_the_errors_of_a_scene() {
        let refused = |builder: SceneBuilder| builder.build().unwrap_err().to_string();
        let mistyped = refused(small().set("system.densty", 0.7));
        assert!(mistyped.contains("`system.densty` is not a known key"), "{mistyped}");
        assert!(mistyped.contains("nearest: density"), "{mistyped}");
        let kind = refused(small().set("integrator.kind", "velocity-verlt"));
        assert!(kind.contains("nearest: velocity-verlet"), "{kind}");
        let nowhere = refused(SceneBuilder::open("verlet-1967/liqid"));
        assert!(nowhere.contains("nearest: verlet-1967/liquid"), "{nowhere}");
    }

    #[test]
    fn a_lock_settles_a_scene_that_no_file_holds() {
        let missing = small().lock("no-such.lock.toml").build();
        assert!(missing.unwrap_err().to_string().contains("no-such.lock.toml"));
    }
}
