//! Barostats, one file each: operators that change the box so that the pressure is held.

pub mod mtk;
pub mod stochastic_cell_rescaling;

use lennard_core::options::OptionError;
use lennard_core::random::NoiseStream;
use lennard_core::{BarostatSpec, DVec3, ForceError, Integrator, PressureBath, State, System};

pub use stochastic_cell_rescaling::dof_of_centers;

use crate::ThermostatOptions;

lennard_core::choices! {
    /// The sides of the box that change together.
    pub enum Coupling {
        /// All sides by one factor: for fluids.
        #[default]
        Isotropic = "isotropic",
        /// The side along z alone, with P_zz: for slabs across z.
        Z = "z",
        /// The sides along x and y by one factor with ½(P_xx + P_yy), and in turn the side along z with P_zz: for slabs and crystals.
        XyZ = "xy-z",
    }
}

/// What the options type of each barostat provides for the list.
pub trait BarostatParts {
    /// Couples the method of a stage, with its heat bath, to the pressure bath.
    ///
    /// Random numbers come from `noise`, keyed by the step. A barostat inside the step takes the place of the method.
    fn couple(
        &self,
        method: Integrator,
        thermostat: &ThermostatOptions,
        bath: PressureBath,
        noise: NoiseStream,
    ) -> Integrator;
    /// The relaxation time of the volume in τ.
    fn tau(&self) -> f64;
    /// Steps between two changes of the box.
    fn interval(&self) -> u64;
    /// Force evaluations of each change, besides the evaluations of the steps.
    fn evaluations(&self) -> u64;
    /// The sides that change together.
    fn coupling(&self) -> Coupling {
        Coupling::Isotropic
    }
    /// Whether the barostat stands inside the step, in the place of the method.
    fn is_inside_step(&self) -> bool {
        false
    }
    /// The compressibility that the scene gives, σ³/ε; `None` where it is to be estimated.
    fn compressibility(&self) -> Option<f64> {
        None
    }
    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

lennard_core::list_of_methods! {
    /// A barostat by name, with its options: the `barostat` of a stage without its `pressure`.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    pub enum BarostatOptions: BarostatParts, declared by SPEC: BarostatSpec {
        /// Stochastic cell rescaling of Bernetti and Bussi, accepted by Metropolis.
        StochasticCellRescaling: stochastic_cell_rescaling::Options,
        /// The barostat of Martyna, Tobias and Klein, in place of the scene's integrator.
        Mtk: mtk::Options,
    }
}

/// Every barostat, in the order of `lennard list`.
#[must_use]
pub fn barostats() -> &'static [BarostatSpec] {
    BarostatOptions::SPECS
}

/// Multiplies the sides of the box.
///
/// # Errors
/// [`ForceError`] for a box without volume, or beyond all numbers: positions there are none.
fn scale_box(state: &mut State, factors: DVec3) -> Result<(), ForceError> {
    let scaled = state.cell.scaled(factors);
    state.cell = scaled.map_err(|_| ForceError::NonFinitePosition { particle: 0 })?;
    Ok(())
}

/// Moves the sites of each molecule together, by what `change` gives for its number and its centre of mass.
/// `of_sites` are the positions or the velocities.
fn move_centers(
    system: &System,
    of_sites: &mut [DVec3],
    change: impl Fn(usize, DVec3) -> DVec3 + Sync,
) {
    let molecules = &system.molecules;
    molecules.for_each(molecules.sites(), of_sites, |m, own| {
        let center = molecules.center(&system.masses, molecules.sites_of(m).start, own);
        let change = change(m, center);
        own.iter_mut().for_each(|site| *site += change);
    });
}
