//! How far the forces are from what they should be, at the start.

use glam::DVec3;
use lennard_core::{Configuration, ForceTerm, Part, Want};
use lennard_forcefield::{
    ForceFieldOptions, Kernel, KernelOptions, Model, NeighborOptions, PotentialOptions, Precision,
    TruncationKind, TruncationOptions,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::workbench::Workbench;
use super::{Settings, Start, truncation_is_free};
use crate::StudyError;

/// The most pairs of a particle and an image for the forces of the untruncated fluid.
const MOST_PAIRS: f64 = 1.2e8;
/// The most particles at which those forces are taken, evenly chosen.
const MOST_PARTICLES: usize = 1024;
/// Up to so many particles the reference loop over all pairs is asked for the same model; beyond, the canonical loop
/// in double precision over a list.
const REFERENCE_UP_TO: usize = 10_000;
/// Points of the integral over what the sum leaves out.
const INTEGRATION_POINTS: usize = 400;

/// Root mean square errors of the forces, relative to the root mean square of the forces themselves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ForceErrors {
    /// Against the reference kernel in double precision, of the same truncated model.
    pub same_model: f64,
    /// Against the untruncated fluid; absent where the potential ends by itself.
    pub untruncated: Option<f64>,
}

/// The forces of the fluid without a cutoff, summed over periodic images.
#[derive(Debug, Clone)]
pub struct Untruncated {
    /// The particles that they are for.
    pub particles: Vec<usize>,
    /// The forces, one for each of those, ε/σ.
    pub forces: Vec<DVec3>,
    /// Pairs up to this distance are in the sum, σ.
    pub reach: f64,
    /// An estimate of what the sum leaves out, relative to the forces: that of neighbors beyond the reach that are
    /// placed at random.
    pub left_out: f64,
}

impl Untruncated {
    fn at(start: &Start, potential: &PotentialOptions) -> Result<Self, StudyError> {
        let n = start.len();
        let chosen = n.min(MOST_PARTICLES);
        let particles: Vec<usize> = (0..chosen).map(|k| k * n / chosen).collect();
        let shells = |k: u32| f64::from(2 * k + 1).powi(3) * (chosen * n) as f64;
        let k = (1..=4)
            .rev()
            .find(|k| shells(*k) <= MOST_PAIRS)
            .unwrap_or(0);
        // Half a box less a hair, so that no tie between two images is in the sum.
        let reach = (f64::from(k) + 0.5) * start.cell.shortest() * (1.0 - 1e-9);
        let truncation = TruncationOptions::new(TruncationKind::Cut, reach);
        let model = Model::new(potential, &truncation)?;
        let forces = with_images(start, &particles, &model, reach);
        let mean_square =
            forces.iter().map(|f| f.length_squared()).sum::<f64>() / forces.len() as f64;
        let left_out = (beyond(&model, reach) * start.density() / mean_square).sqrt();
        Ok(Self {
            particles,
            forces,
            reach,
            left_out,
        })
    }
}

/// ∫ F(r)²·4πr² dr from `reach` to ten times as far: times ρ, the mean square force of neighbors placed at random.
fn beyond(model: &Model, reach: f64) -> f64 {
    let step = 10f64.ln() / INTEGRATION_POINTS as f64;
    (0..INTEGRATION_POINTS)
        .map(|i| {
            let r = reach * ((i as f64 + 0.5) * step).exp();
            let force = model.eval(r * r).force * r;
            force * force * 4.0 * std::f64::consts::PI * r.powi(3) * step
        })
        .sum()
}

/// Forces on some particles from all others and from the periodic images of all, up to a distance, in double
/// precision: the reference loop with images.
fn with_images(start: &Start, particles: &[usize], model: &Model, reach: f64) -> Vec<DVec3> {
    let lengths = start.cell.lengths();
    // After the nearest image a component is at most L/2: further images reach back by that much.
    let counts = (reach / lengths + DVec3::splat(0.5)).floor().as_ivec3();
    let mut shifts = Vec::new();
    for x in -counts.x..=counts.x {
        for y in -counts.y..=counts.y {
            for z in -counts.z..=counts.z {
                shifts.push(lengths * glam::IVec3::new(x, y, z).as_dvec3());
            }
        }
    }
    let on = |i: usize| -> DVec3 {
        let mut force = DVec3::ZERO;
        for (j, other) in start.positions.iter().enumerate() {
            // The images of a particle itself pull it from all sides alike.
            if j == i {
                continue;
            }
            let nearest = start.cell.minimum_image(start.positions[i] - *other);
            for shift in &shifts {
                let r_ij = nearest + *shift;
                let r2 = r_ij.length_squared();
                if r2 <= reach * reach {
                    force += model.eval(r2).force * r_ij;
                }
            }
        }
        force
    };
    particles.par_iter().map(|i| on(*i)).collect()
}

/// √(Σ|a − b|²/Σ|b|²).
fn relative(found: &[DVec3], right: &[DVec3]) -> f64 {
    let off: f64 = found
        .iter()
        .zip(right)
        .map(|(a, b)| (*a - *b).length_squared())
        .sum();
    (off / right.iter().map(|b| b.length_squared()).sum::<f64>()).sqrt()
}

impl Workbench {
    /// The forces of the untruncated fluid at the start; computed once.
    ///
    /// # Errors
    /// [`StudyError`] where the potential cannot be.
    pub fn untruncated(&self) -> Result<&Untruncated, StudyError> {
        if self.untruncated.get().is_none() {
            let found = Untruncated::at(self.start(), &self.scene().potential)?;
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

    /// The errors of forces at the start, `[N]` in ε/σ, that somebody else has computed for these settings.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit.
    pub fn errors_of_forces(
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
        Ok(ForceErrors {
            same_model: relative(found, &right),
            untruncated,
        })
    }

    fn forces_at_start(
        &self,
        settings: &Settings,
        options: &ForceFieldOptions,
    ) -> Result<Vec<DVec3>, StudyError> {
        let start = self.start();
        let scene = settings.apply(self.scene())?;
        let conditions = lennard_engine::conditions(&scene, start.cell, start.len());
        let mut out = vec![DVec3::ZERO; start.len()];
        let at = Configuration::at_rest(&start.cell, &start.positions);
        lennard_forcefield::build(options, &conditions)?
            .evaluate(at, Part::All, Want::NOTHING, &mut out)
            .map_err(|source| StudyError::Force {
                label: settings.label(),
                source,
            })?;
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::PeriodicBox;
    use lennard_forcefield::Conditions;

    use super::super::tests::scene;
    use super::*;

    #[test]
    fn images_add_up_to_the_forces_of_a_box_of_boxes() {
        // The same fluid as one box with images, and as 27 boxes side by side without any.
        let scene = scene(&[
            ("stage.equilibrate.steps", "30"),
            ("system.n_atoms", "32"),
            ("truncation.r_cut", "1.5"),
        ]);
        let start = Start::equilibrate(&scene).unwrap();
        let side = start.cell.lengths().x;
        let reach = 1.49 * side;
        let truncation = TruncationOptions::new(TruncationKind::Cut, reach);
        let model = Model::new(&scene.potential, &truncation).unwrap();
        let found = with_images(&start, &[0, 7], &model, reach);
        let mut boxes = Start {
            cell: PeriodicBox::new(3.0 * start.cell.lengths()).unwrap(),
            positions: Vec::new(),
            velocities: Vec::new(),
        };
        for n in 0..27 {
            let shift = side * DVec3::new(f64::from(n % 3), f64::from(n / 3 % 3), f64::from(n / 9));
            boxes
                .positions
                .extend(start.positions.iter().map(|r| *r + shift));
        }
        let options = ForceFieldOptions {
            truncation,
            kernel: KernelOptions {
                kernel: Kernel::Reference,
                ..KernelOptions::default()
            },
            ..ForceFieldOptions::default()
        };
        let conditions = Conditions {
            cell: boxes.cell,
            n_atoms: boxes.positions.len(),
            temperature: 1.0,
            dt: 0.004,
        };
        let mut right = vec![DVec3::ZERO; boxes.positions.len()];
        let at = Configuration::at_rest(&boxes.cell, &boxes.positions);
        lennard_forcefield::build(&options, &conditions)
            .unwrap()
            .evaluate(at, Part::All, Want::NOTHING, &mut right)
            .unwrap();
        // Rounding: some 600 terms of size up to 100 each.
        for (a, b) in found.iter().zip([right[0], right[7]]) {
            assert!((*a - b).length() < 1e-10, "{a} {b}");
        }
    }

    #[test]
    fn force_errors_tell_precision_and_truncation_apart() {
        let scene = scene(&[("stage.equilibrate.steps", "100")]);
        let bench = Workbench::new(&scene).unwrap();
        let base = Settings::of(&scene);
        let double = bench.force_errors(&base).unwrap();
        let mixed = bench
            .force_errors(&Settings {
                precision: Precision::Mixed,
                ..base.clone()
            })
            .unwrap();
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
