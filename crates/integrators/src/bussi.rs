//! Stochastic velocity rescaling: the kinetic energy follows its own canonical dynamics.

use lennard_core::random::NoiseStream;
use lennard_core::{BathStep, Integrator, Ramp, Thermostat, ThermostatSpec, remembers_nothing};
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use crate::methods::BathOptions;

lennard_core::options! {
    /// Options of stochastic velocity rescaling.
    ///
    /// The default relaxation time, about 1 ps for argon, is a few vibrations: equilibration is quick, the dynamics little disturbed.
    pub struct Options {
        /// Relaxation time of the kinetic energy.
        tau: f64 = 0.5, Between(1e-6, 1e9), in "τ";
    }
}

impl BathOptions for Options {
    fn couple(&self, method: Integrator, temperature: Ramp, noise: NoiseStream) -> Integrator {
        method.with_bath(Bussi::new(self, temperature, noise))
    }

    fn relaxation(&self) -> f64 {
        self.tau
    }
}

/// What stochastic velocity rescaling declares about itself.
pub const BATH: ThermostatSpec = ThermostatSpec {
    name: "bussi",
    summary: "Stochastic velocity rescaling: one factor for all velocities, drawn so that the kinetic energy is canonical.",
    canonical: true,
    keeps_motion: true,
    holds_half_steps: false,
    source: "Bussi, Donadio and Parrinello, \"Canonical sampling through velocity rescaling\", J. Chem. Phys. 126, 014101 (2007), appendix",
};

/// Stochastic velocity rescaling, v ← α·v, with the exact propagator of the kinetic energy over dt.
///
/// With c = e^{−dt/tau}, g = (1 − c)·K̄/(n_dof·K), K̄ = ½·n_dof·T, R a normal number and S the sum
/// of the squares of n_dof − 1 further ones (a χ² number):
///
/// α² = c + g·(R² + S) + 2R·√(c·g), with the sign of R + √(c/g).
///
/// The heat is α²·K − K; E minus its sum is conserved. Momentum keeps its direction, and
/// zero stays zero.
#[derive(Debug, Clone)]
pub struct Bussi {
    tau: f64,
    temperature: Ramp,
    noise: NoiseStream,
}

impl Bussi {
    /// A bath at `temperature` (ε/k_B) that draws from `noise`, keyed by the step.
    #[must_use]
    pub fn new(options: &Options, temperature: impl Into<Ramp>, noise: NoiseStream) -> Self {
        Self { tau: options.tau, temperature: temperature.into(), noise }
    }
}

remembers_nothing!(Bussi { tau, temperature, noise });

/// One number serves the whole system, so its stream has a single index.
const WHOLE_SYSTEM: u32 = 0;

impl Thermostat for Bussi {
    fn spec(&self) -> &'static ThermostatSpec {
        &BATH
    }

    fn factor(&mut self, at: BathStep) -> f64 {
        let mut rng = self.noise.at(at.step, WHOLE_SYSTEM);
        let normal: f64 = StandardNormal.sample(&mut rng);
        // With a single degree of freedom there are no further ones.
        let others = match ChiSquared::new(at.n_dof - 1.0) {
            Ok(distribution) => distribution.sample(&mut rng),
            Err(_) => 0.0,
        };
        let c = (-at.dt / self.tau).exp();
        let g = (1.0 - c) * 0.5 * self.temperature.at(at.step) / at.kinetic;
        let squared = c + g * (normal * normal + others) + 2.0 * normal * (c * g).sqrt();
        // Rounding may bring a sum of squares a hair below zero.
        let magnitude = squared.max(0.0).sqrt();
        if normal + (c / g).sqrt() < 0.0 { -magnitude } else { magnitude }
    }

    fn copy(&self) -> Box<dyn Thermostat> {
        Box::new(self.clone())
    }
}
