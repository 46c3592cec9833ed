//! From a scene to results: initial conditions, the main loop, the watchdog, files and the run record.

mod baths;
mod build;
mod checkpointing;
mod close_pairs;
mod confinement;
mod course;
mod curvature;
mod energy;
mod error;
mod failure;
mod files;
mod findings;
mod follower;
mod foresight;
mod from_frames;
mod instant;
mod main_loop;
mod measure;
mod names;
mod own;
mod plan;
mod planar_tail;
mod pressure;
mod ranks;
mod record;
mod resume;
mod room;
mod run;
mod schedule;
mod session;
mod simulation;
mod start;
pub mod stopwatch;
mod together;
mod watch;
pub mod watchdog;

pub use baths::held_temperature;
pub use build::{
    conditions, forces, prepare, prepare_from, prepare_on, prepare_with, recommended_threads,
};
pub use checkpointing::{Past, capture, snapshot};
pub use confinement::Confinement;
pub use energy::{EnergyReport, Evaluated, KineticSource, evaluate_energy};
pub use error::{EngineError, RanksError, ResumeError, StartError, Unfit, again};
pub use failure::{PhysicsFailure, Symptom};
pub use files::{Marks, RunFiles};
pub use follower::{
    Control, ENDLESS, Ending, Follower, Progress, StopAt, Unfollowed, bare, measured_stage, take,
};
pub use instant::Moment;
pub use measure::{Measurement, Trajectory};
pub use own::OwnParts;
pub use plan::{Network, OnRanks, PATIENCE, Plan, PlanItem, Ranks, plan, watching_seconds};
pub use resume::{ResumeOptions, Resumed, restored, resume, resume_on, way_on};
pub use room::NoRoom;
pub use run::{Outcome, go_on, run};
pub use schedule::{Action, Observer, Operation, SET_ASIDE_EVERY, Schedule, Trigger};
pub use session::{Addition, text_to_run};
pub use simulation::{Recording, Results, Simulation, StageRun, Threads, Timers};
pub use start::{
    SMALLEST_START_DISTANCE, Start, size_and_density, start, start_from_arrays, thermal_velocities,
    write_start,
};
pub use watchdog::{ForceCheck, Seen};
