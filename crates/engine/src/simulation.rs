//! A simulation: the system, its forces, the stage under way, the observables, and what runs have recorded. Rust, Python and the
//! program share it.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use lennard_core::parallel::{self, PoolError};
use lennard_core::random::Streams;
use lennard_core::{Backend, Integrator, PeriodicBox, State, System, Team};
use lennard_forcefield::{ForceFieldOptions, Mixture, NeighborOptions, Tail};
use lennard_io::{AverageRecord, RunRecord};
use lennard_observables::{Observable, Table, Thermodynamics};
use lennard_scene::{RemovedKind, Scene, Stage, removed};
use rayon::ThreadPool;

use crate::error::EngineError;
use crate::from_frames::FromFrames;
use crate::own::OwnParts;
use crate::schedule::Observer;
use crate::watchdog::ForceCheck;

/// Everything that a run is made of.
pub struct Simulation {
    /// The scene as resolved.
    pub scene: Scene,
    /// Masses and constraints.
    pub system: System,
    /// Box, positions, velocities, forces.
    pub state: State,
    /// The box of the start, which lists and observables were laid out for.
    pub start_cell: PeriodicBox,
    /// The forces.
    pub forces: Box<dyn Backend>,
    /// Forces of a few particles at a time against sums over all pairs.
    pub force_check: ForceCheck,
    /// The list as planned: mode and skin.
    pub list: NeighborOptions,
    /// What the forces are of, which the tail correction follows from.
    pub force_field: ForceFieldOptions,
    /// The pairs of species that the forces are of; `None` where the scene names no species.
    pub mixture: Option<Mixture>,
    /// Random streams of the scene's seed.
    pub streams: Streams,
    /// The stage under way; `None` before the first.
    pub stage: Option<StageRun>,
    /// The observables, sampled in measured stages; thermodynamics is the first.
    pub observers: Vec<Observer>,
    /// Steps since the first measured stage began.
    pub measured_steps: u64,
    /// What is to be known of the start, for the record.
    pub remarks: Vec<String>,
    /// Where the time went.
    pub timers: Timers,
    /// Instruction set of the pair kernel, for the record.
    pub isa: String,
    /// What the program brings beside the scene.
    pub own: OwnParts,
    /// What runs in memory have kept.
    pub recording: Recording,
    /// The frames that states come from; `None` where the simulation moves by itself.
    pub(crate) frames: Option<FromFrames>,
    /// The threads at work; `None` where the caller has threads.
    pub threads: Option<Threads>,
}

/// The stage under way: its integrator, and what its heat bath has put in.
pub struct StageRun {
    /// Index in the scene.
    pub index: usize,
    /// Steps done of it.
    pub steps_done: u64,
    /// Step size in τ.
    pub dt: f64,
    /// The method that advances the state, with the heat bath between its steps.
    pub integrator: Integrator,
    /// Σ heat since the stage began, ε.
    pub heat: f64,
    /// Conserved energy per particle at the start, ε.
    pub start_energy: f64,
    /// c_P = V²·P_tail in ε·σ³ where a barostat changes the box; 0 else.
    pub tail_work: f64,
}

impl Simulation {
    /// The observable of a type, where the scene has it.
    #[must_use]
    pub fn observable<T: Observable>(&self) -> Option<&T> {
        self.observers.iter().find_map(|observer| {
            let any: &dyn Any = observer.observable.as_ref();
            any.downcast_ref()
        })
    }

    /// Thermodynamic averages of the measured stages.
    ///
    /// # Panics
    /// Where the simulation was put together without them: every scene has them.
    #[must_use]
    pub fn thermodynamics(&self) -> &Thermodynamics {
        self.observable().expect("every run measures thermodynamics")
    }

    /// The tail correction in a volume, σ³, if the scene has one: totals of the system.
    #[must_use]
    pub fn tail_in(&self, volume: f64) -> Option<Tail> {
        lennard_forcefield::tail_in(
            &self.force_field,
            self.mixture.as_ref(),
            self.system.len(),
            volume,
        )
    }

    /// The trajectory that states come from; `None` where the simulation moves by itself.
    #[must_use]
    pub fn trajectory(&self) -> Option<&str> {
        self.frames.as_ref().map(|frames| frames.file.as_str())
    }

    /// Whether any stage has a barostat.
    #[must_use]
    pub fn box_changes(&self) -> bool {
        self.scene.stages.iter().any(|s| s.barostat.is_some())
    }

    /// The ranks of this run, where there are several ([`crate::prepare_on`]).
    #[must_use]
    pub fn team(&self) -> Option<&Team> {
        self.system.own().team()
    }

    /// The stage under way.
    ///
    /// # Panics
    /// Before the first stage: callers run inside the loop.
    #[must_use]
    pub fn stage_run(&self) -> &StageRun {
        self.stage.as_ref().expect("a stage has been entered")
    }

    /// The scene's description of the stage under way.
    #[must_use]
    pub fn current_stage(&self) -> &Stage {
        &self.scene.stages[self.stage_run().index]
    }
}

/// Time by stage of work. Force and neighbor times come from the force provider, which knows them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Timers {
    /// Steps as a whole: integrator, forces, lists and heat bath.
    pub step: Duration,
    /// Observables.
    pub observe: Duration,
    /// Files.
    pub write: Duration,
}

/// What runs in memory have kept so far; a run that goes on adds to it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// The rows that a run with files writes to `thermo.csv`, column by column.
    pub thermo: Vec<Vec<f64>>,
    /// The frames that it writes to its trajectory: velocities are empty where `output.velocities` is off, and forces where
    /// `output.forces` is.
    pub frames: Vec<State>,
    /// Wall time.
    pub wall: Duration,
}

/// Means with their errors, and tables.
#[derive(Debug, Clone)]
pub struct Results {
    /// All of it but the tables, as `run.json` of a run with files has it. It holds the scene, the averages, the comparison with
    /// the literature, how well the energy was conserved, and remarks.
    pub record: RunRecord,
    /// The tables of the observables, such as `rdf`.
    pub tables: Vec<Table>,
}

impl Results {
    /// A mean by its name, such as `pressure`. Its standard error contains the correlation in time; where a mean is no result,
    /// the error is NaN and `reason` says why.
    ///
    /// # Errors
    /// [`EngineError::NoSuchResult`] with the names that there are.
    pub fn average(&self, name: &str) -> Result<&AverageRecord, EngineError> {
        let averages = &self.record.averages;
        let known = || averages.keys().map(String::as_str);
        averages.get(name).ok_or_else(|| missing("average", name, known()))
    }

    /// A table by its name, such as `rdf`; [`Table::numbers`] gives a column.
    ///
    /// # Errors
    /// [`EngineError::NoSuchResult`] with the names that there are.
    pub fn table(&self, name: &str) -> Result<&Table, EngineError> {
        let known = || self.tables.iter().map(|t| t.name.as_str());
        let found = self.tables.iter().find(|t| t.name == name);
        found.ok_or_else(|| missing("table", name, known()))
    }
}

fn missing<'a>(
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> EngineError {
    let known: Vec<&str> = known.collect();
    let (nearest, known) = match removed(RemovedKind::Column, name) {
        Some(instead) => (None, instead.to_owned()),
        None => (lennard_scene::nearest(name, known.iter().copied()), known.join(", ")),
    };
    EngineError::NoSuchResult { kind, name: name.to_owned(), known, nearest }
}

// Threads that belong to one process.

/// The threads of a simulation, as long as it lives.
///
/// A forked child has none of the threads of its parent, and work that waits for them never ends. The child starts its own.
pub struct Threads {
    count: usize,
    started: Mutex<Started>,
}

struct Started {
    process: u32,
    pool: Arc<ThreadPool>,
}

impl Started {
    fn new(count: usize) -> Result<Self, PoolError> {
        Ok(Self { process: std::process::id(), pool: Arc::new(parallel::pool(count)?) })
    }

    fn is_of_parent(&self) -> bool {
        self.process != std::process::id()
    }
}

impl Threads {
    /// Starts so many threads.
    ///
    /// # Errors
    /// [`PoolError`] where the number is not allowed, or the system gives no threads.
    pub fn new(count: usize) -> Result<Self, PoolError> {
        Ok(Self { count, started: Mutex::new(Started::new(count)?) })
    }

    /// Number of threads.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The threads, in the process that asks.
    ///
    /// # Errors
    /// [`PoolError`] where a forked child gets no threads.
    pub fn pool(&self) -> Result<Arc<ThreadPool>, PoolError> {
        let mut started = self.started.lock().unwrap_or_else(PoisonError::into_inner);
        if started.is_of_parent() {
            *started = Started::new(self.count)?;
        }
        Ok(Arc::clone(&started.pool))
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        if self.is_of_parent() {
            // To end threads takes locks that some of them may have held when the process was copied.
            std::mem::forget(Arc::clone(&self.pool));
        }
    }
}
