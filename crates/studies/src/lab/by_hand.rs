//! A method and forces called by hand, without the engine around them.

use lennard_core::{Integrator, State, StepError, System, Want};
use lennard_forcefield::PairForces;
use lennard_integrators::IntegratorOptions;

/// A fluid at constant energy that nothing observes, watches or couples to a bath.
pub(crate) struct ByHand {
    /// The fluid as it is.
    pub(crate) state: State,
    method: Integrator,
    forces: PairForces,
    system: System,
    dt: f64,
}

impl ByHand {
    /// Starts a method on a state of a system, with time step `dt` in τ.
    pub(crate) fn start(
        integrator: &IntegratorOptions,
        forces: PairForces,
        (system, state): (System, State),
        dt: f64,
    ) -> Result<Self, StepError> {
        let mut fluid =
            Self { system, method: lennard_integrators::build(integrator), forces, state, dt };
        let (state, forces) = (&mut fluid.state, &mut fluid.forces);
        fluid.method.start(&fluid.system, state, forces, dt, Want::NOTHING)?;
        Ok(fluid)
    }

    /// Takes `steps` steps, several in one go where the forces can.
    pub(crate) fn steps(&mut self, steps: u64) -> Result<(), StepError> {
        let mut left = steps;
        while left > 0 {
            let (state, forces) = (&mut self.state, &mut self.forces);
            let (taken, _) =
                self.method.stride(&self.system, state, forces, self.dt, left, Want::NOTHING)?;
            left -= taken;
        }
        Ok(())
    }
}
