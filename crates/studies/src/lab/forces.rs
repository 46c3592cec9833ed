//! How far the forces are from what they should be, at the start.

use glam::DVec3;
use lennard_core::{Part, Want};
use lennard_forcefield::{ForceFieldOptions, Kernel, KernelOptions, NeighborOptions, Precision};
use serde::{Deserialize, Serialize};

use super::untruncated::Untruncated;
use super::workbench::{Workbench, failed_forces};
use crate::StudyError;
use crate::settings::{Settings, truncation_is_free};

/// Largest number of particles whose forces are judged by the reference loop over all pairs. Beyond it, the canonical
/// loop in double precision over a list judges them.
const REFERENCE_UP_TO: usize = 10_000;
/// Root mean square errors of the forces, relative to the root mean square of the forces themselves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ForceErrors {
    /// Against the reference kernel in double precision, of the same truncated model.
    pub same_model: f64,
    /// Against the untruncated fluid; absent where the potential ends by itself.
    pub untruncated: Option<f64>,
}

/// √(Σ|a − b|²/Σ|b|²).
fn relative(found: &[DVec3], right: &[DVec3]) -> f64 {
    let off: f64 = found.iter().zip(right).map(|(a, b)| (*a - *b).length_squared()).sum();
    (off / right.iter().map(|b| b.length_squared()).sum::<f64>()).sqrt()
}

impl Workbench {
    /// The forces of the untruncated fluid at the start; computed once.
    ///
    /// # Errors
    /// [`StudyError`] where the potential cannot be.
    pub(crate) fn untruncated(&self) -> Result<&Untruncated, StudyError> {
        if self.untruncated.get().is_none() {
            let found = Untruncated::at(self.start(), self.scene())?;
            // Another thread may have been faster, with the same numbers.
            let _ = self.untruncated.set(found);
        }
        Ok(self.untruncated.get().expect("it was set above"))
    }

    /// The errors of the forces at the start under these settings.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit.
    pub fn force_errors(&self, settings: &Settings) -> Result<ForceErrors, StudyError> {
        let options = settings.apply(self.scene())?.force_field();
        let found = self.forces_at_start(settings, &options)?;
        self.errors_of_forces(settings, &found)
    }

    /// The errors of forces at the start, `[N]` in ε/σ, that any engine has computed for these settings.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit.
    pub(crate) fn errors_of_forces(
        &self,
        settings: &Settings,
        found: &[DVec3],
    ) -> Result<ForceErrors, StudyError> {
        let options = settings.apply(self.scene())?.force_field();
        let judge = ForceFieldOptions {
            kernel: KernelOptions {
                kernel: if self.start().len() <= REFERENCE_UP_TO {
                    Kernel::Reference
                } else {
                    Kernel::Auto
                },
                precision: Precision::Double,
                ..options.kernel
            },
            neighbor: NeighborOptions::default(),
            split: None,
            canonical: true,
            ..options
        };
        let right = self.forces_at_start(settings, &judge)?;
        let untruncated = if truncation_is_free(self.scene()) {
            let whole = self.untruncated()?;
            let there: Vec<DVec3> = whole.particles.iter().map(|i| found[*i]).collect();
            Some(relative(&there, &whole.forces))
        } else {
            None
        };
        Ok(ForceErrors { same_model: relative(found, &right), untruncated })
    }

    fn forces_at_start(
        &self,
        settings: &Settings,
        options: &ForceFieldOptions,
    ) -> Result<Vec<DVec3>, StudyError> {
        let start = self.start();
        let scene = settings.apply(self.scene())?;
        let mixture = scene.mixture_of(&start.species);
        let (cell, n) = (start.cell, start.len());
        let conditions = lennard_engine::conditions(&scene, cell, n, mixture.as_ref());
        let mut forces = lennard_forcefield::build(options, &conditions)?;
        let found = start.evaluate(&mut forces, Part::All, Want::NOTHING);
        Ok(found.map_err(|source| failed_forces(settings, source))?.1)
    }
}

#[cfg(test)]
mod tests {
    use lennard_forcefield::TruncationKind;

    use super::*;
    use crate::testing::bench;

    #[test]
    fn forces_of_a_mixture_are_judged_by_the_pairs_of_its_species() {
        let (bench, base) = bench(&[
            ("stage.equilibrate.steps", "100"),
            (
                "species",
                r#"[{ name = "A", fraction = 0.5 }, { name = "B", fraction = 0.5, sigma = 0.8, epsilon = 2.0 }]"#,
            ),
            ("mixing", r#"{ rule = "lorentz-berthelot" }"#),
            ("truncation.r_cut_in", "pair"),
        ]);
        let errors = bench.force_errors(&base).unwrap();
        assert!(errors.same_model < 1e-13, "{errors:?}");
        let whole = errors.untruncated.unwrap();
        assert!((1e-4..0.1).contains(&whole), "{whole}");
        // The cutoff stays in σ of each pair.
        let longer = base.with_truncation(TruncationKind::Cut, 3.0, true);
        assert!(bench.force_errors(&longer).unwrap().untruncated.unwrap() < 0.8 * whole);
        assert_eq!(longer.truncation.r_cut_in, base.truncation.r_cut_in);
    }

    #[test]
    fn force_errors_tell_precision_and_truncation_apart() {
        let (bench, base) = bench(&[("stage.equilibrate.steps", "100")]);
        let double = bench.force_errors(&base).unwrap();
        let mixed =
            bench.force_errors(&Settings { precision: Precision::Mixed, ..base.clone() }).unwrap();
        // f64 has 53 bits and f32 24: rounding of a few tens of terms.
        assert!(double.same_model < 1e-13, "{double:?}");
        assert!((1e-9..1e-5).contains(&mixed.same_model), "{mixed:?}");
        let whole = double.untruncated.unwrap();
        assert!((1e-4..0.1).contains(&whole));
        let longer = base.with_truncation(TruncationKind::Cut, 3.3, true);
        assert!(bench.force_errors(&longer).unwrap().untruncated.unwrap() < 0.6 * whole);
        // The sum over images is far better than any cutoff.
        assert!(bench.untruncated().unwrap().left_out < 0.01 * whole);
        // A shifted energy moves no force; a shifted force does.
        let with = |kind| {
            let settings = base.with_truncation(kind, 2.5, false);
            bench.force_errors(&settings).unwrap().untruncated.unwrap()
        };
        assert_eq!(with(TruncationKind::Shift), whole);
        assert_ne!(with(TruncationKind::ForceShift), whole);
    }
}
