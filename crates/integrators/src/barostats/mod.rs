//! Barostats, one file each: operators that change the box so that the pressure is held.

mod box_move;
mod list;
mod parts;

pub mod mtk;
pub mod stochastic_cell_rescaling;

pub use stochastic_cell_rescaling::dof_of_centers;

pub use list::{BarostatOptions, barostats};
pub use parts::Coupling;
