//! The speed limit of the pair loops at a level.

use glam::DVec2;

use super::arithmetic::arithmetic;
use super::by_level::by_level;
use super::level::Level;
use crate::options::Precision;

/// The arithmetic of pairs of 12-6 with everything in registers; see [`super::arithmetic::arithmetic`].
pub fn limit(level: Level, precision: Precision, r_cut: f64, rounds: u64) -> (u64, f64) {
    by_level!(level, limit(r_cut, rounds, precision), arithmetic::<DVec2>((), r_cut, rounds))
}
