//! Symplectic Euler, also called semi-implicit: the velocity first, then the position with the new velocity.

use glam::DMat2;
use lennard_core::{Integrator, IntegratorSpec, Method, Step, StepError, remembers_nothing};

use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of symplectic Euler: there are none.
    pub struct Options {}
}

/// What symplectic Euler declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "symplectic-euler",
    summary: "Symplectic (semi-implicit) Euler: kick by the whole step, then drift with the new velocity.",
    equations: "v(t+h) = v(t) + h a(t); x(t+h) = x(t) + h v(t+h)",
    position_order: 1,
    velocity_order: 1,
    reversible: false,
    velocity_dependent_forces: true,
    half_kicks: false,
    oscillator_map: Some(oscillator_map),
    source: "Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed., Springer (2006), section I.1.2, eq. 1.9",
    ..VERLET
};

/// One step on ẍ = −ω²x as a matrix on (x, v): v′ = v − ω²h·x, x′ = x + h·v′.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    let kick = -omega * omega * dt;
    DMat2::from_cols_array_2d(&[[1.0 + dt * kick, kick], [dt, 1.0]])
}

/// Symplectic Euler, v ← v + h·a, x ← x + h·v.
#[derive(Debug, Clone, Default)]
pub struct SymplecticEuler;

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(SymplecticEuler)
    }
}

remembers_nothing!(SymplecticEuler);

impl Method for SymplecticEuler {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn takes_hard_walls(&self) -> bool {
        true
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.kick(1.0);
        s.drift(1.0);
        s.forces()
    }
}
