//! The contracts that hold Lennard together: box, state, forces, integrators, thermostats,
//! observables, exact persistence, random streams, and the few sweeps over particles that
//! everything shares.
//!
//! All quantities are in reduced units (ε = σ = m = k_B = 1) unless a line says otherwise:
//! lengths in σ, times in τ = σ√(m/ε), energies in ε, forces in ε/σ, pressures in ε/σ³.
//! Pair vectors are `r_ij = r_i − r_j`; the pair virial is `W = Σ r_ij·F_ij` without a factor 1/3.

mod boundary;
mod cell;
pub mod exact;
mod force;
mod friction;
mod integrator;
pub mod lanes;
mod molecules;
pub mod moves;
pub mod number;
pub mod options;
mod own;
pub mod parallel;
mod persist;
pub mod random;
pub mod rigid;
mod sparse;
mod spec;
mod species;
mod state;
mod step;
mod system;
pub mod tasks;
mod team;
mod thermostat;
mod topology;
mod view;

pub use boundary::{BondSolver, BoundDrift, Boundary, Drifted, Flight, WallReading};
pub use cell::{Axis, BoxError, PeriodicBox};
pub use force::{
    Backend, ForceProperties, ForceStatistics, ForceSum, ForceTerm, FusedSteps, NoForces,
    SpeedLimit,
};
pub use friction::{FrictionAndNoise, LANES as NOISE_LANES, NoiseOfMass, NoiseOfStep, Ramp};
pub use glam::{DMat3, DVec3};
pub use integrator::{
    Barostat, BarostatSpec, BoxMoves, Integrator, Method, PressureBath, couple, rigid_bonds_alone,
    without_constraints,
};
pub use lanes::Aligned;
pub use molecules::{Bonds, Exclusions, MOLECULES_PER_TASK, Molecules};
pub use moves::Moving;
pub use own::Own;
pub use persist::{Array, Persist, RestoreError, StateArchive, StateReader, StateWriter};
pub use spec::{ForceError, IntegratorSpec, StepError, StepReport};
pub use species::{MOST_SPECIES, Masses, Species, SpeciesTable};
pub use state::{Configuration, Energetics, Part, State, Want};
pub use step::{Parts, Step, check_finite};
pub use system::{Constraint, ExactSolution, Momentum, System};
pub use team::{Parcel, Team, TeamStatistics, TooManyRanks, Wire, team_of_threads};
pub use thermostat::{BathStep, FusedBath, Thermostat, ThermostatSpec};
pub use topology::{Bond, Coupling, MOST_SITES, Topology, TopologyError};
pub use view::{Shared, TailCorrection, View};
