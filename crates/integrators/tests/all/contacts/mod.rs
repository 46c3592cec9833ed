//! Tests of contacts from outside: springs, dashpots, impacts, and bodies at rest.

mod bonds;
pub(crate) mod common;
mod hard;
mod molecules;
mod soft;
mod unilateral;
