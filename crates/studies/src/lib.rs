//! Studies: stability of every integrator, on the oscillator and on the fluid.
//!
//! A study is data first: it runs, keeps what it found with every number, and is then written as CSV,
//! JSON, SVG and one self-contained page.

pub mod claims;
mod error;
mod files;
pub mod fluid_stability;
mod jobs;
mod progress;
pub mod stability;

pub use error::StudyError;
pub use progress::{Progress, Silent};
