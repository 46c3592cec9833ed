//! Contacts between bodies: each particle is a sphere, and two of them touch where their centres are nearer than a distance.
//!
//! Soft contacts are springs, which are forces, with dashpots, which act in flights. Hard contacts are impacts in flights.
//! Contacts of SPOOK are unilateral constraints, for which the step of SPOOK solves before it drifts.
//! [`Contacts`] is the force term of both, and the boundary of flights. It owns the walls of the scene, since a flight meets
//! other bodies and walls in one order of time.

pub(crate) mod bodies;
mod dashpots;
pub(crate) mod impacts;
mod kinds;
mod molecules;
pub(crate) mod near;
mod term;

pub use bodies::Bodies;
pub use kinds::{ContactOptions, ContactSpec, Response, contacts};
pub use molecules::MoleculesAtWalls;
pub use term::{ContactReading, Contacts};
