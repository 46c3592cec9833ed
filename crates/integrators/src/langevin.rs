//! Langevin dynamics by the BAOAB splitting.

use lennard_core::random::NoiseStream;
use lennard_core::{
    ForceProperties, FrictionAndNoise, Integrator, IntegratorSpec, Method, Ramp, Step, StepError,
    System, ThermostatSpec, remembers_nothing, rigid_bonds_alone,
};

use crate::methods::BathOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of Langevin dynamics: velocities are forgotten within the inverse of the friction.
    pub struct Options {
        /// Friction coefficient γ.
        friction: f64 = 1.0, Between(1e-6, 1e6), in "τ⁻¹";
    }
}

impl BathOptions for Options {
    /// Friction and noise stand inside the step: BAOAB takes the place of the method.
    fn couple(&self, _method: Integrator, temperature: Ramp, noise: NoiseStream) -> Integrator {
        Integrator::new(Langevin::new(self, temperature, noise))
    }

    /// Velocities lose e^{−γt} of themselves, and their squares twice as much.
    fn relaxation(&self) -> f64 {
        0.5 / self.friction
    }
}

const NAME: &str = "langevin";
const SUMMARY: &str =
    "Langevin dynamics by the BAOAB splitting: friction and noise on every particle.";
const SOURCE: &str = "Leimkuhler and Matthews, \"Robust and efficient configurational molecular sampling via Langevin dynamics\", J. Chem. Phys. 138, 174102 (2013), BAOAB";

/// What the Langevin bath declares about itself.
pub const BATH: ThermostatSpec = ThermostatSpec {
    name: NAME,
    summary: SUMMARY,
    canonical: true,
    keeps_motion: false,
    holds_half_steps: true,
    source: SOURCE,
};

/// What BAOAB declares about itself as an integrator.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: NAME,
    summary: SUMMARY,
    equations: "v += (h/2) a; x += (h/2) v; v = c v + sqrt((1 - c^2) T/m) R with c = exp(-friction h); x += (h/2) v; v += (h/2) a(t+h)",
    symplectic: false,
    reversible: false,
    conserves_momentum: false,
    holds_rigid_bonds: true,
    oscillator_map: None,
    source: SOURCE,
    ..VERLET
};

/// Langevin dynamics m·dv = F·dt − γ·m·v·dt + √(2γmT)·dW by the splitting B A O A B. B is half a
/// kick, A half a drift, and O the friction and noise of the whole step.
///
/// Noise touches every particle, so total momentum is not conserved and n_dof is 3N. Its normal numbers have 24 bits, in double
/// precision too.
/// The heat of a step is the kinetic energy that the O part put in; E minus its sum is conserved
/// as velocity Verlet conserves energy.
#[derive(Debug, Clone)]
pub struct Langevin {
    bath: FrictionAndNoise,
}

impl Langevin {
    /// A bath at `temperature` (ε/k_B) that draws from `noise`, keyed by step and particle.
    #[must_use]
    pub fn new(options: &Options, temperature: impl Into<Ramp>, noise: NoiseStream) -> Self {
        Self {
            bath: FrictionAndNoise {
                friction: options.friction,
                temperature: temperature.into(),
                noise,
            },
        }
    }
}

remembers_nothing!(Langevin { bath });

impl Method for Langevin {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    /// Kicks and drifts hold rigid bonds: with them B A O A B is the projected splitting of g-BAOAB.
    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        rigid_bonds_alone(system)
    }

    fn takes_hard_walls(&self) -> bool {
        true
    }

    fn fuses_steps(&self) -> bool {
        true
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.kick(0.5);
        s.drift(0.5);
        s.friction_and_noise(&self.bath);
        s.drift(0.5);
        s.forces()?;
        s.kick(0.5);
        Ok(())
    }
}
