//! Many state points from one file, side by side, and what they say together.

mod agreement;
mod file;
mod isotherms;
mod page;
mod points;
mod ran;
mod run;
mod side_by_side;
mod threads;

use std::path::PathBuf;

pub use agreement::{Agreement, agreement, probability_words};
pub use file::{SweepError, load};
pub use page::{CHI_SQUARED, agreement_table, point_table};
pub use points::Point;
pub use run::{Ending, FILES, SweepOptions, SweepRecord, SweptPoint, run};
pub use threads::workers;

/// A sweep, read and checked.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Its name; the file's stem unless the file gives another.
    pub name: String,
    /// The file of its base scene.
    pub base: PathBuf,
    /// Its points, in the order of the file.
    pub points: Vec<Point>,
}
