//! Explicit Euler: position and velocity both advance with what was known at the start of the step.

use glam::DMat2;
use lennard_core::{Integrator, IntegratorSpec, Method, Step, StepError, remembers_nothing};

use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of explicit Euler: there are none.
    pub struct Options {}
}

/// What explicit Euler declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "explicit-euler",
    summary: "Explicit Euler: drift with the old velocity, kick with the old force; grows without bound on every oscillator.",
    equations: "x(t+h) = x(t) + h v(t); v(t+h) = v(t) + h a(t)",
    position_order: 1,
    velocity_order: 1,
    symplectic: false,
    reversible: false,
    velocity_dependent_forces: true,
    half_kicks: false,
    stability_limit: Some(0.0),
    oscillator_map: Some(oscillator_map),
    source: "Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed., Springer (2006), section I.1.2, eq. 1.5",
    ..VERLET
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

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(ExplicitEuler)
    }
}

remembers_nothing!(ExplicitEuler);

impl Method for ExplicitEuler {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        // The kick takes the forces of the old positions, which the drift leaves as they are.
        s.drift(1.0);
        s.kick(1.0);
        s.forces()
    }
}
