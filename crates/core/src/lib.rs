//! The contracts that hold Lennard together: box, state, forces, integrators, thermostats,
//! observables, exact persistence, random streams, and the few sweeps over particles that
//! everything shares.
//!
//! All quantities are in reduced units (ε = σ = m = k_B = 1) unless a line says otherwise:
//! lengths in σ, times in τ = σ√(m/ε), energies in ε, forces in ε/σ, pressures in ε/σ³.
//! Pair vectors are `r_ij = r_i − r_j`; the pair virial is `W = Σ r_ij·F_ij` without a factor 1/3.

mod cell;
mod dynamics;
mod force;
mod integrator;
mod observable;
pub mod parallel;
mod persist;
pub mod random;
mod state;
pub mod stopwatch;
pub mod sweeps;
pub mod tasks;
mod thermostat;

pub use cell::{BoxError, PeriodicBox};
pub use dynamics::{Constraint, Dynamics, ExactSolution, Masses};
pub use force::{ForceError, ForceProperties, ForceProvider, ForceStatistics, Stride};
pub use glam::{DMat3, DVec3};
pub use integrator::{Integrator, IntegratorSpec, StepError, StepReport};
pub use observable::{
    Average, Column, Doubt, Estimate, Findings, Observable, ObservableSpec, Table, TailCorrection,
    View,
};
pub use persist::{Array, Persist, RestoreError, StateArchive, StateReader, StateWriter};
pub use state::{Configuration, Energetics, Part, State, Want};
pub use thermostat::{Thermostat, ThermostatSpec};
