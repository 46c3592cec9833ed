//! Velocity Verlet in its four-step form: half kick, drift, force, half kick.

use glam::DMat2;
use lennard_core::{
    Dynamics, ForceProvider, Integrator, IntegratorSpec, State, StepError, StepReport, Stride,
    Want, sweeps,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, begin, check_suited, evaluate, remembers_nothing, tick};

/// Options of velocity Verlet: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What velocity Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "velocity-verlet",
    summary: "Velocity Verlet in its four-step form: half kick, drift, force, half kick.",
    equations: "v(t+h/2) = v(t) + (h/2) a(t); x(t+h) = x(t) + h v(t+h/2); v(t+h) = v(t+h/2) + (h/2) a(t+h)",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    has_memory: false,
    conserves_momentum: true,
    half_kicks: true,
    force_evaluations: 1,
    stability_limit: Some(2.0),
    oscillator_map: Some(oscillator_map),
    source: "Swope, Andersen, Berens and Wilson, \"A computer simulation method for the calculation of equilibrium constants\", J. Chem. Phys. 76, 637 (1982)",
};

/// One step on ẍ = −ω²x as a matrix on (x, v), with q = (ωh)²:
/// x′ = (1 − q/2)·x + h·v, v′ = −ω²h·(1 − q/4)·x + (1 − q/2)·v.
///
/// It is the map of every method that equals kick-drift-kick.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    let q = (omega * dt).powi(2);
    let diagonal = 1.0 - 0.5 * q;
    DMat2::from_cols_array_2d(&[
        [diagonal, -omega * omega * dt * (1.0 - 0.25 * q)],
        [dt, diagonal],
    ])
}

/// Velocity Verlet, v ← v + ½h·a, x ← x + h·v, v ← v + ½h·a.
#[derive(Debug, Clone, Default)]
pub struct VelocityVerlet;

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(VelocityVerlet)
    }
}

remembers_nothing!(VelocityVerlet);

impl Integrator for VelocityVerlet {
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
        let (_, report) = self.stride(dynamics, state, forces, dt, 1, want)?;
        Ok(report)
    }

    fn stride(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        steps: u64,
        want: Want,
    ) -> Result<(u64, StepReport), StepError> {
        check_suited(&SPEC, forces, dt)?;
        sweeps::kick_and_drift(
            &mut state.positions,
            &mut state.velocities,
            &state.forces,
            &dynamics.masses,
            0.5 * dt,
            dt,
        );
        tick(state, dt);
        // Force, two half kicks and drift, as often as the forces can do it in one go.
        let between = forces.stride(Stride {
            positions: &mut state.positions,
            velocities: &mut state.velocities,
            masses: &dynamics.masses,
            dt,
            steps: steps - 1,
        });
        for _ in 0..between {
            tick(state, dt);
        }
        let taken = between + 1;
        let want = if taken == steps { want } else { Want::NOTHING };
        evaluate(&SPEC, state, forces, want)?;
        sweeps::kick(
            &mut state.velocities,
            &state.forces,
            &dynamics.masses,
            0.5 * dt,
        );
        let report = StepReport {
            force_evaluations: taken as u32,
            ..StepReport::default()
        };
        Ok((taken, report))
    }
}
