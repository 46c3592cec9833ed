//! Many points from one study file, side by side, and what they say together.

mod csv;
mod error;
mod load;
mod page;
mod plan;
mod point_run;
mod record;
mod run;
mod script;
mod swept;

pub use error::SweepError;
pub use load::{chart, load, over, plan, stability};
pub use plan::{LeftOut, Plan, PlannedPoint, Point, Setting, SettingValue, Sweep};
pub use point_run::{SweepOptions, workers};
pub use record::files;
pub use run::{collect, ending_of, run, run_points};
pub use script::{Scheduler, Script};
pub use swept::{Ending, Failed, SweepRecord, SweptPoint};
