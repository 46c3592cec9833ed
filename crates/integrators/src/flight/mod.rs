//! Flights: how particles move between kicks where they meet walls or each other.
//!
//! [`Obstacles`] is the force term and the boundary of all walls and contacts. One event loop (`events`) takes units from event to
//! event. A unit is a particle on a line or a parabola, a hard body among others, or a molecule whose bonds are held.

pub(crate) mod events;
mod lines;
mod molecules;
mod obstacles;
mod particles;

pub use obstacles::Obstacles;
