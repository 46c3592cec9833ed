//! Barostats, one file each: operators that change the box so that the pressure is held.

mod list;

pub mod mtk;
pub mod stochastic_cell_rescaling;

pub use list::{BarostatOptions, Coupling, barostats};
