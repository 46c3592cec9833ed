//! What an earlier study has left in a folder, so that the same command can go on.

use std::path::Path;

use lennard_scene::Scene;

/// Name of the file with the scene that a folder belongs to, every default written out.
pub(crate) const SCENE_FILE: &str = "scene.toml";

/// Whether the folder belongs to this very scene; `None` where it says nothing of a scene.
pub(crate) fn same_scene(folder: &Path, scene: &Scene) -> Option<bool> {
    let file = folder.join(SCENE_FILE);
    file.exists().then(|| Scene::load(&file, &[]).is_ok_and(|there| there == *scene))
}
