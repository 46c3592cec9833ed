//! Many state points from one file, side by side, and what they say together.

mod agreement;
mod arrhenius;
mod averaged;
mod coexistence;
mod collect;
mod critical;
mod equations;
mod figures;
mod file;
mod isotherms;
mod melting;
mod page;
mod plan;
mod point_table;
mod points;
mod properties;
mod ran;
mod run;
mod script;
mod side_by_side;
mod threads;

use std::path::PathBuf;

use lennard_scene::Name;

pub use agreement::{Agreement, agreement, probability_words};
pub use collect::collect;
pub use critical::CriticalEstimate;
pub use file::{SweepError, load, plan};
pub use melting::MeltingEstimate;
pub use page::{CHI_SQUARED, agreement_table};
pub use plan::Plan;
pub use point_table::{narrow_point_table, point_table};
pub use points::{PlannedPoint, Point, Setting};
pub use ran::Failed;
pub use run::{Ending, FILES, SweepOptions, SweepRecord, SweptPoint, ending_of, run, run_points};
pub use script::{Scheduler, Script};
pub use threads::workers;

/// A sweep, read and checked.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// The file of its base scene.
    pub base: PathBuf,
    /// Its points, in the order of the file.
    pub points: Vec<Point>,
}
