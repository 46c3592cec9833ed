//! Molecular dynamics of Lennard-Jones fluids, to depend on.
//!
//! A [`SceneBuilder`] makes a [`Scene`], and a [`Simulation`] runs it in memory or into a folder. Keys, defaults,
//! checks and errors are the same as in a scene file. The same scene has the bits of the command line, on any number of
//! threads.
//!
//! ```
//! use lennard::prelude::*;
//!
//! let scene = SceneBuilder::open("verlet-1967/liquid")
//!     .set("system.n_atoms", 108)
//!     .set("truncation.r_cut", 2.2)
//!     .stages([toml! { name = "production" steps = 60 }])
//!     .build()?;
//! let mut liquid = Simulation::new(scene)?;
//! liquid.run()?;
//! let energy = liquid.results().average("potential_energy")?.estimate.mean;
//! assert!((-8.0..-4.0).contains(&energy));
//! # Ok::<(), lennard::Error>(())
//! ```
//!
//! All numbers are in reduced units (ε = σ = m = k_B = 1): lengths in σ, times in τ = σ√(m/ε), energies in ε, pressures in
//! ε/σ³. Energies are for each particle, or for each molecule where the scene has molecules.
//!
//! # Parts of your own
//!
//! [`OwnParts`] brings forces, an integrator and observables that no scene names. The module [`parts`] has the contracts
//! that they keep. The folder `examples` of this crate has one of each, and the tutorials of the book explain them.

#[cfg(feature = "program")]
pub mod program;

pub use lennard_core::{DMat3, DVec3, PeriodicBox, State};
pub use lennard_engine::{
    Control, Ending, EngineError as Error, Moment, OwnParts, Progress, Recording, Results,
    Simulation, StartError,
};
pub use lennard_io::{AverageRecord, RunRecord};
pub use lennard_literature as literature;
pub use lennard_observables::{Table, statistics};
pub use lennard_scene::{Scene, SceneBuilder, SceneError, shipped};
pub use toml;

/// A result, or what went wrong.
pub type Result<T> = std::result::Result<T, Error>;

/// What nearly every program needs.
pub mod prelude {
    pub use crate::{OwnParts, Results, Scene, SceneBuilder, Simulation};
    pub use toml::toml;
}

/// Forces and steps without a scene: a box, positions, a potential and a method, in a loop of your own.
///
/// [`build`](dynamics::build) makes [`PairForces`](dynamics::PairForces), which keep their neighbor list from call to call.
/// [`integrator`](dynamics::integrator) makes a method, and [`Integrator::advance`](dynamics::Integrator::advance) takes steps.
pub mod dynamics {
    pub use lennard_core::random::Streams;
    pub use lennard_core::{
        Backend, BoxError, Configuration, DVec3, Energetics, ForceError, ForceSum, ForceTerm,
        Integrator, Momentum, Part, PeriodicBox, State, StepError, System, Want,
    };
    pub use lennard_engine::thermal_velocities;
    pub use lennard_forcefield::{
        Conditions, ForceFieldError, ForceFieldOptions, PairForces, PotentialOptions,
        TruncationKind, TruncationOptions, build,
    };
    pub use lennard_integrators::{IntegratorOptions, ThermostatOptions, build as integrator};
}

/// The contracts of forces, integrators and observables, and what their implementations need.
pub mod parts {
    pub use lennard_core::exact::exact_sum;
    pub use lennard_core::parallel::for_each_piece;
    pub use lennard_core::{
        Array, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm,
        IntegratorSpec, Method, Part, PeriodicBox, Persist, RestoreError, StateReader, StateWriter,
        Step, StepError, System, View, Want, persist, remembers_nothing,
    };
    pub use lennard_observables::{
        Average, Estimate, Findings, Observable, ObservableSpec, Remark, Suits, Table,
    };
}
