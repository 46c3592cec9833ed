//! Observables and the statistics of their averages.
//!
//! An observable looks at the run and never changes it ([`Observable`]). Each has a
//! file of its own with its options, its definition and its source. The list below names
//! them all. Scene files, `list observables` and the tests go over that list.
//!
//! Every mean comes with its standard error and its number of independent samples
//! ([`statistics`]). All stores are bounded in memory however long the run ([`Series`],
//! blocks of sums), and all are saved and restored to the bit.

#[macro_use]
mod catalog;

mod averages;
mod binned;
mod blocks;
mod cells;
mod changing_box;
mod correlator;
mod error;
mod exchange_profile;
mod extrema;
mod findings;
mod heat_capacity;
mod judge;
mod ladder;
mod linear_regime;
mod observable;
mod over_lags;
mod pairs;
mod phases;
pub mod quantities;
mod recipe;
mod remark;
mod response;
mod seen_box;
mod series;
mod species_pairs;
pub mod statistics;
mod table;
#[cfg(test)]
mod testing;
mod thermo_series;
mod time_origins;
mod tracked;
mod transport;
mod wave_vectors;

pub use bond_order::solid_share;
pub use changing_box::ChangingBox;
pub use chemical_potential::{Insertion, TrialEnergies};
pub use error::ObservableError;
pub use exchange_profile::{Driven, ExchangeProfile};
pub use findings::{is_response, leave_out, tell, tell_separated, tell_tail_of_structure, without};
pub use heat_capacity::Ensemble;
pub use interface::{Interface, LIQUID_DENSITY};
pub use judge::{Allowed, Comparison, Reference, StatePoint, Verdict, judge};
pub use momentum::Momentum;
pub use msd::{CORRECTED, MeanSquareDisplacement, UNCORRECTED, YEH_HUMMER_XI};
pub use observable::{
    Average, Doubt, Estimate, Findings, Frames, Observable, ObservableSpec, Standing, Suits,
    Surroundings, finite,
};
pub use pairs::{count_distances, count_distances_by_species};
pub use phases::{front, frozen, frozen_bytes, separated};
pub use pressure_tensor::PressureTensor;
pub use rdf::RadialDistribution;
pub(crate) use recipe::recipe;
pub use recipe::{BuildContext, Recipe};
pub use remark::{Fronts, Remark};
pub use response::{Curvature, response_functions};
pub use series::{Columns, Series};
pub use table::{Cell, Column, RowsOf, Table, Tone, Value};
pub use thermo_series::ThermoSeries;
pub use thermodynamics::{
    Confined, Conservation, Equilibrium, HeldTemperature, PairEnd, Thermodynamics,
};
pub use transport::{
    MutualDiffusionOptions, ShearViscosity, ShearViscosityOptions, ThermalConductivity,
    ThermalConductivityOptions,
};
pub use vacf::VelocityAutocorrelation;
pub use wall_pressure::WallPressure;

use lennard_core::options::{Keys, Options};
use serde::{Deserialize, Serialize};

catalog! {
    /// Temperature, energies, pressure, configurational temperature, conservation.
    Thermodynamics in thermodynamics => ThermodynamicsOptions,
    /// The nine components of the pressure tensor.
    PressureTensor in pressure_tensor => PressureTensorOptions,
    /// The pressure on each wall.
    WallPressure in wall_pressure => WallPressureOptions,
    /// The density along one axis.
    DensityProfile in density_profile => DensityProfileOptions,
    /// A slab of liquid beside its vapor.
    Interface in interface => InterfaceOptions,
    /// Total momentum.
    Momentum in momentum => MomentumOptions,
    /// Temperatures, bonds and pressure of molecules.
    Molecules in molecules => MolecularMotionOptions,
    /// How long molecules remember their direction.
    Orientation in orientation => OrientationOptions,
    /// The radial distribution function g(r).
    Rdf in rdf => RdfOptions,
    /// The mean-square displacement and the diffusion coefficient.
    Msd in msd => MsdOptions,
    /// The velocity autocorrelation function.
    Vacf in vacf => VacfOptions,
    /// The Einstein frequency.
    EinsteinFrequency in einstein_frequency => EinsteinFrequencyOptions,
    /// The static structure factor S(k).
    StructureFactor in structure_factor => StructureFactorOptions,
    /// The order of the directions to neighbors.
    BondOrder in bond_order => BondOrderOptions,
    /// The residual chemical potential.
    ChemicalPotential in chemical_potential => ChemicalPotentialOptions,
    /// Kirkwood–Buff integrals of the species.
    KirkwoodBuff in kirkwood_buff => KirkwoodBuffOptions,
    /// The mutual diffusion coefficient of two species.
    MutualDiffusion => MutualDiffusionOptions,
    /// The shear viscosity.
    ShearViscosity => ShearViscosityOptions,
    /// The thermal conductivity.
    ThermalConductivity => ThermalConductivityOptions,
}
