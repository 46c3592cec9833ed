//! The exact solution, where one is known: what every other method is measured against.

use glam::DMat2;
use lennard_core::{
    Dynamics, ForceProvider, Integrator, IntegratorSpec, State, StepError, StepReport, Want,
};
use serde::{Deserialize, Serialize};

use crate::OscillatorModel;
use crate::common::{Method, check_step, evaluate, remembers_nothing, tick};
use crate::oscillator::ExactOscillator;

/// Options of the exact solution: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What the exact solution declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "analytic",
    summary: "The exact solution of the equations of motion, where one is known (the oscillator; not a fluid).",
    equations: "x(t+h), v(t+h) = the known solution through x(t), v(t)",
    position_order: 0,
    velocity_order: 0,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: true,
    has_memory: false,
    conserves_momentum: true,
    half_kicks: false,
    force_evaluations: 1,
    stability_limit: None,
    oscillator_map: Some(oscillator_map),
    source: "Landau and Lifshitz, \"Mechanics\", 3rd ed. (1976), sections 21 and 25",
};

/// One step on ẍ = −ω²x as a matrix on (x, v): the rotation x′ = x·cos ωh + (v/ω)·sin ωh,
/// v′ = v·cos ωh − xω·sin ωh.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    ExactOscillator::new(omega * omega, 0.0, 1.0).map(dt)
}

/// The solution in [`Dynamics::exact`], advanced by h; the forces are evaluated only to be published.
#[derive(Debug, Clone, Default)]
pub struct Analytic;

impl Method for Options {
    const OSCILLATOR: OscillatorModel = OscillatorModel::ExactSolution;
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(Analytic)
    }
}

remembers_nothing!(Analytic);

fn unknown_solution() -> StepError {
    StepError::Unsuited {
        method: SPEC.name,
        reason: "no exact solution of its motion is known".to_owned(),
    }
}

impl Integrator for Analytic {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn start(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<(), StepError> {
        check_step(dt)?;
        if dynamics.exact.is_none() {
            return Err(unknown_solution());
        }
        evaluate(&SPEC, state, forces, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_step(dt)?;
        let solution = dynamics.exact.as_ref().ok_or_else(unknown_solution)?;
        solution.advance(&mut state.positions, &mut state.velocities, dt);
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        Ok(StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        })
    }
}
