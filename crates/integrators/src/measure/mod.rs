//! What methods do, measured: maps, growth, phase, stability limits, orders, and the claims of the
//! literature on the Verlet family. The conformance tests and the stability study both stand on it.
//!
//! Everything here runs the integrators of the list as a simulation does, by `start` and `step`;
//! nothing repeats their formulas.

mod claims;
mod counting;
mod kepler;
mod linear;
mod order;

pub use claims::{
    EnergyError, ExponentialError, OneStepErrors, energy_error, exponential_error, one_step_errors,
    start_orders, variable_step_errors, velocity_estimate_errors,
};
pub use counting::CountingForces;
pub use kepler::{Kepler, KeplerForces};
pub use linear::{
    OscillatorBench, Sample, SearchRange, amplification_per_step, eigenvalues, first_unstable_step,
    measured_map, measured_stability_limit, phase_per_step, theoretical_stability_limit,
};
pub use order::{ErrorPoint, Orders, fitted_order, global_errors, orders};

use lennard_core::{Backend, Integrator, State, StepError, StepReport, System, Want};

/// Starts the method and makes `steps` steps of `dt`, showing the state and the report of each step
/// to `look`.
///
/// # Errors
/// As [`Integrator::start`] and [`Integrator::step`].
pub fn run(
    integrator: &mut Integrator,
    system: &System,
    forces: &mut dyn Backend,
    state: &mut State,
    dt: f64,
    steps: u64,
    mut look: impl FnMut(&State, &StepReport),
) -> Result<(), StepError> {
    integrator.start(system, state, forces, dt, Want::NOTHING)?;
    for _ in 0..steps {
        let report = integrator.step(system, state, forces, dt, Want::NOTHING)?;
        look(state, &report);
    }
    Ok(())
}
