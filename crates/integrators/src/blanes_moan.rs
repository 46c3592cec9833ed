//! The six-stage fourth-order method of Blanes and Moan for accelerations that depend on positions alone.

use lennard_core::{Integrator, IntegratorSpec};

use crate::composition::Composition;
use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of the method of Blanes and Moan: there are none.
    pub struct Options {}
}

/// What the method of Blanes and Moan declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "blanes-moan",
    summary: "Fourth-order symplectic with six stages and a very small error: the most accurate of the list for each evaluation.",
    equations: "kicks b1 b2 b3 b4 b3 b2 b1 alternate with drifts a1 a2 a3 a3 a2 a1, as fractions of h",
    position_order: 4,
    velocity_order: 4,
    half_kicks: false,
    force_evaluations: 6,
    stability_limit: Some(3.163_465),
    oscillator_map: Some(|omega, dt| COMPOSITION.oscillator_map(omega, dt)),
    source: "Blanes and Moan, \"Practical symplectic partitioned Runge-Kutta and Runge-Kutta-Nyström methods\", J. Comput. Appl. Math. 142, 313 (2002), table 3, SRKN6b of order 4",
    ..VERLET
};

const B1: f64 = 0.082_984_406_417_405_2;
const B2: f64 = 0.396_309_801_498_368;
const B3: f64 = -0.039_056_304_922_348_6;
const B4: f64 = 1.0 - 2.0 * (B1 + B2 + B3);
const A1: f64 = 0.245_298_957_184_271;
const A2: f64 = 0.604_872_665_711_080;
const A3: f64 = 0.5 - (A1 + A2);

/// The six-stage method of order 4 for ẍ = a(x), which begins and ends with a kick.
static COMPOSITION: Composition = Composition {
    spec: &SPEC,
    stages: &[(B1, A1), (B2, A2), (B3, A3), (B4, A3), (B3, A2), (B2, A1)],
    last_kick: B1,
};

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(&COMPOSITION)
    }
}
