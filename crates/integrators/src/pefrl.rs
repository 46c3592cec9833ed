//! PEFRL: the position-extended, optimised relative of Forest–Ruth, with a far smaller error.

use lennard_core::{Integrator, IntegratorSpec};

use crate::composition::Composition;
use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of PEFRL: there are none.
    pub struct Options {}
}

/// What PEFRL declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "pefrl",
    summary: "Fourth-order symplectic, optimised (position-extended Forest–Ruth-like); the fifth force evaluation publishes the forces at the new positions.",
    equations: "x += xi h v; v += (1-2L) h/2 a; x += chi h v; v += L h a; x += (1-2(chi+xi)) h v; v += L h a; x += chi h v; v += (1-2L) h/2 a; x += xi h v",
    position_order: 4,
    velocity_order: 4,
    half_kicks: false,
    force_evaluations: 5,
    stability_limit: Some(2.989_450),
    oscillator_map: Some(|omega, dt| COMPOSITION.oscillator_map(omega, dt)),
    source: "Omelyan, Mryglod and Folk, \"Optimized Forest-Ruth- and Suzuki-like algorithms for integration of motion in many-body systems\", Comput. Phys. Commun. 146, 188 (2002), PEFRL",
    ..VERLET
};

const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

/// PEFRL: begins and ends with a drift, so that forces at the published positions need an evaluation
/// of their own.
static COMPOSITION: Composition = Composition {
    spec: &SPEC,
    stages: &[
        (0.0, XI),
        (0.5 * (1.0 - 2.0 * LAMBDA), CHI),
        (LAMBDA, 1.0 - 2.0 * (CHI + XI)),
        (LAMBDA, CHI),
        (0.5 * (1.0 - 2.0 * LAMBDA), XI),
    ],
    last_kick: 0.0,
};

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(&COMPOSITION)
    }
}
