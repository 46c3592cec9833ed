//! Tests of equations of state and tables against published numbers.

mod coexistence;
mod equations;
mod one_fluid;
mod properties;
mod tables;
mod two_center;
mod virial;

use lennard_literature::{EquationOfState, list};

/// The equations that have a liquid.
fn with_liquid() -> impl Iterator<Item = &'static dyn EquationOfState> {
    list().into_iter().filter(|e| e.spec().range.rho_max.is_none())
}
