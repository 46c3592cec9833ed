//! Störmer–Verlet with the last displacement scaled to a step that changes.

use lennard_core::{Integrator, IntegratorSpec};

use crate::methods::MethodOptions;
use crate::stormer_verlet::{Recurrence, StepRule};
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of this rule: there are none.
    pub struct Options {}
}

/// What this rule declares about itself. Its orders hold for a constant step. Each change of the
/// step leaves an error ½·a·(h − h′) in the velocity, so a run with a changing step is of order 1.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "stormer-verlet-time-corrected",
    summary: "Störmer–Verlet whose last displacement is scaled to the new step: usable, but of first order, where the step changes.",
    equations: "x(t+h) = x(t) + (x(t) - x(t-h')) h/h' + h^2 a(t), with h' the step before; published: v(t) = (x(t) - x(t-h'))/h' + (h'/2) a(t)",
    source: "Störmer–Verlet for a step that changes: article on Verlet integration, Wikipedia, section \"Non-constant time differences\"",
    ..VERLET
};

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(Recurrence::new(StepRule::TimeCorrected, &SPEC))
    }
}
