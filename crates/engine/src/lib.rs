//! From a scene to results: initial conditions, the main loop, the watchdog, files and the run record.

mod bare;
mod baths;
mod beginning;
mod build;
mod checkpointing;
mod close_pairs;
mod compare;
mod compare_at_pressure;
mod confinement;
mod curvature;
mod energy;
mod error;
mod failure;
mod files;
mod findings;
mod follower;
mod force_check;
mod from_memory;
mod growing_scenes;
mod growth;
mod in_memory;
pub mod initial;
mod instant;
mod jump;
mod main_loop;
mod moment;
mod names;
mod own;
mod own_in_stages;
mod plan;
mod pressure;
mod record;
mod resume;
mod run;
mod saved;
mod schedule;
mod simulation;
mod species;
mod stage;
mod starting_molecules;
mod timers;
mod watch;
pub mod watchdog;

pub use bare::{ENDLESS, bare, measured_stage, take};
pub use baths::held_temperature;
pub use beginning::{Beginning, SMALLEST_START_DISTANCE, begin, size_and_density};
pub use build::{conditions, forces, prepare, prepare_from, prepare_with, recommended_threads};
pub use checkpointing::{Past, capture, snapshot};
pub use compare::{
    Compared, Comparison, beside_equation_of_state, model_kind, with_equation_of_state,
};
pub use compare_at_pressure::at_constant_pressure;
pub use confinement::Confinement;
pub use energy::{EnergyReport, Evaluated, KineticSource, evaluate_energy};
pub use error::{EngineError, ResumeError};
pub use failure::{PhysicsFailure, Symptom};
pub use files::{Marks, RunFiles, discard};
pub use follower::{Follower, StopAt, Unfollowed, Verdict};
pub use force_check::{ForceCheck, Seen};
pub use from_memory::write_start;
pub use growing_scenes::{
    Addition, ended, from_text, planned_stages, planned_steps, planned_text, prolonged, with_stage,
};
pub use growth::Measurement;
pub use in_memory::{KeptFrame, MemoryOptions, Recording, run_in_memory};
pub use moment::Moment;
pub use own::OwnParts;
pub use plan::{Plan, PlanItem, plan, watching_seconds};
pub use resume::{ResumeOptions, Resumed, restored, restored_with, resume, resume_with, way_on};
pub use run::{Ending, Instantaneous, Outcome, Progress, RunOptions, go_on, run};
pub use schedule::{Action, Observer, Operation, SET_ASIDE_EVERY, Schedule, Trigger};
pub use simulation::{Simulation, StageRun};
pub use timers::Timers;
