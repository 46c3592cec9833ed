//! SPOOK: symplectic Euler whose velocities also satisfy a regularised, damped constraint.

mod bonds;
mod contacts;
mod impulses;
mod problem;

use glam::DMat2;
use lennard_core::{
    Constraint, DVec3, ForceProperties, Integrator, IntegratorSpec, Masses, Method, State, Step,
    StepError, System, remembers_nothing,
};

use crate::OscillatorModel;
use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

pub use bonds::SpookBonds;
pub use contacts::UnilateralLaw;
pub(crate) use contacts::{HeldBonds, step as contact_step};
pub use impulses::{Regular, impacts_at_once, impacts_in_turn, resting_forces, spook_contacts};
pub(crate) use problem::work_of;
pub use problem::{
    Contact, Damping, Problem, Regularisation, Solution, Solver, TwoSided, column, groups,
    push_all, rates,
};

lennard_core::options! {
    /// Options of SPOOK: there are none; compliance and damping belong to the constraint.
    pub struct Options {}
}

/// What SPOOK declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "spook",
    summary: "Symplectic Euler with a regularised, damped constraint solved for in each step: one constraint, or the bonds of molecules.",
    equations: "M v' - G^T L = M v + h f; G v' + S L = -(4/h) y g + y G v; x' = x + h v'; S = (4/h^2) eps/(1 + 4 tau/h), y = 1/(1 + 4 tau/h)",
    position_order: 1,
    velocity_order: 1,
    reversible: false,
    fixed_step_only: true,
    velocity_dependent_forces: true,
    half_kicks: false,
    stability_limit: None,
    oscillator_map: Some(oscillator_map),
    source: "Lacoursière, \"Ghosts and Machines: Regularized Variational Methods for Interactive Simulations of Multibodies with Dry Frictional Contacts\", PhD thesis, Umeå University (2007), the SPOOK stepper",
    on_ranks: false,
    ..VERLET
};

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

/// SPOOK for at most one constraint, or for the bonds of molecules; without any it is symplectic Euler.
///
/// With one constraint the linear system has a single unknown multiplier λ,
/// (G·M⁻¹·Gᵀ + Σ)·λ = −(4/h)·γ·g + γ·G·v − G·(v + h·M⁻¹·f), and v′ = v + h·M⁻¹·f + M⁻¹·Gᵀ·λ.
#[derive(Debug, Clone, Default)]
pub struct Spook {
    /// Working space for the entries of G inside a step.
    gradient: Vec<(usize, DVec3)>,
    /// The bonds of molecules.
    bonds: Option<SpookBonds>,
}

impl Spook {
    /// Solves for the multiplier and adds its impulse to the free velocities.
    ///
    /// `old_rate` is G·v before the kick. Returns the residual of the constraint's equation.
    fn constrain(
        &self,
        constraint: &dyn Constraint,
        masses: &Masses,
        state: &mut State,
        old_rate: f64,
        dt: f64,
    ) -> Result<f64, StepError> {
        let Regularisation { sigma, gamma } =
            Regularisation::new(constraint.compliance(), constraint.damping_time(), dt);
        let wanted_rate = -4.0 / dt * gamma * constraint.value(&state.positions) + gamma * old_rate;
        let entries = self.gradient.iter();
        let inverse_mass: f64 = entries.map(|(i, g)| g.length_squared() / masses.of(*i)).sum();
        let free_rate = rate(&self.gradient, &state.velocities);
        // The impulse of the constraint, in units of momentum.
        let multiplier = (wanted_rate - free_rate) / (inverse_mass + sigma);
        if !multiplier.is_finite() {
            return Err(StepError::Unsuited {
                method: SPEC.name,
                reason: "the constraint's gradient vanishes or its value is not finite".to_owned(),
            });
        }
        for (i, g) in &self.gradient {
            state.velocities[*i] += (multiplier / masses.of(*i)) * *g;
        }
        let residual = rate(&self.gradient, &state.velocities) + sigma * multiplier - wanted_rate;
        Ok(residual.abs())
    }
}

/// G·v.
fn rate(gradient: &[(usize, DVec3)], velocities: &[DVec3]) -> f64 {
    gradient.iter().map(|(i, g)| g.dot(velocities[*i])).sum()
}

/// SPOOK for the bonds of molecules.
#[must_use]
pub fn with_bonds(bonds: SpookBonds) -> Integrator {
    Integrator::new(Spook { bonds: Some(bonds), ..Spook::default() })
}

impl MethodOptions for Options {
    fn oscillator(&self) -> OscillatorModel {
        OscillatorModel::Constraint
    }

    fn build(&self) -> Integrator {
        Integrator::new(Spook::default())
    }
}

remembers_nothing!(Spook { gradient, bonds });

impl Method for Spook {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn suits(&self, system: &System, forces: ForceProperties) -> Result<(), String> {
        if system.molecules.are_rigid() && self.bonds.is_none() && !forces.holds_bonds {
            return Err("it has rigid bonds, and the method was told of none".to_owned());
        }
        match system.constraints.len() {
            0 | 1 => Ok(()),
            more => Err(format!("it has {more} constraints, and the method solves for one so far")),
        }
    }

    /// Contacts act on the sites of bonds behind the back of their constraints.
    fn solves_contacts(&self) -> bool {
        self.bonds.is_none()
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let (system, dt) = (s.system(), s.dt());
        if let Some(bonds) = &mut self.bonds {
            let state = s.parts().state;
            bonds.before_kick(system, &state.positions, &state.velocities);
            s.kick(1.0);
            let state = s.parts().state;
            let heat = bonds.after_kick(system, &state.positions, &mut state.velocities, dt);
            s.add_heat(heat);
        } else if let Some(constraint) = system.constraints.first() {
            let state = s.parts().state;
            self.gradient.clear();
            constraint.gradient(&state.positions, &mut self.gradient);
            let old_rate = rate(&self.gradient, &state.velocities);
            s.kick(1.0);
            let state = s.parts().state;
            let residual =
                self.constrain(constraint.as_ref(), &system.masses, state, old_rate, dt)?;
            s.solved(1, residual);
        } else {
            s.kick(1.0);
        }
        s.drift(1.0);
        s.forces()
    }
}
