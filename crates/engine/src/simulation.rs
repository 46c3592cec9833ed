//! A simulation: the system, its forces, the stage under way, the observables, and what runs have recorded. Rust, Python and the
//! program share it.

use std::any::Any;

use lennard_core::random::Streams;
use lennard_core::{Backend, Integrator, Observable, PeriodicBox, State, System, Team};
use lennard_forcefield::{ForceFieldOptions, Mixture, NeighborOptions, Tail};
use lennard_observables::Thermodynamics;
use lennard_scene::{Scene, Stage};

use crate::force_check::ForceCheck;
use crate::from_frames::FromFrames;
use crate::own::OwnParts;
use crate::recording::Recording;
use crate::schedule::Observer;
use crate::threads::Threads;
use crate::timers::Timers;

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
    /// The ranks of this run, where there are several ([`Simulation::share`]).
    pub team: Option<Team>,
    /// Whether the ranks share the pair forces out.
    pub shares_forces: bool,
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
            self.state.len(),
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
