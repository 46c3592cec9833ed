//! Leapfrog: velocities live at half steps and positions leap over them.

use lennard_core::parallel::for_each_piece_pair;
use lennard_core::{
    DVec3, Dynamics, ForceProvider, Integrator, IntegratorSpec, Persist, RestoreError, State,
    StateReader, StateWriter, StepError, StepReport, Want, sweeps,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, begin, check_suited, evaluate, tick};
use crate::velocity_verlet::oscillator_map;

/// Options of leapfrog: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What leapfrog declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "leapfrog",
    summary: "Leapfrog with velocities at half steps; publishes the velocity of the whole step.",
    equations: "v(t+h/2) = v(t-h'/2) + (h'+h)/2 a(t), with h' the step before; x(t+h) = x(t) + h v(t+h/2); published: v(t+h) = v(t+h/2) + (h/2) a(t+h)",
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
    source: "Hockney and Eastwood, \"Computer Simulation Using Particles\", McGraw-Hill (1981), section 4-4; Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed. (2006), section I.1.4",
};

/// Leapfrog; remembers v(t − h/2) and h.
#[derive(Debug, Clone, Default)]
pub struct Leapfrog {
    half_step_velocities: Vec<DVec3>,
    last_dt: f64,
}

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(Leapfrog::default())
    }
}

impl Persist for Leapfrog {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_vec3("half_step_velocities", &self.half_step_velocities);
        to.put_f64("last_dt", &[self.last_dt]);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.half_step_velocities = from.vec3("half_step_velocities")?.to_vec();
        [self.last_dt] = from.f64s("last_dt")?;
        Ok(())
    }
}

impl Integrator for Leapfrog {
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
        begin(&SPEC, dynamics, state, forces, dt, want)?;
        self.half_step_velocities.clone_from(&state.velocities);
        sweeps::kick(
            &mut self.half_step_velocities,
            &state.forces,
            &dynamics.masses,
            -0.5 * dt,
        );
        self.last_dt = dt;
        Ok(())
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
        sweeps::kick_and_drift(
            &mut state.positions,
            &mut self.half_step_velocities,
            &state.forces,
            &dynamics.masses,
            0.5 * (self.last_dt + dt),
            dt,
        );
        self.last_dt = dt;
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        let accelerations = &state.forces;
        for_each_piece_pair(
            &mut state.velocities,
            &mut self.half_step_velocities,
            |first, published, half| {
                for (i, (v, u)) in published.iter_mut().zip(half).enumerate() {
                    let m = dynamics.masses.of(first + i);
                    *v = *u + (0.5 * dt / m) * accelerations[first + i];
                }
            },
        );
        Ok(StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        })
    }
}
