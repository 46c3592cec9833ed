//! What every barostat provides for the list.

use lennard_core::options::OptionError;
use lennard_core::random::NoiseStream;
use lennard_core::{Integrator, PressureBath};

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
