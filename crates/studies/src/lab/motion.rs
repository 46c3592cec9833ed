//! Errors of short trajectories: against one that is all but exact, and there and back.

use std::sync::{Arc, PoisonError};

use glam::DVec3;
use lennard_core::{State, Want};
use lennard_forcefield::{ListMode, Precision, TruncationOptions};
use lennard_integrators::{IntegratorOptions, blanes_moan};
use serde::{Deserialize, Serialize};

use super::rig::Rig;
use super::workbench::{Tight, TightTrajectory, Workbench};
use crate::StudyError;
use crate::settings::Settings;

/// Step of the trajectories that others are compared with, τ, made with the method of Blanes and Moan.
const REFERENCE_DT: f64 = 0.001;

/// How far a short trajectory has gone astray.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryError {
    /// Root mean square distance of the particles from where the tight trajectory of the same model has them, σ.
    pub distance: f64,
    /// The same between the tight trajectory and one with twice its step, σ: how well the distance can be known.
    pub floor: f64,
    /// After this time, τ.
    pub time: f64,
}

/// √(Σ|a − b|²/N).
fn distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (*a - *b).length_squared()).sum();
    (sum / a.len() as f64).sqrt()
}

/// A whole number of steps that ends at `time`, and the step that does: `dt` except for rounding.
fn steps_to(time: f64, dt: f64) -> (u64, f64) {
    let steps = (time / dt).round().max(1.0);
    (steps as u64, time / steps)
}

impl Workbench {
    /// How far a trajectory of `time` τ at constant energy strays from the tight one of the same model: precision and
    /// integration, and not truncation. The step is changed a little where `time` is no multiple of it.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit or the run fails ([`super::Failed::or`] tells which).
    pub fn trajectory_error(
        &self,
        settings: &Settings,
        time: f64,
    ) -> Result<TrajectoryError, StudyError> {
        let (steps, dt) = steps_to(time, self.stage_dt(settings));
        let end = self.by_hand(settings, self.start().state(), steps, dt)?;
        let tight = self.tight_trajectory(settings, time)?;
        Ok(TrajectoryError {
            distance: distance(&end.positions, &tight.positions),
            floor: tight.floor,
            time,
        })
    }

    /// Where the tight trajectory of the model of these settings is after `time` τ; computed once.
    ///
    /// # Errors
    /// As [`Workbench::trajectory_error`].
    pub(crate) fn tight_trajectory(
        &self,
        settings: &Settings,
        time: f64,
    ) -> Result<Arc<TightTrajectory>, StudyError> {
        // A tail correction moves no particle.
        let truncation = TruncationOptions { tail_correction: false, ..settings.truncation };
        let all = || self.tight.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |known: &&Tight| known.truncation == truncation && known.time == time;
        if let Some(known) = all().iter().find(is_it) {
            return Ok(Arc::clone(&known.trajectory));
        }
        let trajectory = Arc::new(self.compute_tight_trajectory(settings, time)?);
        // Another thread may have been faster, with the same numbers.
        all().push(Tight { truncation, time, trajectory: Arc::clone(&trajectory) });
        Ok(trajectory)
    }

    /// Root mean square distance, σ, of the particles from their start after `time` τ forward at constant energy and
    /// the same with reversed velocities.
    ///
    /// # Errors
    /// As [`Workbench::trajectory_error`].
    pub fn reversibility(&self, settings: &Settings, time: f64) -> Result<f64, StudyError> {
        let (steps, dt) = steps_to(time, self.stage_dt(settings));
        let mut state = self.by_hand(settings, self.start().state(), steps, dt)?;
        state.velocities.iter_mut().for_each(|v| *v = -*v);
        let back = self.by_hand(settings, state, steps, dt)?;
        Ok(distance(&back.positions, &self.start().positions))
    }

    fn compute_tight_trajectory(
        &self,
        settings: &Settings,
        time: f64,
    ) -> Result<TightTrajectory, StudyError> {
        let tight = Settings {
            precision: Precision::Double,
            list: ListMode::Auto,
            skin: None,
            dt: REFERENCE_DT,
            ..settings
                .with_integrator(IntegratorOptions::BlanesMoan(blanes_moan::Options::default()))
        };
        let end = |dt: f64| -> Result<Vec<DVec3>, StudyError> {
            let (steps, dt) = steps_to(time, dt);
            let end = self.by_hand(&tight, self.start().state(), steps, dt)?;
            Ok(end.positions)
        };
        let positions = end(REFERENCE_DT)?;
        let floor = distance(&end(2.0 * REFERENCE_DT)?, &positions);
        Ok(TightTrajectory { positions, floor })
    }

    /// The state after `steps` steps at constant energy, by hand, with forces of its own.
    fn by_hand(
        &self,
        settings: &Settings,
        state: State,
        steps: u64,
        dt: f64,
    ) -> Result<State, StudyError> {
        let forces = self.forces(settings)?;
        let at = (self.start().system(), state);
        let method = lennard_integrators::build(&settings.integrator);
        let mut fluid = Rig::start(method, at, Box::new(forces), dt, Want::NOTHING)?;
        fluid.steps(steps)?;
        Ok(fluid.state)
    }
}

#[cfg(test)]
mod tests {
    use lennard_forcefield::TruncationKind;

    use super::*;
    use crate::testing::bench;

    #[test]
    fn the_trajectory_error_falls_as_the_order_of_the_method_says() {
        let (bench, base) = bench(&[("stage.equilibrate.steps", "200")]);
        let base = base.with_truncation(TruncationKind::Switch, 2.5, false);
        let error = |dt: f64| {
            let settings = Settings { dt, ..base.clone() };
            bench.trajectory_error(&settings, 0.192).unwrap()
        };
        let (coarse, fine) = (error(0.004), error(0.002));
        // Second order: four times, within what the next order adds.
        let gain = coarse.distance / fine.distance;
        assert!((gain / 4.0 - 1.0).abs() < 0.1, "{gain}");
        assert!(coarse.floor < 1e-3 * fine.distance, "{fine:?}");
    }

    #[test]
    fn reversible_methods_come_back_and_explicit_euler_does_not() {
        let (bench, base) = bench(&[("stage.equilibrate.steps", "100")]);
        // 96 steps of rounding, 1e-16 each, grown by collisions.
        let verlet = bench.reversibility(&base, 0.192).unwrap();
        assert!(verlet < 1e-11, "{verlet:e}");
        let euler = base.with_integrator(IntegratorOptions::ExplicitEuler(Default::default()));
        assert!(bench.reversibility(&euler, 0.192).unwrap() > 1e-4);
    }
}
