//! Observables and the statistics of their averages.
//!
//! An observable looks at the run and never changes it ([`lennard_core::Observable`]). Each has a
//! file of its own with its options, its definition and its source. The list in `catalog.rs` names
//! them all. Scene files, `list observables` and the tests go over that list.
//!
//! Every mean comes with its standard error and its number of independent samples
//! ([`statistics`]). All stores are bounded in memory however long the run ([`Series`],
//! blocks of sums), and all are saved and restored to the bit.

mod averages;
mod binned;
mod blocks;
mod bond_order;
mod catalog;
mod cells;
mod changing_box;
mod chemical_potential;
mod correlator;
mod density_profile;
mod error;
mod exchange_profile;
mod extrema;
mod heat_capacity;
mod interface;
mod judge;
mod kirkwood_buff;
mod linear_regime;
mod molecules;
mod momentum;
mod msd;
mod orientation;
mod over_lags;
mod pairs;
mod pressure_tensor;
pub mod quantities;
mod rdf;
mod recipe;
mod response;
mod seen_box;
mod separation;
mod series;
mod species_pairs;
pub mod statistics;
mod structure_factor;
#[cfg(test)]
mod testing;
mod thermo_series;
mod thermodynamics;
mod time_origins;
mod tracked;
mod transport;
mod vacf;
mod wall_pressure;
mod wave_vectors;

pub use bond_order::{BondOrderOptions, SOLID_SHARE_BYTES, solid_share};
pub use catalog::{ObservableOptions, build, observables};
pub use changing_box::ChangingBox;
pub use chemical_potential::{ChemicalPotentialOptions, Insertion, TrialEnergies};
pub use density_profile::DensityProfileOptions;
pub use error::ObservableError;
pub use exchange_profile::{Driven, ExchangeProfile};
pub use heat_capacity::Ensemble;
pub use interface::{Interface, InterfaceOptions, LIQUID_DENSITY};
pub use judge::{Allowed, Reference, Verdict, judge};
pub use kirkwood_buff::KirkwoodBuffOptions;
pub use molecules::MolecularMotionOptions;
pub use momentum::{Momentum, MomentumOptions};
pub use msd::{CORRECTED, MeanSquareDisplacement, MsdOptions, UNCORRECTED, YEH_HUMMER_XI};
pub use orientation::OrientationOptions;
pub use pairs::{count_distances, count_distances_by_species};
pub use pressure_tensor::{PressureTensor, PressureTensorOptions};
pub use rdf::{RadialDistribution, RdfOptions};
pub use recipe::{BuildContext, Recipe, Surroundings};
pub use response::{Curvature, response_functions};
pub use separation::largest_density_wave;
pub use series::{Columns, Series};
pub use structure_factor::StructureFactorOptions;
pub use thermo_series::ThermoSeries;
pub use thermodynamics::{
    Confined, Conservation, Equilibrium, HeldTemperature, PairEnd, Thermodynamics,
    ThermodynamicsOptions,
};
pub use transport::{
    MutualDiffusionOptions, ShearViscosity, ShearViscosityOptions, ThermalConductivity,
    ThermalConductivityOptions,
};
pub use vacf::{VacfOptions, VelocityAutocorrelation};
pub use wall_pressure::{WallPressure, WallPressureOptions};
