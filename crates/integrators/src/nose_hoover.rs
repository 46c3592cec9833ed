//! Nosé–Hoover chains: deterministic friction that is itself kept warm by a chain of thermostats.

use lennard_core::random::NoiseStream;
use lennard_core::{BathStep, Integrator, Ramp, Thermostat, ThermostatSpec, persist};

use crate::chain::Chain;
use crate::common::BathOptions;

lennard_core::options! {
    /// Options of Nosé–Hoover chains.
    ///
    /// The default period is a few vibrations of a liquid. Three thermostats are the fewest with which one oscillator is ergodic.
    pub struct Options {
        /// Period of the thermostats; their masses are Q₁ = n_dof·T·τ² and Q_j = T·τ².
        tau: f64 = 0.5, Between(1e-6, 1e9), in "τ";
        /// Thermostats in the chain; 1 is the plain Nosé–Hoover thermostat, which a stiff system defeats.
        chain: u32 = 3, Whole(1, 10), in "thermostats";
    }
}

impl BathOptions for Options {
    fn couple(&self, method: Integrator, temperature: Ramp, _noise: NoiseStream) -> Integrator {
        method.with_bath(NoseHoover::new(self, temperature))
    }

    /// The kinetic energy swings about its mean with about this period, and the chain damps the swing.
    fn relaxation(&self) -> f64 {
        self.tau
    }
}

/// What Nosé–Hoover chains declare about themselves.
pub const BATH: ThermostatSpec = ThermostatSpec {
    name: "nose-hoover",
    summary: "Nosé–Hoover chains: deterministic friction that a chain of thermostats keeps canonical; no random numbers.",
    canonical: true,
    keeps_motion: true,
    holds_half_steps: false,
    source: "Martyna, Klein and Tuckerman, \"Nosé–Hoover chains: the canonical ensemble via continuous dynamics\", J. Chem. Phys. 97, 2635 (1992), in the splitting of Martyna, Tuckerman, Tobias and Klein, Mol. Phys. 87, 1117 (1996)",
};

/// A Nosé–Hoover chain that acts once after each step, over the whole step.
///
/// The friction is v̇ = −ξ₁·v, with ξ₁ the velocity of the first thermostat of the chain.
/// The heat is the change of K; E minus its sum is conserved, and so is E plus the energy of the chain.
#[derive(Debug, Clone)]
pub struct NoseHoover {
    temperature: Ramp,
    chain: Chain,
}

impl NoseHoover {
    /// A chain at `temperature` (ε/k_B) that is at rest.
    #[must_use]
    pub fn new(options: &Options, temperature: impl Into<Ramp>) -> Self {
        Self { temperature: temperature.into(), chain: Chain::new(options.chain, options.tau) }
    }
}

persist!(NoseHoover { chain, fixed temperature });

impl Thermostat for NoseHoover {
    fn spec(&self) -> &'static ThermostatSpec {
        &BATH
    }

    fn factor(&mut self, at: BathStep) -> f64 {
        let temperature = self.temperature.at(at.step);
        (self.chain).advance(at.kinetic, at.n_dof, temperature, at.dt)
    }

    fn copy(&self) -> Box<dyn Thermostat> {
        Box::new(self.clone())
    }
}
