//! Störmer–Verlet for a step that changes, in its more exact form.

use lennard_core::{
    Dynamics, ForceProvider, Integrator, IntegratorSpec, Persist, RestoreError, State, StateReader,
    StateWriter, StepError, StepReport, Want,
};
use serde::{Deserialize, Serialize};

use crate::common::Method;
use crate::stormer_verlet::{Recurrence, StepRule};
use crate::velocity_verlet::oscillator_map;

/// Options of this rule: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What this rule declares about itself. With
/// v(t) = (x − x⁻)/h′ + ½h′·a it is velocity Verlet for any sequence of steps.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "stormer-verlet-variable",
    summary: "Störmer–Verlet for a step that changes, of second order throughout.",
    equations: "x(t+h) = x(t) + (x(t) - x(t-h')) h/h' + (h + h')/2 h a(t), with h' the step before; published: v(t) = (x(t) - x(t-h'))/h' + (h'/2) a(t)",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    has_memory: true,
    conserves_momentum: true,
    half_kicks: true,
    force_evaluations: 1,
    stability_limit: Some(2.0),
    oscillator_map: Some(oscillator_map),
    source: "Störmer–Verlet for a step that changes: methods A4 of the article on Verlet integration, Wikipedia, section \"Non-constant time differences\"",
};

/// The more exact rule, x ← x + (x − x⁻)·(h/h⁻) + a·½(h + h⁻)·h.
#[derive(Debug, Clone)]
pub struct StormerVariable {
    recurrence: Recurrence,
}

impl Default for StormerVariable {
    fn default() -> Self {
        Self {
            recurrence: Recurrence::new(StepRule::MoreExact, &SPEC),
        }
    }
}

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(StormerVariable::default())
    }
}

impl Persist for StormerVariable {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.recurrence.save(to);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.recurrence.restore(from)
    }
}

impl Integrator for StormerVariable {
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
        self.recurrence.start(dynamics, state, forces, dt, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        self.recurrence.step(dynamics, state, forces, dt, want)
    }
}
