//! Velocity rescaling to exactly the wanted temperature, as Verlet did.

use lennard_core::random::NoiseStream;
use lennard_core::{BathStep, Integrator, Ramp, Thermostat, ThermostatSpec, remembers_nothing};

use crate::methods::BathOptions;

lennard_core::options! {
    /// Options of velocity rescaling. Kinetic and potential energy exchange something within the default of ten steps.
    pub struct Options {
        /// Steps between two rescalings.
        every: u64 = 10, Whole(1, lennard_core::options::MOST_STEPS), in "steps";
    }
}

impl BathOptions for Options {
    fn couple(&self, method: Integrator, temperature: Ramp, _noise: NoiseStream) -> Integrator {
        method.with_bath(Rescale::new(self, temperature))
    }

    /// The bath sets the kinetic energy at once.
    fn relaxation(&self) -> f64 {
        0.0
    }
}

/// What velocity rescaling declares about itself.
pub const BATH: ThermostatSpec = ThermostatSpec {
    name: "rescale",
    summary: "Rescales all velocities to exactly the wanted temperature every so many steps; for equilibration.",
    canonical: false,
    keeps_motion: true,
    holds_half_steps: false,
    source: "Verlet, \"Computer experiments on classical fluids. I\", Phys. Rev. 159, 98 (1967), section II; v <- v sqrt(T_wanted/T)",
};

/// Velocity rescaling, v ← v·√(T_wanted/T) with T = 2K/n_dof, on every step that is a multiple of `every`.
///
/// A system at rest has no temperature to scale and is left as it is.
#[derive(Debug, Clone)]
pub struct Rescale {
    every: u64,
    temperature: Ramp,
}

impl Rescale {
    /// Rescaling to `temperature` (ε/k_B).
    #[must_use]
    pub fn new(options: &Options, temperature: impl Into<Ramp>) -> Self {
        Self { every: options.every, temperature: temperature.into() }
    }
}

remembers_nothing!(Rescale { every, temperature });

impl Thermostat for Rescale {
    fn spec(&self) -> &'static ThermostatSpec {
        &BATH
    }

    fn acts_after(&self, step: u64) -> bool {
        // An interval of zero is refused by `check`; here it means never.
        self.every != 0 && step.is_multiple_of(self.every)
    }

    fn factor(&mut self, at: BathStep) -> f64 {
        let wanted = 0.5 * at.n_dof * self.temperature.at(at.step);
        (wanted / at.kinetic).sqrt()
    }

    fn copy(&self) -> Box<dyn Thermostat> {
        Box::new(self.clone())
    }
}
