//! The workbench that all studies share: one equilibrated start of a scene, and short runs of it with any settings.
//!
//! [`Workbench::timing`] and [`costs`] say what settings cost. [`Workbench::force_errors`], [`Workbench::measure`],
//! [`Workbench::trajectory_error`] and [`Workbench::reversibility`] say how large their errors are.

mod forces;
mod measured;
mod motion;
mod rig;
mod slopes;
mod stable;
mod start;
mod timing;
mod untruncated;
mod workbench;

pub use forces::ForceErrors;
pub use measured::{AgainstEquation, Measured, mean_of};
pub use motion::TrajectoryError;
pub use rig::Rig;
pub(crate) use rig::drift_of;
pub use slopes::Slopes;
pub(crate) use stable::{rough_stable_dt, stable_dt_of_springs};
pub use start::Start;
pub(crate) use start::{to_temperature, under_bussi};
pub use timing::{Cost, Timing, costs, modelled_work};
pub use untruncated::Untruncated;
pub use workbench::{Failed, TightTrajectory, Workbench};
