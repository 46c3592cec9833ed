//! From the text of a scene to a [`Scene`].

use crate::checks;
use crate::scene::model;
use crate::shipped;
use crate::units;
use std::path::Path;

use lennard_forcefield::Kernel;

use crate::document::Document;
use crate::read::{Reader, Resolve};
use crate::tables::accuracy::CHOSEN;
use crate::{Accuracy, MixtureTables, Place, Scene, SceneError, Source};

impl Scene {
    /// Reads a scene file, with overrides such as `("stage.production.steps", "1000")` over it.
    ///
    /// A relative path of a start or a table is taken from the folder of the scene file.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        Self::load_after(path, overrides, |_| {})
    }

    /// Reads a scene file that has settings of its own as a scene that asks for the usual accuracy
    /// ([`Accuracy::USUAL`](crate::Accuracy::USUAL)). The keys that an accuracy chooses are taken out of the file. Keys
    /// among `overrides` stay fixed.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_freed(path: &Path, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        let usual = usual_overrides();
        let all: Vec<_> = usual.iter().chain(overrides).cloned().collect();
        Self::load_after(path, &all, free).map_err(|error| error.not_typed(&usual))
    }

    /// Reads a scene file, with a change to what stands there before overrides are written over it.
    fn load_after(
        path: &Path,
        overrides: &[(String, String)],
        change: fn(&mut Document),
    ) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = shipped::read(path).map_err(|error| {
            SceneError::new(&file, "the scene file cannot be read")
                .found(error)
                .allowed(
                    "the path of a scene file, or the name of a shipped scene, such as fluid/gas",
                )
                .suggestion(shipped::suggestion(path))
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..good].iter().filter(|b| **b == b'\n').count() + 1;
            SceneError::new(&file, "this is not text")
                .at(Some(Place::Line(line)))
                .found("bytes that are not UTF-8")
                .allowed("a TOML file in UTF-8")
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let resolve = |source: &Source, key: &str, written: &Path| {
            let joined = folder.join(written);
            joined.canonicalize().map_err(|error| {
                source
                    .refuse(key, "cannot be read")
                    .found(format!("{} ({error})", joined.display()))
                    .allowed("the path of a file that can be read, relative to the scene file")
            })
        };
        let mut document = Document::parse(&text, &file)?;
        change(&mut document);
        let scene = read(document, &file, overrides, &resolve)?;
        checks::measures(&scene)?;
        Ok(scene)
    }

    /// Reads a scene from its text; `name` stands for the file in messages. Only the table of a potential is read besides.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong.
    pub fn parse(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        let scene = Self::parse_to_grow(text, name, overrides)?;
        checks::measures(&scene)?;
        Ok(scene)
    }

    /// As [`Scene::parse`], for a program that adds stages while it runs: there may be no stage yet, or none that is measured.
    ///
    /// # Errors
    /// As [`Scene::parse`].
    pub fn parse_to_grow(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        read(Document::parse(text, name)?, name, overrides, &|_, _, path| Ok(path.to_owned()))
    }
}

fn read(
    mut document: Document,
    file: &str,
    overrides: &[(String, String)],
    resolve: Resolve<'_>,
) -> Result<Scene, SceneError> {
    document.overlay(overrides)?;
    let units = units::reduce(&mut document)?;
    let source = document.source();
    let reader = Reader::new(&document.root, &source, units);
    reader.known_tables()?;
    let mixture = reader.mixture()?;
    let potential = reader.potential(resolve)?;
    let (truncation, planar_tail) = reader.truncation(mixture.is_some(), &potential)?;
    let system = reader.system(
        resolve,
        mixture.as_ref().and_then(MixtureTables::total_count),
        mixture
            .is_none()
            .then(|| model::of_atoms(&potential, &truncation, truncation.r_cut, planar_tail)),
    )?;
    let name = reader.name(file)?;
    let mut observables = reader.observables()?;
    let mut output = reader.output(mixture.is_some())?;
    reader.one_thermo_interval(&mut observables, &mut output)?;
    let mut scene = Scene {
        name,
        units,
        accuracy: reader.accuracy()?,
        free: Vec::new(),
        potential,
        truncation,
        planar_tail,
        neighbor: reader.plain("neighbor")?,
        kernel: reader.plain("kernel")?,
        integrator: reader.integrator()?,
        walls: Vec::new(),
        contact: reader.contact()?,
        acceleration: reader.field()?,
        stages: reader.stages(system.temperature)?,
        molecule: reader.molecule()?,
        mixture,
        observables,
        output,
        checkpoint: reader.checkpoint()?,
        program: reader.program()?,
        system,
        source: source.clone(),
    };
    scene.walls = reader.walls(scene.end_of_pairs())?;
    scene.free = left_free(&scene);
    checks::whole_scene(&scene)?;
    Ok(scene)
}

/// [`Accuracy::USUAL`], as overrides.
pub(crate) fn usual_overrides() -> Vec<(String, String)> {
    let asked = Accuracy::USUAL.asked().into_iter();
    asked.map(|(key, value, _)| (format!("accuracy.{key}"), value.to_string())).collect()
}

/// Takes out of a scene what an accuracy chooses, and what belongs to that.
pub(crate) fn free(document: &mut Document) {
    let more = ["truncation.switch_from", "neighbor.skin"];
    for key in CHOSEN.into_iter().chain(more) {
        document.remove(key);
    }
}

/// The settings that a scene with an accuracy leaves to be chosen.
pub(crate) fn left_free(scene: &Scene) -> Vec<&'static str> {
    if scene.accuracy.is_none() {
        return Vec::new();
    }
    let wrote = |key: &str| scene.source.wrote(key);
    let own_cutoff = scene.potential.own_end().is_some();
    let cut = scene.truncation.kind.spec().jumps;
    CHOSEN
        .into_iter()
        .filter(|key| {
            !wrote(key)
                && match *key {
                    // Only the plain cutoff has a choice.
                    "truncation.tail_correction" => {
                        !own_cutoff && (cut || !wrote("truncation.kind"))
                    }
                    "truncation.kind" | "truncation.r_cut" => !own_cutoff,
                    "integrator.dt" => {
                        let mut measured = scene.measured_stages().peekable();
                        measured.peek().is_none() || measured.any(|s| s.dt.is_none())
                    }
                    _ => scene.kernel.kernel == Kernel::Auto,
                }
        })
        .collect()
}
