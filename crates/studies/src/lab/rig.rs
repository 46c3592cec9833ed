//! A method, forces and a state, stepped by hand: nothing observes, watches or couples to a bath.

use glam::DVec2;
use lennard_core::{Backend, Integrator, State, StepError, StepReport, System, Want};

use lennard_observables::Estimate;
use lennard_observables::statistics::Line;

use crate::StudyError;

/// Bodies on their way, from few on a line to a fluid.
pub struct Rig {
    /// Masses, molecules and constraints.
    pub(crate) system: System,
    /// The bodies as they are.
    pub(crate) state: State,
    /// The forces.
    pub(crate) forces: Box<dyn Backend>,
    /// The time step, τ.
    pub(crate) dt: f64,
    /// What forces give at each step besides themselves.
    pub(crate) want: Want,
    integrator: Integrator,
}

impl Rig {
    /// Starts a method on a state of a system with the time step `dt`, in τ.
    ///
    /// # Errors
    /// [`StudyError::Step`] where the method does not start there.
    pub fn start(
        integrator: Integrator,
        (system, state): (System, State),
        forces: Box<dyn Backend>,
        dt: f64,
        want: Want,
    ) -> Result<Self, StudyError> {
        let mut rig = Self { system, state, forces, dt, want, integrator };
        let Self { system, state, forces, integrator, .. } = &mut rig;
        match integrator.start(system, state, forces.as_mut(), dt, want) {
            Ok(_) => Ok(rig),
            Err(source) => Err(rig.failure(source)),
        }
    }

    fn failure(&self, source: StepError) -> StudyError {
        StudyError::Step { method: self.integrator.spec().name, dt: self.dt, source }
    }

    /// One step of a method that may fail.
    pub(crate) fn try_step(&mut self) -> Result<StepReport, StepError> {
        let Self { system, state, forces, integrator, dt, want } = self;
        integrator.step(system, state, forces.as_mut(), *dt, *want)
    }

    /// One step of a method that must not fail.
    pub(crate) fn step(&mut self) -> Result<StepReport, StudyError> {
        self.try_step().map_err(|source| self.failure(source))
    }

    /// Steps of a method that must not fail, several in one go where the forces can.
    ///
    /// # Errors
    /// [`StudyError::Step`] where a step fails.
    pub fn steps(&mut self, steps: u64) -> Result<(), StudyError> {
        let Self { system, state, forces, integrator, dt, want } = self;
        let advanced = integrator.advance(system, state, forces.as_mut(), *dt, steps, *want);
        advanced.map(drop).map_err(|source| self.failure(source))
    }

    /// Position and velocity of the first body along x after a step that must not fail, σ and σ/τ.
    pub(crate) fn next_point(&mut self) -> Result<DVec2, StudyError> {
        self.step()?;
        Ok(self.point())
    }

    /// Position and velocity of the first body along x, σ and σ/τ.
    pub(crate) fn point(&self) -> DVec2 {
        DVec2::new(self.state.positions[0].x, self.state.velocities[0].x)
    }

    /// Kinetic and potential energy, ε; not a number where no step was to give the potential one.
    pub(crate) fn energy(&self) -> f64 {
        let potential = self.state.energetics.potential_energy;
        self.system.kinetic_energy(&self.state.velocities) + potential.unwrap_or(f64::NAN)
    }
}

/// The slope of energies (t, E) against time, and their RMS about the line. The error of the slope is the error of a line through the
/// means of ten parts. There is none where a part has one energy.
pub(crate) fn drift_of(energies: &[(f64, f64)]) -> (Estimate, f64) {
    const PARTS: usize = 10;
    let line = Line::through(energies);
    let size = energies.len() / PARTS;
    let mean = |part: &[(f64, f64)]| {
        let sum = part.iter().fold((0.0, 0.0), |sum, (t, e)| (sum.0 + t, sum.1 + e));
        (sum.0 / size as f64, sum.1 / size as f64)
    };
    let parts = energies.chunks_exact(size.max(1)).take(PARTS).map(mean);
    let error = match size {
        0 | 1 => f64::NAN,
        _ => Line::through(&parts.collect::<Vec<_>>()).error_of_slope(),
    };
    (Estimate::new(line.slope(), error, f64::NAN), line.rms())
}
