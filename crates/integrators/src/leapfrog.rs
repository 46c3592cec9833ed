//! Leapfrog: velocities live at half steps and positions leap over them.

use lennard_core::{
    DVec3, ForceProperties, Integrator, IntegratorSpec, Method, Moving, Parts, Step, StepError,
    System, persist, rigid_bonds_alone,
};

use crate::methods::{MethodOptions, acts_on_bonds};
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of leapfrog: there are none.
    pub struct Options {}
}

/// What leapfrog declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "leapfrog",
    summary: "Leapfrog with velocities at half steps; publishes the velocity of the whole step.",
    equations: "v(t+h/2) = v(t-h'/2) + (h'+h)/2 a(t), with h' the step before; x(t+h) = x(t) + h v(t+h/2); published: v(t+h) = v(t+h/2) + (h/2) a(t+h)",
    holds_rigid_bonds: true,
    source: "Hockney and Eastwood, \"Computer Simulation Using Particles\", McGraw-Hill (1981), section 4-4; Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed. (2006), section I.1.4",
    ..VERLET
};

/// Leapfrog; remembers v(t − h/2) and h.
#[derive(Debug, Clone, Default)]
pub struct Leapfrog {
    half_step_velocities: Vec<DVec3>,
    last_dt: f64,
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(Leapfrog::default())
    }
}

persist!(Leapfrog { half_step_velocities, last_dt });

impl Leapfrog {
    /// The same step by kick and drift of the step itself, which hold bonds.
    fn step_with_bonds(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        let velocities = &mut s.parts().state.velocities;
        velocities.copy_from_slice(&self.half_step_velocities);
        s.kick(0.5 * (self.last_dt + dt) / dt);
        s.drift(1.0);
        self.half_step_velocities.copy_from_slice(&s.parts().state.velocities);
        self.last_dt = dt;
        s.forces()?;
        s.kick(0.5);
        Ok(())
    }
}

impl Method for Leapfrog {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    /// A drift that holds bonds corrects along the bonds before it, whatever the part of v(t − h/2) along them: the bonds of SHAKE.
    /// The published velocity has no part along them.
    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        rigid_bonds_alone(system)
    }

    fn remember(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        self.last_dt = s.dt();
        let Parts { system, state, .. } = s.parts();
        self.half_step_velocities.clone_from(&state.velocities);
        let half_back = -0.5 * self.last_dt;
        let velocities = &mut self.half_step_velocities;
        let moving = Moving { velocities, ..Moving::of(state) };
        moving.kick(&system.masses, half_back);
        Ok(())
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        if acts_on_bonds(s.system()) {
            return self.step_with_bonds(s);
        }
        let masses = &s.system().masses;
        let state = s.parts().state;
        let velocities = &mut self.half_step_velocities;
        let moving = Moving { velocities, ..Moving::of(state) };
        moving.kick_and_drift(masses, 0.5 * (self.last_dt + dt), dt);
        self.last_dt = dt;
        s.forces()?;
        let state = s.parts().state;
        state.velocities.clone_from(&self.half_step_velocities);
        Moving::of(state).kick(masses, 0.5 * dt);
        Ok(())
    }
}
