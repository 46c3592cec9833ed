//! Tests of flights from outside: walls, springs, dashpots, impacts, and bodies at rest.

mod bonds;
pub(crate) mod common;
mod hard;
mod molecules;
mod soft;
mod unilateral;
mod walls;
