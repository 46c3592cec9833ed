//! Langevin dynamics by the BAOAB splitting.

use lennard_core::parallel::for_each_piece;
use lennard_core::random::NoiseStream;
use lennard_core::{
    DVec3, Dynamics, ForceProvider, Integrator, IntegratorSpec, State, StepError, StepReport,
    ThermostatSpec, Want, sweeps,
};
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use crate::common::{OptionError, begin, check_suited, evaluate, remembers_nothing, tick};

/// Options of Langevin dynamics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Options {
    /// Friction γ in 1/τ: velocities are forgotten within 1/γ.
    pub friction: f64,
}

impl Default for Options {
    /// 1/τ, a common choice for Lennard-Jones fluids.
    fn default() -> Self {
        Self { friction: 1.0 }
    }
}

impl Options {
    /// Whether every option has a possible value.
    ///
    /// # Errors
    /// [`OptionError`], which names the key, what was found and what is allowed.
    pub fn check(&self) -> Result<(), OptionError> {
        OptionError::unless_positive("friction", self.friction)
    }
}

const NAME: &str = "langevin";
const SUMMARY: &str =
    "Langevin dynamics by the BAOAB splitting: friction and noise on every particle.";
const SOURCE: &str = "Leimkuhler and Matthews, \"Robust and efficient configurational molecular sampling via Langevin dynamics\", J. Chem. Phys. 138, 174102 (2013), BAOAB";

/// What the Langevin bath declares about itself.
pub const THERMOSTAT_SPEC: ThermostatSpec = ThermostatSpec {
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
    position_order: 2,
    velocity_order: 2,
    symplectic: false,
    reversible: false,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    has_memory: false,
    conserves_momentum: false,
    half_kicks: true,
    force_evaluations: 1,
    stability_limit: Some(2.0),
    oscillator_map: None,
    source: SOURCE,
};

/// Langevin dynamics m·dv = F·dt − γ·m·v·dt + √(2γmT)·dW by the splitting B A O A B:
/// half kick, half drift, friction and noise over the whole step, half drift, half kick.
///
/// Noise touches every particle, so total momentum is not conserved and n_dof is 3N.
/// [`StepReport::heat`] is the kinetic energy that the O part put in; E minus its sum is conserved
/// as velocity Verlet conserves energy.
#[derive(Debug, Clone)]
pub struct Langevin {
    friction: f64,
    temperature: f64,
    noise: NoiseStream,
}

impl Langevin {
    /// A bath at `temperature` (ε/k_B) that draws from `noise`, keyed by step and particle.
    #[must_use]
    pub fn new(options: &Options, temperature: f64, noise: NoiseStream) -> Self {
        Self {
            friction: options.friction,
            temperature,
            noise,
        }
    }

    /// The O part, exact over `dt`; returns the kinetic energy gained.
    fn friction_and_noise(&self, dynamics: &Dynamics, state: &mut State, dt: f64) -> f64 {
        let before = dynamics.kinetic_energy(&state.velocities);
        let c = (-self.friction * dt).exp();
        // 1 − c² without cancellation where the friction is small.
        let variance = -(-2.0 * self.friction * dt).exp_m1() * self.temperature;
        let step = state.step;
        for_each_piece(&mut state.velocities, |first, chunk| {
            for (i, v) in chunk.iter_mut().enumerate() {
                let particle = first + i;
                let mut rng = self.noise.at(step, particle as u32);
                let r = DVec3::new(
                    StandardNormal.sample(&mut rng),
                    StandardNormal.sample(&mut rng),
                    StandardNormal.sample(&mut rng),
                );
                *v = c * *v + (variance / dynamics.masses.of(particle)).sqrt() * r;
            }
        });
        dynamics.kinetic_energy(&state.velocities) - before
    }
}

remembers_nothing!(Langevin);

impl Integrator for Langevin {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn start(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<(), StepError> {
        begin(&SPEC, dynamics, state, forces, dt, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_suited(&SPEC, forces, dt)?;
        let half = 0.5 * dt;
        sweeps::kick_and_drift(
            &mut state.positions,
            &mut state.velocities,
            &state.forces,
            &dynamics.masses,
            half,
            half,
        );
        let heat = self.friction_and_noise(dynamics, state, dt);
        sweeps::drift(&mut state.positions, &state.velocities, half);
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        sweeps::kick(&mut state.velocities, &state.forces, &dynamics.masses, half);
        Ok(StepReport {
            force_evaluations: 1,
            heat,
            ..StepReport::default()
        })
    }
}
