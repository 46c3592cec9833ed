//! Velocity Verlet in its short form, with both forces in one velocity update.

use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::{
    DVec3, Dynamics, ForceProvider, Integrator, IntegratorSpec, State, StepError, StepReport, Want,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, begin, check_suited, evaluate, remembers_nothing, tick};
use crate::velocity_verlet::oscillator_map;

/// Options of short velocity Verlet: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What the short form of velocity Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "velocity-verlet-short",
    summary: "Velocity Verlet in its short form: position by a Taylor step, velocity by the mean of both forces.",
    equations: "x(t+h) = x(t) + h v(t) + (h^2/2) a(t); v(t+h) = v(t) + (h/2) (a(t) + a(t+h))",
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

/// Velocity Verlet, x ← x + h·v + ½h²·a, v ← v + ½h·(a_old + a_new): Newmark's method with β = 0, γ = ½.
#[derive(Debug, Clone, Default)]
pub struct VelocityVerletShort {
    /// Working space inside a step, nothing that outlives it.
    old_forces: Vec<DVec3>,
}

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(VelocityVerletShort::default())
    }
}

remembers_nothing!(VelocityVerletShort);

impl Integrator for VelocityVerletShort {
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
        self.old_forces.clone_from(&state.forces);
        let old_forces = &self.old_forces;
        for_each_piece_pair(
            &mut state.positions,
            &mut state.velocities,
            |first, xs, vs| {
                for (i, (x, v)) in xs.iter_mut().zip(vs).enumerate() {
                    let i = first + i;
                    let a = old_forces[i] / dynamics.masses.of(i);
                    *x += dt * *v + (0.5 * dt * dt) * a;
                }
            },
        );
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        let new_forces = &state.forces;
        for_each_piece(&mut state.velocities, |first, vs| {
            for (i, v) in vs.iter_mut().enumerate() {
                let i = first + i;
                *v += (0.5 * dt / dynamics.masses.of(i)) * (old_forces[i] + new_forces[i]);
            }
        });
        Ok(StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        })
    }
}
