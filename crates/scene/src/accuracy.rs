//! The table `[accuracy]`: how wrong U, P and the conserved energy may be, in place of settings.

use lennard_core::options::Options;
use lennard_forcefield::Kernel;
use lennard_io::in_shell;

use crate::Scene;
use crate::document::Document;
use crate::error::SceneError;
use crate::read::Reader;

lennard_core::options! {
    /// The largest errors that are accepted; what is not named is not asked for.
    ///
    /// U and P of the full potential are wanted where the scene leaves the truncation free. Where it writes
    /// both `truncation.kind` and `truncation.r_cut`, U and P of its own model are wanted.
    #[derive(Copy)]
    pub struct Accuracy {
        /// Largest error of the mean potential energy, at equal temperature: of the full potential, or, where `truncation.kind` and `truncation.r_cut` are both written, of that model.
        potential_energy: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε per particle";
        /// Largest error of the mean pressure, likewise.
        pressure: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε/σ³";
        /// Largest drift of the conserved energy.
        drift: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε/τ per particle";
    }
}

impl Accuracy {
    /// What is asked of a scene that asks for nothing: U to 1e-3 ε, P to 5e-3 ε/σ³, drift to 1e-5 ε/τ.
    pub const USUAL: Self =
        Self { potential_energy: Some(1e-3), pressure: Some(5e-3), drift: Some(1e-5) };

    /// The errors asked for with their keys and units.
    #[must_use]
    pub fn asked(&self) -> Vec<(&'static str, f64, &'static str)> {
        let Self { potential_energy, pressure, drift } = *self;
        let declared = Self::KEYS.iter().zip([potential_energy, pressure, drift]);
        declared.filter_map(|(key, value)| Some((key.key, value?, key.unit))).collect()
    }
}

/// Settings that are chosen for an accuracy where they are not written, and without which no step can be made.
pub(crate) const CHOSEN: [&str; 5] = [
    "truncation.kind",
    "truncation.r_cut",
    "truncation.tail_correction",
    "integrator.dt",
    "kernel.precision",
];

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

impl Reader<'_> {
    /// The table, where there is one.
    pub fn accuracy(&self) -> Result<Option<Accuracy>, SceneError> {
        if !self.source.wrote("accuracy") {
            return Ok(None);
        }
        let accuracy: Accuracy = self.plain("accuracy")?;
        if accuracy.asked().is_empty() {
            let keys: Vec<&str> = Accuracy::KEYS.iter().map(|key| key.key).collect();
            return Err(self
                .source
                .refuse("accuracy", "asks for nothing")
                .found("an empty table")
                .allowed(format!("at least one of {}", keys.join(", "))));
        }
        Ok(Some(accuracy))
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
                    "integrator.dt" => scene.stages.iter().any(|s| s.measure && s.dt.is_none()),
                    _ => scene.kernel.kernel == Kernel::Auto,
                }
        })
        .collect()
}

impl Scene {
    /// Whether every setting is there, so that the scene can be run.
    ///
    /// # Errors
    /// [`SceneError`] where an accuracy leaves settings to be chosen and no lock file has brought them.
    pub fn settled(&self) -> Result<(), SceneError> {
        if self.free.is_empty() {
            return Ok(());
        }
        Err(self
            .source
            .refuse("accuracy", "needs settings that have not been chosen yet")
            .found(format!("no value for {}", self.free.join(", ")))
            .allowed(format!(
                "a lock file with them, which `lennard tune {}` writes, or values written by hand",
                in_shell(self.source.file())
            )))
    }

    /// Whether U and P of the potential without any cutoff are wanted. This is so unless the scene fixes
    /// both kind and cutoff radius of the truncation, or the potential ends by itself.
    #[must_use]
    pub fn wants_full_potential(&self) -> bool {
        let wrote = |key| self.source.wrote(key);
        let fixed = wrote("truncation.kind") && wrote("truncation.r_cut");
        !(fixed || self.potential.own_end().is_some())
    }

    /// The scene with every free setting at its present value, as a study that tries settings needs it.
    #[must_use]
    pub fn without_accuracy(&self) -> Self {
        Self { accuracy: None, free: Vec::new(), ..self.clone() }
    }

    /// The error that an accuracy cannot be met, on the line of the `key` that is to blame.
    #[must_use]
    pub fn contradiction(
        &self,
        key: &str,
        message: &str,
        found: &str,
        reachable: &str,
    ) -> SceneError {
        self.source.refuse(key, message).found(found).allowed(reachable)
    }
}
