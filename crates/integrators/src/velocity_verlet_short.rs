//! Velocity Verlet in its short form, with both forces in one velocity update.

use lennard_core::parallel::for_each_piece;
use lennard_core::{DVec3, Integrator, IntegratorSpec, Method, Step, StepError, remembers_nothing};

use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of short velocity Verlet: there are none.
    pub struct Options {}
}

/// What the short form of velocity Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "velocity-verlet-short",
    summary: "Velocity Verlet in its short form: position by a Taylor step, velocity by the mean of both forces.",
    equations: "x(t+h) = x(t) + h v(t) + (h^2/2) a(t); v(t+h) = v(t) + (h/2) (a(t) + a(t+h))",
    source: "Swope, Andersen, Berens and Wilson, \"A computer simulation method for the calculation of equilibrium constants\", J. Chem. Phys. 76, 637 (1982)",
    ..VERLET
};

/// Velocity Verlet, x ← x + h·v + ½h²·a, v ← v + ½h·(a_old + a_new): Newmark's method with β = 0, γ = ½.
#[derive(Debug, Clone, Default)]
pub struct VelocityVerletShort {
    /// Working space inside a step, nothing that outlives it.
    old_forces: Vec<DVec3>,
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(VelocityVerletShort::default())
    }
}

remembers_nothing!(VelocityVerletShort { old_forces });

impl Method for VelocityVerletShort {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        let masses = &s.system().masses;
        let state = s.parts().state;
        self.old_forces.clone_from(&state.forces);
        let old_forces = &self.old_forces;
        let velocities = &state.velocities;
        for_each_piece(&mut state.positions, |first, xs| {
            for (i, x) in (first..).zip(xs) {
                let a = old_forces[i] / masses.of(i);
                *x += dt * velocities[i] + (0.5 * dt * dt) * a;
            }
        });
        s.forces()?;
        let state = s.parts().state;
        let new_forces = &state.forces;
        for_each_piece(&mut state.velocities, |first, vs| {
            for (i, v) in (first..).zip(vs) {
                *v += (0.5 * dt / masses.of(i)) * (old_forces[i] + new_forces[i]);
            }
        });
        Ok(())
    }
}
