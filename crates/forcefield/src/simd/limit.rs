//! The speed limit of the pair loops at a level.

use super::by_level::by_level;
use super::level::Level;
use crate::options::Precision;
use crate::pair::PairForm;

/// The arithmetic of pairs with everything in registers; see [`super::arithmetic::arithmetic`].
pub fn limit<F: PairForm>(
    level: Level,
    precision: Precision,
    form: &F,
    r_cut: f64,
    rounds: u64,
) -> (u64, f64) {
    by_level!(level, limit(form, r_cut, rounds, precision))
}
