//! One method on one oscillator, step by step, with the code that runs a fluid.

use std::sync::Arc;

use glam::DVec2;
use lennard_core::{DVec3, PeriodicBox, State, System, Want};
use lennard_integrators::oscillator::{ExactOscillator, HarmonicForces, OscillatorConstraint};
use lennard_integrators::{IntegratorEntry, OscillatorModel};

use super::map::StepMap;
use crate::StudyError;
use crate::lab::Rig;

/// An oscillator of unit mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spring {
    /// Undamped, of the stiffness k; a negative one is the unstable ẍ = −k·x = w²x.
    Stiffness(f64),
    /// A constraint with compliance ε = 1/k and damping time τ, for methods that solve for constraints.
    Constraint {
        /// ε, σ²/ε; zero is rigid.
        compliance: f64,
        /// τ.
        damping_time: f64,
    },
}

impl Spring {
    /// A method on the spring from (x, v) on, with the step `dt`.
    pub(crate) fn start(
        self,
        entry: &IntegratorEntry,
        (x, v): (f64, f64),
        dt: f64,
    ) -> Result<Rig, StudyError> {
        let mut system = System::atoms(1);
        let mut stiffness = 0.0;
        match (self, entry.oscillator) {
            (Self::Stiffness(k), OscillatorModel::Constraint) => {
                system.constraints = vec![Arc::new(OscillatorConstraint::spring(k, 0.0))];
            }
            (Self::Constraint { compliance, damping_time }, _) => {
                let constraint = OscillatorConstraint::new(compliance, damping_time);
                system.constraints = vec![Arc::new(constraint)];
            }
            (Self::Stiffness(k), OscillatorModel::ExactSolution) => {
                stiffness = k;
                system.exact = Some(Arc::new(ExactOscillator::new(k, 0.0, 1.0)));
            }
            (Self::Stiffness(k), OscillatorModel::Force) => stiffness = k,
        }
        let along_x = |x| vec![DVec3::new(x, 0.0, 0.0)];
        let state = State::new(PeriodicBox::boundless(), along_x(x), along_x(v));
        let forces = Box::new(HarmonicForces::new(stiffness));
        Rig::start(entry.build(), (system, state), forces, dt, Want::NOTHING)
    }

    /// (x, v) of a method that must not fail, from the start on, one per step.
    pub(crate) fn path(
        self,
        entry: &IntegratorEntry,
        start: (f64, f64),
        dt: f64,
        steps: u32,
    ) -> Result<Vec<DVec2>, StudyError> {
        let mut rig = self.start(entry, start, dt)?;
        let first = std::iter::once(Ok(start.into()));
        first.chain((0..steps).map(|_| rig.next_point())).collect()
    }
}

/// Size of the start from which maps are measured. It is small, so that a method on a bounded grid of
/// positions has room to grow. The map does not depend on it.
const PROBE: f64 = 1.0 / 64.0;

/// The one-step map as measured.
pub(crate) fn measured_map(
    entry: &IntegratorEntry,
    omega: f64,
    dt: f64,
) -> Result<StepMap, StudyError> {
    let start = (PROBE, 0.3 * PROBE / dt);
    Ok(map_of(&Spring::Stiffness(omega * omega).path(entry, start, dt, 3)?))
}

/// The one-step map that states 1, 2 and 3 of a run show, past any special start.
pub(crate) fn map_of(path: &[DVec2]) -> StepMap {
    StepMap::from_states([path[1], path[2], path[3]])
}

/// How far a long run strays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Excursion {
    /// max |x| over the whole run; infinite where it ended early.
    pub(crate) largest: f64,
    /// max |x| over the second half of the steps over the same of the first half: 1 for a bounded run, 2 for linear growth.
    pub(crate) growth: f64,
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
    let mut rig = spring.start(entry, (1.0, 0.0), dt)?;
    let mut halves = [1.0_f64, 0.0];
    for n in 0..steps {
        let x = match rig.try_step() {
            Ok(_) => rig.point().x.abs(),
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
    Ok(Excursion { largest: halves[0].max(halves[1]), growth: halves[1] / halves[0] })
}
