//! Velocity Verlet in its four-step form: half kick, drift, force, half kick.

use glam::DMat2;
use lennard_core::{
    ForceProperties, Integrator, IntegratorSpec, Method, Step, StepError, System,
    remembers_nothing, rigid_bonds_alone,
};

use crate::methods::MethodOptions;

lennard_core::options! {
    /// Options of velocity Verlet: there are none.
    pub struct Options {}
}

/// What Verlet's family of methods declares; another method names where it differs.
pub const VERLET: IntegratorSpec = IntegratorSpec {
    name: "",
    summary: "",
    equations: "",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    conserves_momentum: true,
    half_kicks: true,
    is_kick_drift_kick: false,
    holds_rigid_bonds: false,
    on_ranks: true,
    force_evaluations: 1,
    stability_limit: Some(2.0),
    oscillator_map: Some(oscillator_map),
    source: "",
};

/// What velocity Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "velocity-verlet",
    summary: "Velocity Verlet in its four-step form: half kick, drift, force, half kick.",
    equations: "v(t+h/2) = v(t) + (h/2) a(t); x(t+h) = x(t) + h v(t+h/2); v(t+h) = v(t+h/2) + (h/2) a(t+h)",
    is_kick_drift_kick: true,
    holds_rigid_bonds: true,
    source: "Swope, Andersen, Berens and Wilson, \"A computer simulation method for the calculation of equilibrium constants\", J. Chem. Phys. 76, 637 (1982)",
    ..VERLET
};

/// One step on ẍ = −ω²x as a matrix on (x, v), with q = (ωh)²:
/// x′ = (1 − q/2)·x + h·v, v′ = −ω²h·(1 − q/4)·x + (1 − q/2)·v.
///
/// It is the map of every method that equals kick-drift-kick.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    let q = (omega * dt).powi(2);
    let diagonal = 1.0 - 0.5 * q;
    DMat2::from_cols_array_2d(&[[diagonal, -omega * omega * dt * (1.0 - 0.25 * q)], [dt, diagonal]])
}

/// Velocity Verlet, v ← v + ½h·a, x ← x + h·v, v ← v + ½h·a.
#[derive(Debug, Clone, Default)]
pub struct VelocityVerlet;

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(VelocityVerlet)
    }
}

remembers_nothing!(VelocityVerlet);

impl Method for VelocityVerlet {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    /// Kicks and drifts hold rigid bonds: with them this is RATTLE.
    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        rigid_bonds_alone(system)
    }

    fn takes_hard_walls(&self) -> bool {
        true
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.kick(0.5);
        s.drift(1.0);
        s.forces()?;
        s.kick(0.5);
        Ok(())
    }
}
