//! Integrators, thermostats and minimisers, one file a method.
//!
//! Every method stands behind [`lennard_core::Integrator`] and sees masses, positions, velocities and
//! a force provider, nothing else. The same code therefore runs the fluid and the oscillator of the
//! stability study. A new integrator is one file with its `Options`, its `SPEC` and its `step`, and
//! one line in the list of `list.rs`. Options, `build`, `lennard list`, the conformance tests and the
//! studies go over that list.
//!
//! Everything is in reduced units: times in τ = σ√(m/ε), lengths in σ, energies in ε.

pub mod bonds;
mod composition;
pub mod contacts;
mod exchange;
pub mod fire;
mod flight;
mod list;
mod methods;
pub mod oscillator;

pub mod analytic;
pub mod blanes_moan;
pub mod explicit_euler;
pub mod forest_ruth;
pub mod implicit_euler;
pub mod leapfrog;
pub mod pefrl;
pub mod respa;
pub mod spook;
pub mod stormer_time_corrected;
pub mod stormer_variable;
pub mod stormer_verlet;
pub mod symplectic_euler;
pub mod velocity_verlet;
pub mod velocity_verlet_short;

pub mod barostats;

pub mod bussi;
pub mod langevin;
pub mod nose_hoover;
pub mod rescale;

pub use barostats::{BarostatOptions, Coupling, barostats, dof_of_centers};
pub use bonds::{BondHolder, BondOptions, BondSpec, bond_methods};
pub use contacts::{Bodies, ContactOptions, Contacts, Response, contacts};
pub use exchange::{ExchangeOptions, ExchangeSpec, Exchanged, exchanges};
pub use flight::Obstacles;
pub use list::{
    IntegratorEntry, IntegratorOptions, ThermostatOptions, build, integrators, thermostats,
};
pub use methods::OscillatorModel;
pub use spook::{SpookBonds, UnilateralLaw};
