//! Explicit Euler: position and velocity both advance with what was known at the start of the step.

use glam::DMat2;
use lennard_core::{
    Dynamics, ForceProvider, Integrator, IntegratorSpec, State, StepError, StepReport, Want, sweeps,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, begin, check_suited, evaluate, remembers_nothing, tick};

/// Options of explicit Euler: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What explicit Euler declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "explicit-euler",
    summary: "Explicit Euler: drift with the old velocity, kick with the old force; grows without bound on every oscillator.",
    equations: "x(t+h) = x(t) + h v(t); v(t+h) = v(t) + h a(t)",
    position_order: 1,
    velocity_order: 1,
    symplectic: false,
    reversible: false,
    fixed_step_only: false,
    velocity_dependent_forces: true,
    has_memory: false,
    conserves_momentum: true,
    half_kicks: false,
    force_evaluations: 1,
    stability_limit: Some(0.0),
    oscillator_map: Some(oscillator_map),
    source: "Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed., Springer (2006), section I.1.2, eq. 1.5",
};

/// One step on ẍ = −ω²x as a matrix on (x, v): x′ = x + h·v, v′ = v − ω²h·x. Both eigenvalues have
/// the modulus √(1 + ω²h²) > 1: there is no stable step.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    DMat2::from_cols_array_2d(&[[1.0, -omega * omega * dt], [dt, 1.0]])
}

/// Explicit Euler, x ← x + h·v, v ← v + h·a(x_old, v_old).
#[derive(Debug, Clone, Default)]
pub struct ExplicitEuler;

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(ExplicitEuler)
    }
}

remembers_nothing!(ExplicitEuler);

impl Integrator for ExplicitEuler {
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
        begin(&SPEC, dynamics, state, forces, dt, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_suited(&SPEC, forces, dt)?;
        sweeps::drift(&mut state.positions, &state.velocities, dt);
        sweeps::kick(&mut state.velocities, &state.forces, &dynamics.masses, dt);
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        Ok(StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        })
    }
}
