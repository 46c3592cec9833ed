//! Everything about a scene that trades speed for accuracy, as one value.

use lennard_forcefield::{
    CutoffUnit, ListMode, NeighborOptions, Precision, SplitOptions, TruncationKind,
    TruncationOptions,
};
use lennard_integrators::IntegratorOptions;
use lennard_scene::{DEFAULT_SPLIT, Scene};
use serde::{Deserialize, Serialize};

use crate::StudyError;

/// One choice of everything that trades speed for accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The method that advances time, with its own keys.
    pub integrator: IntegratorOptions,
    /// Time step, τ.
    pub dt: f64,
    /// Where the force is split, for a method that takes it in two parts.
    pub split: Option<SplitOptions>,
    /// How the potential ends, where, and whether means are corrected for the tail.
    pub truncation: TruncationOptions,
    /// Precision of the pair terms.
    pub precision: Precision,
    /// How neighbors are found.
    pub list: ListMode,
    /// The skin of the list, σ; chosen from density, temperature and dt where absent.
    pub skin: Option<f64>,
}

/// The usual cutoff of a liquid, σ.
const USUAL_CUTOFF: f64 = 2.5;
/// The usual time step, τ.
const USUAL_DT: f64 = 0.004;

impl Settings {
    /// The usual settings in place of these: a cutoff of 2.5 σ with its tail and a step of 0.004 τ, in double precision.
    /// `None` where these settings end the potential otherwise, or where the cutoff is over `largest_cutoff`.
    #[must_use]
    pub fn usual(&self, largest_cutoff: f64) -> Option<Self> {
        let cut = self.truncation.kind == TruncationKind::Cut && self.truncation.tail_correction;
        (cut && USUAL_CUTOFF <= largest_cutoff).then(|| Self {
            dt: USUAL_DT,
            precision: Precision::Double,
            ..self.with_truncation(TruncationKind::Cut, USUAL_CUTOFF, true)
        })
    }

    /// Whether these are [`Settings::usual`], with a step that differs by a twentieth at most.
    pub(crate) fn are_usual(&self) -> bool {
        let usual = self.usual(f64::INFINITY);
        usual.is_some_and(|usual| {
            let alike = Self { dt: usual.dt, ..self.clone() };
            usual == alike && (self.dt / usual.dt - 1.0).abs() < 0.05
        })
    }

    /// The settings of a scene.
    pub(crate) fn of(scene: &Scene) -> Self {
        Self {
            integrator: scene.integrator.method.clone(),
            dt: scene.integrator.dt,
            split: scene.integrator.split,
            truncation: scene.truncation,
            precision: scene.kernel.precision,
            list: scene.neighbor.mode,
            skin: scene.neighbor.skin,
        }
    }

    /// The scene with these settings in place of its own.
    ///
    /// Every stage keeps its simulated time, and every interval of sampling and writing too, to the nearest whole step.
    /// A stage with a dt of its own keeps its ratio to the dt of the scene.
    ///
    /// # Errors
    /// [`StudyError::Settings`] where they do not go together or do not fit the scene.
    pub(crate) fn apply(&self, scene: &Scene) -> Result<Scene, StudyError> {
        let refused = |reason: String| StudyError::Settings { label: self.label(), reason };
        if !(self.dt.is_finite() && self.dt > 0.0) {
            return Err(refused(format!("dt must be above 0, found {}", self.dt)));
        }
        self.integrator.check().map_err(|e| refused(e.to_string()))?;
        let splits = matches!(self.integrator, IntegratorOptions::Respa(_));
        if splits != self.split.is_some() {
            return Err(refused(
                "a split of the force belongs to `respa`, and `respa` needs one".into(),
            ));
        }
        let ratio = self.dt / scene.integrator.dt;
        let scaled = |steps: u64| ((steps as f64 / ratio).round() as u64).max(1);
        let mut changed = scene.clone();
        changed.integrator.method = self.integrator.clone();
        changed.integrator.dt = self.dt;
        changed.integrator.split = self.split;
        changed.truncation = self.truncation;
        changed.kernel.precision = self.precision;
        changed.neighbor = NeighborOptions { mode: self.list, skin: self.skin };
        for stage in &mut changed.stages {
            stage.steps = scaled(stage.steps);
            stage.dt = stage.dt.map(|dt| dt * ratio);
        }
        for observable in &mut changed.observables {
            observable.every = scaled(observable.every);
        }
        let output = &mut changed.output;
        output.thermo_every = scaled(output.thermo_every);
        output.trajectory_every = output.trajectory_every.map(scaled);
        changed.checkpoint.every_steps = changed.checkpoint.every_steps.map(scaled);
        changed.check().map_err(|e| refused(e.to_string()))?;
        Ok(changed)
    }

    /// The settings in a line: `velocity-verlet, dt 0.00462, cut at 2.5 σ with tail, double, list`.
    pub(crate) fn label(&self) -> String {
        let list = match (self.list, self.skin) {
            (ListMode::Direct, _) => "all pairs".to_owned(),
            (_, Some(skin)) => format!("list with skin {skin} σ"),
            (_, None) => "list".to_owned(),
        };
        format!(
            "{}, dt {}, {}, {}, {list}",
            self.integrator.name(),
            crate::report::significant(self.dt, 3),
            self.truncation_label(),
            self.precision.name(),
        )
    }

    /// The truncation in words: `cut at 2.5 σ with tail`.
    pub(crate) fn truncation_label(&self) -> String {
        let r_cut = rounded(self.truncation.r_cut);
        let unit = match self.truncation.r_cut_in {
            Some(CutoffUnit::Pair) => "σ_ab",
            Some(CutoffUnit::Sigma) | None => "σ",
        };
        match self.truncation.kind {
            TruncationKind::Cut if self.truncation.tail_correction => {
                format!("cut at {r_cut} {unit} with tail")
            }
            TruncationKind::Cut => format!("cut at {r_cut} {unit} without tail"),
            TruncationKind::Shift => format!("shifted at {r_cut} {unit}"),
            TruncationKind::ForceShift => format!("force-shifted at {r_cut} {unit}"),
            TruncationKind::Switch => format!("switched at {r_cut} {unit}"),
            other => format!("{} at {r_cut} {unit}", other.name()),
        }
    }

    /// With another method, and the split that it needs.
    pub(crate) fn with_integrator(&self, integrator: IntegratorOptions) -> Self {
        let splits = matches!(integrator, IntegratorOptions::Respa(_));
        Self {
            split: splits.then(|| self.split.unwrap_or(DEFAULT_SPLIT)),
            integrator,
            ..self.clone()
        }
    }

    /// With another truncation; the start of a switch is left to its default.
    pub(crate) fn with_truncation(&self, kind: TruncationKind, r_cut: f64, tail: bool) -> Self {
        Self {
            truncation: TruncationOptions {
                tail_correction: tail,
                r_cut_in: self.truncation.r_cut_in,
                ..TruncationOptions::new(kind, r_cut)
            },
            ..self.clone()
        }
    }
}

/// A length with at most four digits and no zeros at the end.
fn rounded(length: f64) -> String {
    ((length * 1e3).round() / 1e3).to_string()
}

/// Whether the truncation of this potential can be chosen at all: WCA ends by itself.
pub(crate) fn truncation_is_free(scene: &Scene) -> bool {
    scene.potential.own_end().is_none()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const TEXT: &str = r#"
            [system]
            n_atoms = 256
            density = 0.8442
            temperature = 0.8
            [truncation]
            r_cut = 2.5
            [integrator]
            dt = 0.004
            [[stage]]
            name = "equilibrate"
            steps = 500
            thermostat = "bussi"
            [[stage]]
            name = "production"
            steps = 1001
            [[observable]]
            kind = "rdf"
            every = 100
            [output]
            thermo_every = 10
        "#;

    pub(crate) fn scene(extra: &[(&str, &str)]) -> Scene {
        let extra: Vec<(String, String)> =
            extra.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect();
        Scene::parse(TEXT, "test.toml", &extra).unwrap()
    }

    #[test]
    fn the_settings_of_a_scene_leave_it_as_it_is() {
        for extra in [
            &[][..],
            &[("integrator.kind", "respa")],
            &[("neighbor.mode", "direct"), ("kernel.precision", "mixed")],
        ] {
            let scene = scene(extra);
            assert_eq!(Settings::of(&scene).apply(&scene).unwrap(), scene);
        }
    }

    #[test]
    fn simulated_times_stay_when_the_step_changes() {
        let scene = scene(&[("stage.equilibrate.dt", "0.002")]);
        let settings = Settings { dt: 0.001, ..Settings::of(&scene) };
        let changed = settings.apply(&scene).unwrap();
        let time = |s: &Scene, i: usize| s.stages[i].steps as f64 * s.stage_dt(&s.stages[i]);
        for i in 0..2 {
            assert!((time(&changed, i) - time(&scene, i)).abs() < 1e-9);
        }
        assert_eq!((changed.observables[0].every, changed.output.thermo_every), (400, 40));
        // Rounding to whole steps loses at most half a step.
        let coarse = Settings { dt: 0.01, ..settings };
        assert_eq!(coarse.apply(&scene).unwrap().stages[1].steps, 400);
    }

    #[test]
    fn what_does_not_go_together_is_refused_with_the_reason() {
        let scene = scene(&[]);
        let base = Settings::of(&scene);
        let refused = |s: &Settings, word: &str| {
            let text = s.apply(&scene).unwrap_err().to_string();
            assert!(text.contains(word), "{text}");
        };
        refused(&base.with_truncation(TruncationKind::Shift, 2.5, true), "tail");
        refused(&base.with_truncation(TruncationKind::Cut, 3.6, true), "half");
        refused(&Settings { dt: f64::NAN, ..base.clone() }, "dt");
        refused(&Settings { split: Some(DEFAULT_SPLIT), ..base.clone() }, "split");
        refused(&Settings { list: ListMode::Direct, skin: Some(0.3), ..base }, "skin");
    }
}
