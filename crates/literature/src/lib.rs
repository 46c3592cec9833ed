//! What the literature says about the Lennard-Jones fluid: equations of state, the freezing line,
//! transport coefficients, each with source and status.
//!
//! All quantities are per particle and in reduced units (ε = σ = m = k_B = 1). The potential energy
//! is the residual internal energy; the pressure includes the ideal part.
//!
//! ```
//! use lennard_literature::{ModelKind, equation_of_state_for};
//!
//! let equation = equation_of_state_for(ModelKind::CutWithTail { r_cut: 4.0 }).unwrap();
//! let state = equation.at(0.8442, 0.722);
//! assert!((state.potential_energy - -6.080081).abs() < 1e-6);
//! assert!((state.pressure - 0.165090).abs() < 1e-6);
//! assert!(equation.phase(0.8442, 0.722).is_stable());
//! // A run with another truncation is not judged by it.
//! assert!(equation_of_state_for(ModelKind::ForceShifted { r_cut: 2.5 }).is_err());
//! ```

mod beside;
mod bisection;
mod coexistence_data;
mod critical;
mod equation;
mod finite_size;
mod fluid_state;
mod freezing;
mod jet;
mod johnson;
mod known_points;
mod kob_andersen;
mod kolafa_nezbeda;
mod made;
mod model;
mod one_fluid;
mod phase;
mod pohl;
mod properties;
mod saturation;
mod tables;
mod terms;
mod thol;
mod transport;
mod two_center;
mod two_phases;
pub mod units;
mod virial;

pub use beside::{
    ClosedBox, Compared, Described, Expected, at_constant_pressure, at_constant_volume,
};
pub use bisection::{bisect, try_bisect};
pub use coexistence_data::coexistence_by_simulation;
pub use equation::{EquationOfState, EquationSpec, OutsideRange, OwnUncertainty, Range};
pub use finite_size::{FiniteSize, FiniteSizeDoubt, Kept};
pub use fluid_state::{CriticalPoint, FluidState};
pub use freezing::{FreezingLine, freezing_line, freezing_lines, freezing_lines_of};
pub use jet::Jet;
pub use johnson::Johnson;
pub use known_points::{KnownPoint, known_points};
pub use kob_andersen::{
    KobAndersen, KobAndersenQuantity, KobAndersenRow, kob_andersen_at, kob_andersen_states,
};
pub use kolafa_nezbeda::KolafaNezbeda;
pub use model::{
    GOOD_TAIL_CUTOFF, ModelKind, NoReference, equation_of_state_for, equations_for, johnson_1993,
    kolafa_nezbeda_1994, list, remark_for, thol_2015, thol_2016,
};
pub use one_fluid::{LARGEST_SIZE_RATIO, OneFluid, OneFluidEquation, one_fluid};
pub use phase::Phase;
pub use pohl::{Pohl, pohl_2023};
pub use properties::{PROPERTIES, Property, Scale, property};
pub use saturation::Saturation;
pub use tables::{ReferenceTable, Status, reference_table, reference_tables};
pub use thol::Thol;
pub use transport::{
    NEAR_DENSITY, NEAR_TEMPERATURE, SAME_DENSITY, SAME_LINE, TransportProperty, TransportValue,
    transport_near, viscosity_near,
};
pub use two_center::{BOND_LENGTHS, TwoCenter, two_center};
pub use two_phases::{TwoPhaseSource, TwoPhases, surface_tensions_by_simulation};
pub use virial::{Mie, VirialSeries, virial_series};
