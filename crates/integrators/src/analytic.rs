//! The exact solution, where one is known: what every other method is measured against.

use glam::DMat2;
use lennard_core::{
    ExactSolution, ForceProperties, Integrator, IntegratorSpec, Method, Parts, Step, StepError,
    System, remembers_nothing,
};

use crate::OscillatorModel;
use crate::methods::MethodOptions;
use crate::oscillator::ExactOscillator;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of the exact solution: there are none.
    pub struct Options {}
}

/// What the exact solution declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "analytic",
    summary: "The exact solution of the equations of motion, where one is known (the oscillator; not a fluid).",
    equations: "x(t+h), v(t+h) = the known solution through x(t), v(t)",
    position_order: 0,
    velocity_order: 0,
    velocity_dependent_forces: true,
    half_kicks: false,
    stability_limit: None,
    oscillator_map: Some(oscillator_map),
    source: "Landau and Lifshitz, \"Mechanics\", 3rd ed. (1976), sections 21 and 25",
    on_ranks: false,
    ..VERLET
};

/// One step on ẍ = −ω²x as a matrix on (x, v): the rotation x′ = x·cos ωh + (v/ω)·sin ωh,
/// v′ = v·cos ωh − xω·sin ωh.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    ExactOscillator::new(omega * omega, 0.0, 1.0).map(dt)
}

/// The solution in [`System::exact`], advanced by h; the forces are evaluated only to be published.
#[derive(Debug, Clone, Default)]
pub struct Analytic;

impl MethodOptions for Options {
    fn oscillator(&self) -> OscillatorModel {
        OscillatorModel::ExactSolution
    }

    fn build(&self) -> Integrator {
        Integrator::new(Analytic)
    }
}

remembers_nothing!(Analytic);

fn solution(system: &System) -> Result<&dyn ExactSolution, String> {
    let known = system.exact.as_deref();
    known.ok_or_else(|| "no exact solution of its motion is known".to_owned())
}

impl Method for Analytic {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        solution(system).map(drop)
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        let Parts { system, state, .. } = s.parts();
        let solution =
            solution(system).map_err(|reason| StepError::Unsuited { method: SPEC.name, reason })?;
        solution.advance(&mut state.positions, &mut state.velocities, dt);
        s.forces()
    }
}
