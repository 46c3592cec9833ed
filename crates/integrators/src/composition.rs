//! Methods that are a sequence of kicks and drifts, as a table of coefficients.

use glam::DMat2;
use lennard_core::{
    Configuration, Dynamics, ForceProvider, IntegratorSpec, Part, State, StepError, StepReport,
    Want, sweeps,
};

use crate::common::{check_finite, check_suited, evaluate, tick};

/// Stages of kick and drift, each a fraction of the step, and a last kick.
///
/// A stage (b, a) is v ← v + b·h·a(x), then x ← x + a·h·v, then a force evaluation. Both columns sum
/// to 1 (with the last kick).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Composition {
    pub(crate) stages: &'static [(f64, f64)],
    pub(crate) last_kick: f64,
}

impl Composition {
    /// One step on ẍ = −ω²x as a matrix on (x, v): the product of the kicks and drifts.
    pub(crate) fn oscillator_map(&self, omega: f64, dt: f64) -> DMat2 {
        let kick =
            |b: f64| DMat2::from_cols_array_2d(&[[1.0, -omega * omega * b * dt], [0.0, 1.0]]);
        let drift = |a: f64| DMat2::from_cols_array_2d(&[[1.0, 0.0], [a * dt, 1.0]]);
        let stages = self
            .stages
            .iter()
            .fold(DMat2::IDENTITY, |map, (b, a)| drift(*a) * kick(*b) * map);
        kick(self.last_kick) * stages
    }

    /// One step; the forces of the last stage are those at the new time.
    pub(crate) fn step(
        &self,
        spec: &'static IntegratorSpec,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_suited(spec, forces, dt)?;
        let started = state.time;
        let mut elapsed = 0.0;
        for (stage, (kick, drift)) in self.stages.iter().enumerate() {
            sweeps::kick_and_drift(
                &mut state.positions,
                &mut state.velocities,
                &state.forces,
                &dynamics.masses,
                kick * dt,
                drift * dt,
            );
            if stage + 1 == self.stages.len() {
                break;
            }
            elapsed += drift;
            let at = Configuration {
                positions: &state.positions,
                velocities: None,
                time: started + elapsed * dt,
            };
            forces.evaluate(at, Part::All, Want::NOTHING, &mut state.forces)?;
            check_finite(&state.forces)?;
        }
        tick(state, dt);
        evaluate(spec, state, forces, want)?;
        if self.last_kick != 0.0 {
            sweeps::kick(
                &mut state.velocities,
                &state.forces,
                &dynamics.masses,
                self.last_kick * dt,
            );
        }
        Ok(StepReport {
            force_evaluations: self.stages.len() as u32,
            ..StepReport::default()
        })
    }
}
