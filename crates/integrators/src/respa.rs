//! Reversible RESPA: the near force with short steps inside long steps of the far force.

use glam::DMat2;
use lennard_core::parallel::for_each_piece_pair;
use lennard_core::{
    Configuration, DVec3, Dynamics, Energetics, ForceProvider, Integrator, IntegratorSpec, Part,
    Persist, RestoreError, State, StateReader, StateWriter, StepError, StepReport, Want, sweeps,
};
use serde::{Deserialize, Serialize};

use crate::common::{Method, OptionError, check_finite, check_suited, tick};
use crate::oscillator::HarmonicForces;

/// Options of RESPA.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Options {
    /// Steps of the near force inside one step of the far force.
    pub inner_steps: u32,
}

/// Inner steps where nothing else is asked for; the one-step map of the list is for this number.
const DEFAULT_INNER_STEPS: u32 = 4;

impl Default for Options {
    /// Four: enough to see what the split gains, few enough to stay clear of resonances in a fluid.
    fn default() -> Self {
        Self {
            inner_steps: DEFAULT_INNER_STEPS,
        }
    }
}

/// What RESPA declares about itself, with its default number of inner steps.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "respa",
    summary: "Reversible multiple time steps: velocity Verlet on the near force inside kicks of the far force.",
    equations: "v += (h/2) a_far; n times: v += (h/2n) a_near, x += (h/n) v, v += (h/2n) a_near; v += (h/2) a_far",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    has_memory: false,
    conserves_momentum: true,
    half_kicks: false,
    force_evaluations: DEFAULT_INNER_STEPS + 1,
    stability_limit: Some(2.695_592),
    oscillator_map: Some(oscillator_map),
    source: "Tuckerman, Berne and Martyna, \"Reversible multiple time scale molecular dynamics\", J. Chem. Phys. 97, 1990 (1992)",
};

/// One step on ẍ = −ω²x as a matrix on (x, v), with the default inner steps and the oscillator's
/// spring split as [`HarmonicForces::NEAR_SHARE`] says.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    split_oscillator_map(omega, dt, DEFAULT_INNER_STEPS, HarmonicForces::NEAR_SHARE)
}

/// One step on ẍ = −ω²x as a matrix on (x, v), with `inner_steps` inner steps and the share
/// `near_share` of ω² in the near force.
#[must_use]
pub fn split_oscillator_map(omega: f64, dt: f64, inner_steps: u32, near_share: f64) -> DMat2 {
    let omega_squared = omega * omega;
    let far_kick = DMat2::from_cols_array_2d(&[
        [1.0, -0.5 * dt * (1.0 - near_share) * omega_squared],
        [0.0, 1.0],
    ]);
    let near = crate::velocity_verlet::oscillator_map(
        omega * near_share.sqrt(),
        dt / f64::from(inner_steps),
    );
    let inner = (0..inner_steps).fold(DMat2::IDENTITY, |map, _| near * map);
    far_kick * inner * far_kick
}

/// Reversible RESPA; keeps the two parts of the force at the current positions apart.
#[derive(Debug, Clone)]
pub struct Respa {
    inner_steps: u32,
    near: Vec<DVec3>,
    far: Vec<DVec3>,
}

impl Respa {
    /// With the given options.
    #[must_use]
    pub fn new(options: &Options) -> Self {
        Self {
            inner_steps: options.inner_steps,
            near: Vec::new(),
            far: Vec::new(),
        }
    }

    /// Evaluates the far part and adds it to the near one, which is already there.
    fn complete(
        &mut self,
        near: &Energetics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        want: Want,
    ) -> Result<(), StepError> {
        let at = at_positions(state, state.time);
        let far = forces.evaluate(at, Part::Far, want, &mut self.far)?;
        let near_forces = &self.near;
        for_each_piece_pair(&mut state.forces, &mut self.far, |first, sums, fars| {
            for ((sum, far), near) in sums.iter_mut().zip(fars).zip(&near_forces[first..]) {
                *sum = *near + *far;
            }
        });
        check_finite(&state.forces)?;
        state.energetics = near.plus(&far);
        Ok(())
    }
}

fn at_positions(state: &State, time: f64) -> Configuration<'_> {
    Configuration {
        positions: &state.positions,
        velocities: None,
        time,
    }
}

impl Method for Options {
    fn build(&self) -> Box<dyn Integrator> {
        Box::new(Respa::new(self))
    }

    fn check(&self) -> Result<(), OptionError> {
        OptionError::unless_counted("inner_steps", u64::from(self.inner_steps))
    }
}

impl Persist for Respa {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_vec3("near_forces", &self.near);
        to.put_vec3("far_forces", &self.far);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.near = from.vec3("near_forces")?.to_vec();
        self.far = from.vec3("far_forces")?.to_vec();
        Ok(())
    }
}

impl Integrator for Respa {
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
        crate::common::refuse_constraints(&SPEC, dynamics)?;
        if !forces.properties().splits {
            return Err(StepError::Unsuited {
                method: SPEC.name,
                reason: "its forces do not come in a near and a far part".to_owned(),
            });
        }
        self.near.resize(state.len(), DVec3::ZERO);
        self.far.resize(state.len(), DVec3::ZERO);
        let near = forces.evaluate(
            at_positions(state, state.time),
            Part::Near,
            want,
            &mut self.near,
        )?;
        self.complete(&near, state, forces, want)
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
        let masses = &dynamics.masses;
        let inner_dt = dt / f64::from(self.inner_steps);
        let started = state.time;
        let mut near = Energetics::default();
        sweeps::kick(&mut state.velocities, &self.far, masses, 0.5 * dt);
        for inner in 1..=self.inner_steps {
            sweeps::kick_and_drift(
                &mut state.positions,
                &mut state.velocities,
                &self.near,
                masses,
                0.5 * inner_dt,
                inner_dt,
            );
            let last = inner == self.inner_steps;
            let wanted = if last { want } else { Want::NOTHING };
            let at = at_positions(state, started + f64::from(inner) * inner_dt);
            near = forces.evaluate(at, Part::Near, wanted, &mut self.near)?;
            check_finite(&self.near)?;
            sweeps::kick(&mut state.velocities, &self.near, masses, 0.5 * inner_dt);
        }
        tick(state, dt);
        self.complete(&near, state, forces, want)?;
        sweeps::kick(&mut state.velocities, &self.far, masses, 0.5 * dt);
        Ok(StepReport {
            force_evaluations: self.inner_steps + 1,
            ..StepReport::default()
        })
    }
}
