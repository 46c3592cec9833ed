//! Tests of contacts from outside: springs, dashpots, impacts, and bodies at rest.

mod bonds;
mod common;
mod hard;
mod molecules;
mod soft;
mod unilateral;
