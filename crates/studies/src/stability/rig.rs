//! One method on one oscillator, step by step, with the very code that runs the fluid.

use std::sync::Arc;

use glam::DVec2;
use lennard_core::{DVec3, Integrator, State, StepError, System, Want};
use lennard_integrators::oscillator::{ExactOscillator, HarmonicForces, OscillatorConstraint};
use lennard_integrators::{IntegratorEntry, OscillatorModel};

use super::map::StepMap;
use crate::StudyError;

/// An oscillator of unit mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spring {
    /// Of this stiffness k (negative: the unstable ẍ = −k·x = w²x), undamped.
    Stiffness(f64),
    /// A rigid constraint, ε = 1/k = 0, with damping time τ, for the methods that solve for constraints.
    Rigid { damping_time: f64 },
}

/// A method, an oscillator and a state on the x axis.
pub(crate) struct Rig {
    method: &'static str,
    integrator: Integrator,
    system: System,
    forces: HarmonicForces,
    state: State,
}

impl Rig {
    /// Starts `entry` on the spring at (x, v) with the step `dt`.
    pub(crate) fn start(
        entry: &IntegratorEntry,
        spring: Spring,
        (x, v): (f64, f64),
        dt: f64,
    ) -> Result<Self, StudyError> {
        let mut system = System::atoms(1);
        let mut stiffness = 0.0;
        match (spring, entry.oscillator) {
            (Spring::Stiffness(k), OscillatorModel::Constraint) => {
                system.constraints = vec![Arc::new(OscillatorConstraint::spring(k, 0.0))];
            }
            (Spring::Rigid { damping_time }, _) => {
                system.constraints = vec![Arc::new(OscillatorConstraint::new(0.0, damping_time))];
            }
            (Spring::Stiffness(k), OscillatorModel::ExactSolution) => {
                stiffness = k;
                system.exact = Some(Arc::new(ExactOscillator::new(k, 0.0, 1.0)));
            }
            (Spring::Stiffness(k), OscillatorModel::Force) => stiffness = k,
        }
        let mut rig = Self {
            method: entry.spec.name,
            integrator: entry.build(),
            system,
            forces: HarmonicForces::new(stiffness),
            state: State::new(
                lennard_core::PeriodicBox::boundless(),
                vec![DVec3::new(x, 0.0, 0.0)],
                vec![DVec3::new(v, 0.0, 0.0)],
            ),
        };
        let started =
            rig.integrator.start(&rig.system, &mut rig.state, &mut rig.forces, dt, Want::NOTHING);
        match started {
            Ok(_) => Ok(rig),
            Err(source) => Err(rig.failure(dt, source)),
        }
    }

    /// The one-step map that the next three states show.
    pub(crate) fn map(&mut self, dt: f64) -> Result<StepMap, StudyError> {
        let states = [self.step(dt)?, self.step(dt)?, self.step(dt)?];
        Ok(StepMap::from_states(states))
    }

    fn failure(&self, dt: f64, source: StepError) -> StudyError {
        StudyError::Step { method: self.method, dt, source }
    }

    /// One step of a method that must not fail here; the new (x, v).
    pub(crate) fn step(&mut self, dt: f64) -> Result<DVec2, StudyError> {
        self.try_step(dt).map_err(|source| self.failure(dt, source))
    }

    /// One step of a method that may fail; the new (x, v).
    pub(crate) fn try_step(&mut self, dt: f64) -> Result<DVec2, StepError> {
        self.integrator.step(&self.system, &mut self.state, &mut self.forces, dt, Want::NOTHING)?;
        Ok(self.phase_point())
    }

    /// The present (x, v).
    pub(crate) fn phase_point(&self) -> DVec2 {
        DVec2::new(self.state.positions[0].x, self.state.velocities[0].x)
    }

    /// The present time.
    pub(crate) fn time(&self) -> f64 {
        self.state.time
    }
}

/// What a long run showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Excursion {
    /// max |x| over the first half of the steps.
    pub(crate) first_half: f64,
    /// max |x| over the second half; infinite where the run ended early.
    pub(crate) second_half: f64,
}

impl Excursion {
    /// max |x| over the whole run.
    pub(crate) fn largest(self) -> f64 {
        self.first_half.max(self.second_half)
    }

    /// How much larger the second half is: 1 for a bounded run, 2 for linear growth.
    pub(crate) fn growth(self) -> f64 {
        self.second_half / self.first_half
    }
}

/// Runs `steps` steps from (1, 0) and records how far x strays. A run whose x passes `bound`, or that
/// the method refuses to go on with, has an infinite excursion.
pub(crate) fn excursion(
    entry: &IntegratorEntry,
    spring: Spring,
    dt: f64,
    steps: u32,
    bound: f64,
) -> Result<Excursion, StudyError> {
    let mut rig = Rig::start(entry, spring, (1.0, 0.0), dt)?;
    let mut halves = [1.0_f64, 0.0];
    for n in 0..steps {
        let x = match rig.try_step(dt) {
            Ok(z) => z.x.abs(),
            Err(_) => f64::INFINITY,
        };
        let half = &mut halves[usize::from(2 * n >= steps)];
        // A NaN is as unbounded as an infinity.
        if x > bound || x.is_nan() {
            halves[1] = f64::INFINITY;
            break;
        }
        *half = half.max(x);
    }
    Ok(Excursion { first_half: halves[0], second_half: halves[1] })
}

/// Size of the start from which maps are measured. It is small, so that a method on a bounded grid of
/// positions has room to grow. The map does not depend on it.
const PROBE: f64 = 1.0 / 64.0;

/// The one-step map as measured: from states 1, 2 and 3 of a run, past any special start.
pub(crate) fn measured_map(
    entry: &IntegratorEntry,
    omega: f64,
    dt: f64,
) -> Result<StepMap, StudyError> {
    let spring = Spring::Stiffness(omega * omega);
    let start = (PROBE, 0.3 * PROBE / dt);
    Rig::start(entry, spring, start, dt)?.map(dt)
}
