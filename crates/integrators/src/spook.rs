//! SPOOK: symplectic Euler whose velocities also satisfy a regularised, damped constraint.

use glam::DMat2;
use lennard_core::{
    Constraint, DVec3, Dynamics, ForceProvider, Integrator, IntegratorSpec, Persist, RestoreError,
    State, StateReader, StateWriter, StepError, StepReport, Want, sweeps,
};
use serde::{Deserialize, Serialize};

use crate::OscillatorModel;
use crate::common::{Method, check_same_step, check_suited, evaluate, tick};

/// Options of SPOOK: there are none; compliance and damping belong to the constraint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What SPOOK declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "spook",
    summary: "Symplectic Euler with a regularised, damped constraint solved for in each step; for one constraint so far.",
    equations: "M v' - G^T L = M v + h f; G v' + S L = -(4/h) y g + y G v; x' = x + h v'; S = (4/h^2) eps/(1 + 4 tau/h), y = 1/(1 + 4 tau/h)",
    position_order: 1,
    velocity_order: 1,
    symplectic: true,
    reversible: false,
    fixed_step_only: true,
    velocity_dependent_forces: true,
    has_memory: false,
    conserves_momentum: true,
    half_kicks: false,
    force_evaluations: 1,
    stability_limit: None,
    oscillator_map: Some(oscillator_map),
    source: "Lacoursière, \"Ghosts and Machines: Regularized Variational Methods for Interactive Simulations of Multibodies with Dry Frictional Contacts\", PhD thesis, Umeå University (2007), the SPOOK stepper",
};

/// What compliance and damping become for a step h: Σ = (4/h²)·ε/(1 + 4τ/h) and γ = 1/(1 + 4τ/h).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// Σ, in units of an inverse mass.
    pub sigma: f64,
    /// γ, between 0 and 1.
    pub gamma: f64,
}

impl Regularisation {
    /// For compliance ε, damping time τ and step h.
    #[must_use]
    pub fn new(compliance: f64, damping_time: f64, dt: f64) -> Self {
        let gamma = 1.0 / (1.0 + 4.0 * damping_time / dt);
        Self {
            sigma: 4.0 / (dt * dt) * compliance * gamma,
            gamma,
        }
    }
}

/// One step on the damped oscillator as the constraint g(x) = x on a mass m, in closed form:
/// v′ = (−(4/h)·γ·x + γ·v + m·Σ·v)/(1 + m·Σ), x′ = x + h·v′.
///
/// With τ = 0 it is symplectic Euler at ω_eff² = ω²/(1 + (ωh)²/4), so that ω_eff·h < 2 for every
/// finite stiffness.
#[must_use]
pub fn damped_oscillator_map(compliance: f64, damping_time: f64, mass: f64, dt: f64) -> DMat2 {
    let Regularisation { sigma, gamma } = Regularisation::new(compliance, damping_time, dt);
    let weight = 1.0 + mass * sigma;
    let vx = -4.0 / dt * gamma / weight;
    let vv = (gamma + mass * sigma) / weight;
    DMat2::from_cols_array_2d(&[[1.0 + dt * vx, vx], [dt * vv, vv]])
}

/// One step on ẍ = −ω²x as a matrix on (x, v), the spring taken as an undamped constraint of
/// compliance 1/ω² on a unit mass.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    damped_oscillator_map((omega * omega).recip(), 0.0, 1.0, dt)
}

/// SPOOK for at most one constraint; without any it is symplectic Euler.
///
/// With one constraint the linear system has a single unknown multiplier λ,
/// (G·M⁻¹·Gᵀ + Σ)·λ = −(4/h)·γ·g + γ·G·v − G·(v + h·M⁻¹·f), and v′ = v + h·M⁻¹·f + M⁻¹·Gᵀ·λ.
#[derive(Debug, Clone, Default)]
pub struct Spook {
    started_dt: f64,
    multiplier: f64,
    /// Working space for G inside a step.
    gradient: Vec<DVec3>,
}

impl Spook {
    /// The multiplier λ of the last step, the constraint's impulse in units of momentum; 0 without a
    /// constraint.
    #[must_use]
    pub fn multiplier(&self) -> f64 {
        self.multiplier
    }

    /// Solves for the multiplier and adds its impulse to the free velocities.
    ///
    /// `old_rate` is G·v before the kick. Returns the residual of the constraint's equation.
    fn constrain(
        &mut self,
        constraint: &dyn Constraint,
        dynamics: &Dynamics,
        state: &mut State,
        old_rate: f64,
        dt: f64,
    ) -> Result<f64, StepError> {
        let Regularisation { sigma, gamma } =
            Regularisation::new(constraint.compliance(), constraint.damping_time(), dt);
        let wanted_rate = -4.0 / dt * gamma * constraint.value(&state.positions) + gamma * old_rate;
        let inverse_mass: f64 = self
            .gradient
            .iter()
            .enumerate()
            .map(|(i, g)| g.length_squared() / dynamics.masses.of(i))
            .sum();
        let free_rate = rate(&self.gradient, &state.velocities);
        self.multiplier = (wanted_rate - free_rate) / (inverse_mass + sigma);
        if !self.multiplier.is_finite() {
            return Err(StepError::Unsuited {
                method: SPEC.name,
                reason: "the constraint's gradient vanishes or its value is not finite".to_owned(),
            });
        }
        for (i, (v, g)) in state.velocities.iter_mut().zip(&self.gradient).enumerate() {
            *v += (self.multiplier / dynamics.masses.of(i)) * *g;
        }
        let residual =
            rate(&self.gradient, &state.velocities) + sigma * self.multiplier - wanted_rate;
        Ok(residual.abs())
    }
}

/// G·v.
fn rate(gradient: &[DVec3], velocities: &[DVec3]) -> f64 {
    gradient
        .iter()
        .zip(velocities)
        .map(|(g, v)| g.dot(*v))
        .sum()
}

impl Method for Options {
    const OSCILLATOR: OscillatorModel = OscillatorModel::Constraint;
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(Spook::default())
    }
}

impl Persist for Spook {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_f64("started_dt", &[self.started_dt]);
        to.put_f64("multiplier", &[self.multiplier]);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        [self.started_dt] = from.f64s("started_dt")?;
        [self.multiplier] = from.f64s("multiplier")?;
        Ok(())
    }
}

impl Integrator for Spook {
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
        check_suited(&SPEC, forces, dt)?;
        if dynamics.constraints.len() > 1 {
            return Err(StepError::Unsuited {
                method: SPEC.name,
                reason: format!(
                    "it has {} constraints, and the method solves for one so far",
                    dynamics.constraints.len()
                ),
            });
        }
        self.started_dt = dt;
        self.multiplier = 0.0;
        evaluate(&SPEC, state, forces, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_same_step(&SPEC, self.started_dt, dt)?;
        check_suited(&SPEC, forces, dt)?;
        let mut report = StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        };
        if let Some(constraint) = dynamics.constraints.first() {
            self.gradient.resize(state.len(), DVec3::ZERO);
            constraint.gradient(&state.positions, &mut self.gradient);
            let old_rate = rate(&self.gradient, &state.velocities);
            sweeps::kick(&mut state.velocities, &state.forces, &dynamics.masses, dt);
            report.residual = self.constrain(constraint.as_ref(), dynamics, state, old_rate, dt)?;
            report.iterations = 1;
            sweeps::drift(&mut state.positions, &state.velocities, dt);
        } else {
            sweeps::kick_and_drift(
                &mut state.positions,
                &mut state.velocities,
                &state.forces,
                &dynamics.masses,
                dt,
                dt,
            );
        }
        tick(state, dt);
        evaluate(&SPEC, state, forces, want)?;
        Ok(report)
    }
}
