//! Many points from one study file, side by side, and what they say together.

mod error;
mod load;
mod plan;
mod record;
mod run;
mod script;
mod swept;

pub use error::SweepError;
pub use load::{load, of_command, over, plan};
pub use plan::{LeftOut, Plan, PlannedPoint, Point, Setting, SettingValue, Sweep};
pub use record::files;
pub use run::{SweepOptions, collect, ending_of, run, run_points, workers};
pub use script::{Scheduler, Script};
pub use swept::{Ending, Failed, StudyPoints, SweepRecord, SweptPoint};
