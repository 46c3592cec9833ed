//! The folder of a chart: finished points are read back, another chart is refused.

use std::path::{Path, PathBuf};

use lennard_scene::Scene;
use serde::Serialize;

use super::types::{ChartedPoint, Lengths};
use crate::StudyError;
use crate::files::{SCENE_FILE, same_scene};

/// Folder of the stored points.
pub const POINTS: &str = "points";
/// The plan that they belong to.
const PLAN_FILE: &str = "plan.toml";

/// Whether a folder holds points that an earlier chart has stored.
#[must_use]
pub fn has_points(folder: &Path) -> bool {
    std::fs::read_dir(folder.join(POINTS)).is_ok_and(|mut points| points.next().is_some())
}

/// Where points are stored.
pub(super) struct Store {
    folder: PathBuf,
}

impl Store {
    /// Looks whether the folder is free or belongs to this scene, before anything is computed.
    pub(super) fn open(folder: &Path, scene: &Scene, anew: bool) -> Result<Self, StudyError> {
        let store = Self { folder: folder.to_owned() };
        if anew {
            store.clear()?;
        }
        match same_scene(folder, scene) {
            Some(true) if folder.join(PLAN_FILE).exists() => {}
            Some(true) => return Err(store.other("it holds a run of this scene, and no chart")),
            Some(false) => return Err(store.other("it belongs to another scene")),
            None if lennard_io::is_empty_folder(folder) => {}
            None => return Err(store.other("it holds something that is no chart")),
        }
        Ok(store)
    }

    fn other(&self, found: impl Into<String>) -> StudyError {
        let found: String = found.into();
        let reason = format!(
            "{found}\n  allowed: an empty folder, or one that holds this chart; give another --out, or --force to begin anew"
        );
        StudyError::Settings { label: self.folder.display().to_string(), reason }
    }

    /// Removes what a chart has stored, and nothing else.
    fn clear(&self) -> Result<(), StudyError> {
        let gone = |result: std::io::Result<()>| match result {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(self.other(format!("it cannot be cleared: {e}")))
            }
            _ => Ok(()),
        };
        if self.folder.join(PLAN_FILE).exists() {
            gone(std::fs::remove_dir_all(self.folder.join(POINTS)))?;
            gone(std::fs::remove_file(self.folder.join(SCENE_FILE)))?;
            gone(std::fs::remove_file(self.folder.join(PLAN_FILE)))?;
        }
        Ok(())
    }

    /// Notes the scene and the plan; another plan that is there is refused.
    pub(super) fn begin(&self, scene: &Scene, plan: &Lengths) -> Result<(), StudyError> {
        let file = self.folder.join(PLAN_FILE);
        if let Ok(text) = std::fs::read_to_string(&file) {
            let there: Lengths = toml::from_str(&text)
                .map_err(|e| self.other(format!("its {PLAN_FILE} cannot be read: {e}")))?;
            return match differences(&there, plan) {
                None => Ok(()),
                Some(words) => Err(self.other(words)),
            };
        }
        let points = self.folder.join(POINTS);
        std::fs::create_dir_all(&points).map_err(|e| self.other(e.to_string()))?;
        lennard_io::write_text_atomically(&self.folder.join(SCENE_FILE), &scene.resolved_toml())?;
        self.write(&file, plan)
    }

    /// The point as it was stored, if it was, and with the same settings.
    pub(super) fn load(&self, fresh: &ChartedPoint) -> Option<ChartedPoint> {
        let text = std::fs::read_to_string(self.file(fresh.number)).ok()?;
        let stored: ChartedPoint = toml::from_str(&text).ok()?;
        (stored.settings == fresh.settings).then_some(stored)
    }

    /// Stores a point as it is.
    pub(super) fn save(&self, point: &ChartedPoint) -> Result<(), StudyError> {
        self.write(&self.file(point.number), point)
    }

    fn file(&self, number: usize) -> PathBuf {
        self.folder.join(POINTS).join(format!("{number:04}.toml"))
    }

    fn write(&self, file: &Path, value: &impl Serialize) -> Result<(), StudyError> {
        let text = toml::to_string(value)
            .map_err(|e| self.other(format!("{} cannot be written: {e}", file.display())))?;
        Ok(lennard_io::write_text_atomically(file, &text)?)
    }
}

/// What differs between two plans, in words; `None` where nothing does.
fn differences(there: &Lengths, wanted: &Lengths) -> Option<String> {
    if there == wanted {
        return None;
    }
    let words = if there.cpu != wanted.cpu {
        format!("its timings are of another processor ({})", there.cpu)
    } else if there.version != wanted.version {
        format!("it was made by version {}", there.version)
    } else if there.size != wanted.size {
        format!("it is a chart of another size ({:?})", there.size).to_lowercase()
    } else if there.threads != wanted.threads {
        format!("its timings are of {} threads", there.threads)
    } else {
        "it is the chart of another plan".to_owned()
    };
    Some(words)
}

#[cfg(test)]
mod tests {
    use lennard_engine::stopwatch::Spread;

    use super::super::types::{Errors, Size};
    use super::*;
    use crate::lab::{Failed, ForceErrors};
    use crate::settings::Settings;

    fn scene(seed: &str) -> Scene {
        const TEXT: &str = "[system]\nn_atoms = 32\ndensity = 0.8\ntemperature = 1.0\n[truncation]\nr_cut = 1.5\n\
            [[stage]]\nname = \"a\"\nsteps = 10\n";
        Scene::parse(TEXT, "t.toml", &[("system.seed".into(), seed.into())]).unwrap()
    }

    fn plan() -> Lengths {
        let (cpu, version) = ("this one".into(), "1".into());
        Lengths { size: Size::Quick, cpu, version, ..Lengths::default() }
    }

    #[test]
    fn a_point_is_read_back_as_it_was_stored_and_not_for_other_settings() {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene("1");
        let store = Store::open(folder.path(), &scene, false).unwrap();
        store.begin(&scene, &plan()).unwrap();
        let mut point = ChartedPoint::new(1, Settings::of(&scene));
        point.timings.push(crate::lab::Timing {
            seconds_per_atom_tau: 1e-5,
            evaluations_per_tau: 250.0,
            steps: 100,
        });
        point.pair_forces_per_atom_tau = Some(f64::NAN);
        let failed = || Failed { reason: "blew up".into(), step: Some(7) };
        point.errors = Some(Errors {
            forces: ForceErrors { same_model: 1e-7, untruncated: None },
            measured: Err(failed()),
            trajectory: Err(failed()),
            reversibility: Ok(0.5),
        });
        store.save(&point).unwrap();
        let text = std::fs::read_to_string(store.file(1)).unwrap();
        assert!(text.contains("[errors.measured.failed]"), "{text}");
        assert!(text.contains("[errors.reversibility]\nfound = 0.5"), "{text}");
        let back = store.load(&ChartedPoint::new(1, Settings::of(&scene))).unwrap();
        assert_eq!((&back.timings, &back.errors), (&point.timings, &point.errors));
        assert!(back.pair_forces_per_atom_tau.unwrap().is_nan());
        let wall = back.cost().unwrap().wall;
        assert_eq!(wall, Spread::of([1e-5]).unwrap());
        let mut other = Settings::of(&scene);
        other.dt *= 2.0;
        assert!(store.load(&ChartedPoint::new(1, other)).is_none());
    }

    #[test]
    fn folders_of_something_else_are_refused_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let scene_1 = scene("1");
        let says = |result: Result<Store, StudyError>, words: &str| {
            let text = result.err().unwrap().to_string();
            assert!(text.contains(words), "{text}");
        };
        let store = Store::open(folder.path(), &scene_1, false).unwrap();
        store.begin(&scene_1, &plan()).unwrap();
        for (changed, words) in [
            (Lengths { cpu: "that one".into(), ..plan() }, "another processor (this one)"),
            (Lengths { size: Size::Full, ..plan() }, "another size (quick)"),
            (Lengths { version: "2".into(), ..plan() }, "version 1"),
        ] {
            let text = store.begin(&scene_1, &changed).unwrap_err().to_string();
            assert!(text.contains(words), "{text}");
        }
        // Asked to begin anew, it forgets.
        let store = Store::open(folder.path(), &scene("2"), true).unwrap();
        store.begin(&scene("2"), &plan()).unwrap();

        let strange = tempfile::tempdir().unwrap();
        std::fs::write(strange.path().join("letter.txt"), "x").unwrap();
        says(Store::open(strange.path(), &scene_1, true), "no chart");
        std::fs::write(strange.path().join(SCENE_FILE), scene_1.resolved_toml()).unwrap();
        says(Store::open(strange.path(), &scene_1, false), "and no chart");
    }
}
