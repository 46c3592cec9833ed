//! Störmer–Verlet on positions alone, as Verlet used it in 1967, with the Taylor start.

use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::{
    DVec3, ForceProperties, Integrator, IntegratorSpec, Method, Parts, Step, StepError, System,
    persist, rigid_bonds_alone, without_constraints,
};

use crate::methods::{MethodOptions, acts_on_bonds};
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of Störmer–Verlet: there are none.
    pub struct Options {}
}

/// What Störmer–Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "stormer-verlet",
    summary: "Störmer–Verlet on positions, started by a Taylor step; publishes the central velocity.",
    equations: "x(t+h) = 2 x(t) - x(t-h) + h^2 a(t); start: x(-h) = x(0) - h v(0) + (h^2/2) a(0); published: v(t) = (x(t) - x(t-h))/h + (h/2) a(t)",
    fixed_step_only: true,
    holds_rigid_bonds: true,
    source: "Verlet, \"Computer experiments on classical fluids. I\", Phys. Rev. 159, 98 (1967), eq. 4",
    ..VERLET
};

/// How the recurrence treats a step that changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepRule {
    /// x(t+h) = x + (x − x⁻) + a·h²: wrong as soon as h changes.
    Plain,
    /// x(t+h) = x + (x − x⁻)·(h/h⁻) + a·h².
    TimeCorrected,
    /// x(t+h) = x + (x − x⁻)·(h/h⁻) + a·½(h + h⁻)·h.
    MoreExact,
}

impl StepRule {
    /// The factors (f, g) of x(t+h) = x + f·(x − x⁻) + g·a, for the step `dt` (h) after the step
    /// `last_dt` (h⁻), in τ; g in τ².
    #[must_use]
    pub fn factors(self, dt: f64, last_dt: f64) -> (f64, f64) {
        match self {
            Self::Plain => (1.0, dt * dt),
            Self::TimeCorrected => (dt / last_dt, dt * dt),
            Self::MoreExact => (dt / last_dt, 0.5 * (dt + last_dt) * dt),
        }
    }
}

/// Störmer–Verlet by a rule; remembers the positions of one step ago and that step.
#[derive(Debug, Clone)]
pub struct Recurrence {
    rule: StepRule,
    spec: &'static IntegratorSpec,
    previous: Vec<DVec3>,
    last_dt: f64,
}

impl Recurrence {
    /// The recurrence of a method, not yet started.
    #[must_use]
    pub(crate) fn new(rule: StepRule, spec: &'static IntegratorSpec) -> Self {
        Self { rule, spec, previous: Vec::new(), last_dt: 0.0 }
    }
}

impl Recurrence {
    /// The same step by kick and drift of the step itself, which hold bonds: v(t − h/2) follows from the positions.
    fn step_with_bonds(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        let state = s.parts().state;
        let positions = state.positions.iter().zip(&mut self.previous);
        for (v, (x, previous)) in state.velocities.iter_mut().zip(positions) {
            *v = (*x - *previous) / dt;
            *previous = *x;
        }
        s.kick(1.0);
        s.drift(1.0);
        self.last_dt = dt;
        let state = s.parts().state;
        let ends = state.positions.iter().zip(&self.previous);
        for (v, (x, previous)) in state.velocities.iter_mut().zip(ends) {
            *v = (*x - *previous) / dt;
        }
        s.forces()?;
        s.kick(0.5);
        Ok(())
    }
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(Recurrence::new(StepRule::Plain, &SPEC))
    }
}

impl Method for Recurrence {
    fn spec(&self) -> &'static IntegratorSpec {
        self.spec
    }

    /// SHAKE: the next positions are corrected along the bonds as they are, and the published velocity has no part along them. A
    /// step that changes, and impulses of springs, ask for velocities.
    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        if system.molecules.hide_forces() {
            return Err("its springs leave velocities that positions do not tell".to_owned());
        }
        match self.spec.holds_rigid_bonds {
            true => rigid_bonds_alone(system),
            false => without_constraints(system),
        }
    }

    /// The Taylor start, x(−h) = x(0) − h·v(0) + ½h²·a(0).
    fn remember(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        let Parts { system, state, .. } = s.parts();
        self.last_dt = dt;
        self.previous = (0..state.len())
            .map(|i| {
                let a = state.forces[i] / system.masses.of(i);
                state.positions[i] - dt * state.velocities[i] + (0.5 * dt * dt) * a
            })
            .collect();
        Ok(())
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let dt = s.dt();
        if acts_on_bonds(s.system()) {
            return self.step_with_bonds(s);
        }
        let (inertia, force_factor) = self.rule.factors(dt, self.last_dt);
        self.last_dt = dt;
        let masses = &s.system().masses;
        let state = s.parts().state;
        let forces = &state.forces;
        for_each_piece_pair(&mut state.positions, &mut self.previous, |first, xs, ps| {
            for (i, (x, previous)) in (first..).zip(xs.iter_mut().zip(ps)) {
                let a = forces[i] / masses.of(i);
                let next = *x + (inertia * (*x - *previous) + force_factor * a);
                *previous = *x;
                *x = next;
            }
        });
        s.forces()?;
        let state = s.parts().state;
        let (positions, previous, forces) = (&state.positions, &self.previous, &state.forces);
        for_each_piece(&mut state.velocities, |first, vs| {
            for (i, v) in (first..).zip(vs) {
                *v = (positions[i] - previous[i]) / dt + (0.5 * dt / masses.of(i)) * forces[i];
            }
        });
        Ok(())
    }
}

persist!(Recurrence { previous as "previous_positions", last_dt, fixed rule, spec });
