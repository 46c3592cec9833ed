//! Störmer–Verlet for a step that changes, in its more exact form.

use lennard_core::{Integrator, IntegratorSpec};

use crate::methods::MethodOptions;
use crate::stormer_verlet::{Recurrence, StepRule};
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of this rule: there are none.
    pub struct Options {}
}

/// What this rule declares about itself. With
/// v(t) = (x − x⁻)/h′ + ½h′·a it is velocity Verlet for any sequence of steps.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "stormer-verlet-variable",
    summary: "Störmer–Verlet for a step that changes, of second order throughout.",
    equations: "x(t+h) = x(t) + (x(t) - x(t-h')) h/h' + (h + h')/2 h a(t), with h' the step before; published: v(t) = (x(t) - x(t-h'))/h' + (h'/2) a(t)",
    source: "Störmer–Verlet for a step that changes: article on Verlet integration, Wikipedia, section \"Non-constant time differences\"",
    ..VERLET
};

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(Recurrence::new(StepRule::MoreExact, &SPEC))
    }
}
