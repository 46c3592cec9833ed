//! Studies:
//!
//! - speed of the parts of a step
//! - stability of every integrator, on the oscillator and on the fluid
//! - constraints and collisions
//! - speed against accuracy
//! - sweeps over state points
//! - finished runs beside the literature, and the page of a run
//!
//! A study is data first: it runs and keeps every number that it found. It is then written as CSV,
//! JSON, SVG and one self-contained page.

pub mod bench;
pub mod chart;
pub mod claims;
pub mod compare;
pub mod eos;
mod error;
mod files;
mod fluid;
mod jobs;
pub mod lab;
mod lists;
pub mod mechanics;
pub mod readings;
pub mod report;
pub mod run_page;
pub mod settings;
pub mod stability;
pub mod sweep;
#[cfg(test)]
mod testing;
pub mod tune;

pub use error::StudyError;
pub use files::{Study, StudyOptions};
pub use fluid::FluidStudy;
pub use jobs::{Progress, Silent};
