//! A bath at work after a step.

use crate::thermostat::heat;
use crate::{BathStep, Parts, Step, Thermostat, sweeps};

/// Scales the velocities by the factor of a bath, where it acts after this step, and counts the heat. Returns whether it did.
///
/// A system at rest has no velocities to scale.
pub fn couple(bath: &mut dyn Thermostat, s: &mut Step<'_>) -> bool {
    let (n_dof, dt) = (s.n_dof(), s.dt());
    let Parts { system, state, .. } = s.parts();
    if !bath.acts_after(state.step) {
        return false;
    }
    let kinetic = system.kinetic_energy(&state.velocities);
    if kinetic <= 0.0 {
        return false;
    }
    let factor = bath.factor(BathStep {
        kinetic,
        n_dof,
        dt,
        step: state.step,
    });
    sweeps::scale(&mut state.velocities, factor);
    s.add_heat(heat(factor, kinetic));
    true
}
