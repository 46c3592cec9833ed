//! A bath at work after a step.

use crate::thermostat::act;
use crate::{BathStep, Moving, Parts, Step, Thermostat};

/// Scales the velocities by the factor of a bath, where it acts after this step, and counts the heat. Returns whether it did.
pub fn couple(bath: &mut dyn Thermostat, s: &mut Step<'_>) -> bool {
    let (n_dof, dt) = (s.n_dof(), s.dt());
    let Parts { system, state, .. } = s.parts();
    if !bath.acts_after(state.step) {
        return false;
    }
    let at =
        BathStep { kinetic: system.kinetic_energy(&state.velocities), n_dof, dt, step: state.step };
    let Some((factor, heat)) = act(bath, at) else {
        return false;
    };
    Moving::of(state).scale(factor);
    s.add_heat(heat);
    true
}
