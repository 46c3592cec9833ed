//! A scene with the settings of its lock file.

use std::path::{Path, PathBuf};

use super::Lock;
use crate::{Scene, SceneError};

/// A lock file that was used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsedLock {
    /// Where it lies.
    pub path: PathBuf,
    /// Threads that pay, as it says.
    pub threads: usize,
}

impl Scene {
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
