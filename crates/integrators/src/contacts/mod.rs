//! Contacts between bodies: each particle is a sphere, and two of them touch where their centres are nearer than a distance.
//!
//! Soft contacts are springs, which are forces, with dashpots, which act in flights. Hard contacts are impacts in flights.
//! Contacts of SPOOK are unilateral constraints, for which the step of SPOOK solves before it drifts.
//! [`Contacts`] is their force term. [`crate::Obstacles`] holds it beside walls, and is the boundary of flights.

pub(crate) mod bodies;
pub(crate) mod dashpots;
mod kinds;
pub(crate) mod near;
mod term;

pub use bodies::Bodies;
pub use kinds::{ContactOptions, ContactSpec, Response, contacts};
pub use term::{ContactReading, Contacts};
