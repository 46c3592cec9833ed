//! From a scene to results: initial conditions, the main loop, the watchdog, files and the run record.

mod bare;
mod build;
mod checkpointing;
mod compare;
mod energy;
mod error;
mod files;
mod findings;
mod force_check;
pub mod initial;
mod instant;
mod plan;
mod recall;
mod record;
mod resume;
mod run;
mod simulation;
mod timers;
pub mod watchdog;

pub use bare::{ENDLESS, bare, measured_stage, take};
pub use build::{
    Beginning, SMALLEST_START_DISTANCE, begin, conditions, forces, held_temperature, prepare,
    prepare_from, recommended_threads, size_and_density, tail_correction,
};
pub use checkpointing::{Past, capture};
pub use compare::{
    Compared, Comparison, beside_equation_of_state, finite_size, model_kind, with_equation_of_state,
};
pub use energy::{EnergyReport, Evaluated, KineticSource, evaluate_energy};
pub use error::EngineError;
pub use files::{Marks, RunFiles, discard};
pub use force_check::{ForceCheck, Seen};
pub use plan::{Plan, PlanItem, plan, watching_seconds};
pub use resume::{ResumeError, ResumeOptions, Resumed, resume, way_on};
pub use run::{Ending, Outcome, Progress, RunOptions, SET_ASIDE_EVERY, go_on, run};
pub use simulation::{Follower, Nobody, Observer, Simulation, StageRun, Verdict};
pub use timers::Timers;
