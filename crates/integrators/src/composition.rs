//! Methods that are a sequence of kicks and drifts, as a table of coefficients.

use glam::DMat2;
use lennard_core::{IntegratorSpec, Method, Step, StepError};

/// Stages of kick and drift, each a fraction of the step, and a last kick.
///
/// A stage (b, a) is v ← v + b·h·a(x), then x ← x + a·h·v, then a force evaluation. Both columns sum
/// to 1 (with the last kick).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Composition {
    pub(crate) spec: &'static IntegratorSpec,
    pub(crate) stages: &'static [(f64, f64)],
    pub(crate) last_kick: f64,
}

impl Composition {
    /// One step on ẍ = −ω²x as a matrix on (x, v): the product of the kicks and drifts.
    pub(crate) fn oscillator_map(&self, omega: f64, dt: f64) -> DMat2 {
        let kick =
            |b: f64| DMat2::from_cols_array_2d(&[[1.0, -omega * omega * b * dt], [0.0, 1.0]]);
        let drift = |a: f64| DMat2::from_cols_array_2d(&[[1.0, 0.0], [a * dt, 1.0]]);
        let stages =
            self.stages.iter().fold(DMat2::IDENTITY, |map, (b, a)| drift(*a) * kick(*b) * map);
        kick(self.last_kick) * stages
    }
}

lennard_core::remembers_nothing!(&'static Composition);

impl Method for &'static Composition {
    fn spec(&self) -> &'static IntegratorSpec {
        self.spec
    }

    /// The forces of the last stage belong to the new time.
    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        for (stage, (kick, drift)) in self.stages.iter().enumerate() {
            s.kick(*kick);
            s.drift(*drift);
            if stage + 1 < self.stages.len() {
                s.inner_forces()?;
            }
        }
        s.forces()?;
        if self.last_kick != 0.0 {
            s.kick(self.last_kick);
        }
        Ok(())
    }
}
