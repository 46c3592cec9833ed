//! Störmer–Verlet on positions alone, as Verlet used it in 1967, with the Taylor start.

use lennard_core::parallel::for_each_piece_pair;
use lennard_core::{
    DVec3, Dynamics, ForceProvider, Integrator, IntegratorSpec, Persist, RestoreError, State,
    StateReader, StateWriter, StepError, StepReport, Want,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, begin, check_same_step, check_suited, evaluate, tick};
use crate::velocity_verlet::oscillator_map;

/// Options of Störmer–Verlet: there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {}

/// What Störmer–Verlet declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "stormer-verlet",
    summary: "Störmer–Verlet on positions, started by a Taylor step; publishes the central velocity.",
    equations: "x(t+h) = 2 x(t) - x(t-h) + h^2 a(t); start: x(-h) = x(0) - h v(0) + (h^2/2) a(0); published: v(t) = (x(t) - x(t-h))/h + (h/2) a(t)",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: true,
    velocity_dependent_forces: false,
    has_memory: true,
    conserves_momentum: true,
    half_kicks: true,
    force_evaluations: 1,
    stability_limit: Some(2.0),
    oscillator_map: Some(oscillator_map),
    source: "Verlet, \"Computer experiments on classical fluids. I\", Phys. Rev. 159, 98 (1967), eq. 4",
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

/// The recurrence of a rule, with all that it remembers: the positions of one step ago and that step.
#[derive(Debug, Clone)]
pub(crate) struct Recurrence {
    rule: StepRule,
    spec: &'static IntegratorSpec,
    previous: Vec<DVec3>,
    last_dt: f64,
}

impl Recurrence {
    /// The recurrence of a method, not yet started.
    pub(crate) fn new(rule: StepRule, spec: &'static IntegratorSpec) -> Self {
        Self {
            rule,
            spec,
            previous: Vec::new(),
            last_dt: 0.0,
        }
    }

    /// The Taylor start, x(−h) = x(0) − h·v(0) + ½h²·a(0).
    pub(crate) fn start(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<(), StepError> {
        begin(self.spec, dynamics, state, forces, dt, want)?;
        self.last_dt = dt;
        self.previous = (0..state.len())
            .map(|i| {
                let a = state.forces[i] / dynamics.masses.of(i);
                state.positions[i] - dt * state.velocities[i] + (0.5 * dt * dt) * a
            })
            .collect();
        Ok(())
    }

    /// One step of the recurrence, with forces and published velocity at the new time.
    pub(crate) fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_suited(self.spec, forces, dt)?;
        let (inertia, force_factor) = self.rule.factors(dt, self.last_dt);
        let old_forces = &state.forces;
        for_each_piece_pair(
            &mut state.positions,
            &mut self.previous,
            |first, xs, previous| {
                for (i, (x, p)) in xs.iter_mut().zip(previous).enumerate() {
                    let i = first + i;
                    let a = old_forces[i] / dynamics.masses.of(i);
                    let next = *x + (inertia * (*x - *p) + force_factor * a);
                    *p = *x;
                    *x = next;
                }
            },
        );
        self.last_dt = dt;
        tick(state, dt);
        evaluate(self.spec, state, forces, want)?;
        let (positions, new_forces) = (&state.positions, &state.forces);
        for_each_piece_pair(
            &mut state.velocities,
            &mut self.previous,
            |first, vs, previous| {
                for (i, (v, p)) in vs.iter_mut().zip(previous).enumerate() {
                    let i = first + i;
                    *v = (positions[i] - *p) / dt
                        + (0.5 * dt / dynamics.masses.of(i)) * new_forces[i];
                }
            },
        );
        Ok(StepReport {
            force_evaluations: 1,
            ..StepReport::default()
        })
    }
}

impl Persist for Recurrence {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_vec3("previous_positions", &self.previous);
        to.put_f64("last_dt", &[self.last_dt]);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.previous = from.vec3("previous_positions")?.to_vec();
        [self.last_dt] = from.f64s("last_dt")?;
        Ok(())
    }
}

/// Störmer–Verlet; remembers the positions of one step ago and refuses a changing step.
#[derive(Debug, Clone)]
pub struct StormerVerlet {
    recurrence: Recurrence,
}

impl Default for StormerVerlet {
    fn default() -> Self {
        Self {
            recurrence: Recurrence::new(StepRule::Plain, &SPEC),
        }
    }
}

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(StormerVerlet::default())
    }
}

impl Persist for StormerVerlet {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.recurrence.save(to);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.recurrence.restore(from)
    }
}

impl Integrator for StormerVerlet {
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
        self.recurrence.start(dynamics, state, forces, dt, want)
    }

    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        check_same_step(&SPEC, self.recurrence.last_dt, dt)?;
        self.recurrence.step(dynamics, state, forces, dt, want)
    }
}
