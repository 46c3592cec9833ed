//! The fourth-order symplectic method of Forest and Ruth: three velocity Verlet steps, the middle one backwards.

use lennard_core::{Integrator, IntegratorSpec};

use crate::composition::Composition;
use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of Forest–Ruth: there are none.
    pub struct Options {}
}

/// What the method of Forest and Ruth declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "forest-ruth",
    summary: "Fourth-order symplectic: three velocity Verlet steps of θh, (1−2θ)h and θh with θ = 1/(2 − 2^(1/3)).",
    equations: "VV(theta h), VV((1 - 2 theta) h), VV(theta h), with VV a velocity Verlet step and theta = 1/(2 - 2^(1/3))",
    position_order: 4,
    velocity_order: 4,
    half_kicks: false,
    force_evaluations: 3,
    stability_limit: Some(1.573_402),
    oscillator_map: Some(|omega, dt| COMPOSITION.oscillator_map(omega, dt)),
    source: "Forest and Ruth, \"Fourth-order symplectic integration\", Physica D 43, 105 (1990)",
    ..VERLET
};

/// θ = 1/(2 − ∛2), which removes the error of third order from three steps in a row.
const THETA: f64 = 1.351_207_191_959_657_7;

/// Forest–Ruth, in the form that begins and ends with a kick.
static COMPOSITION: Composition = Composition {
    spec: &SPEC,
    stages: &[
        (0.5 * THETA, THETA),
        (0.5 * (1.0 - THETA), 1.0 - 2.0 * THETA),
        (0.5 * (1.0 - THETA), THETA),
    ],
    last_kick: 0.5 * THETA,
};

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(&COMPOSITION)
    }
}
