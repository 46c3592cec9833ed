//! The one trait behind every integrator.

use glam::DMat2;

use crate::{Dynamics, ForceError, ForceProvider, Persist, State, Want};

/// What a method declares about itself; conformance tests measure each entry.
#[derive(Debug, Clone, Copy)]
pub struct IntegratorSpec {
    /// Name in scene files, with hyphens.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The update equations, in plain text.
    pub equations: &'static str,
    /// Global order of the positions in dt.
    pub position_order: u32,
    /// Global order of the published velocities in dt.
    pub velocity_order: u32,
    /// Preserves phase-space area (measured on the oscillator).
    pub symplectic: bool,
    /// Returns to its start when velocities are reversed.
    pub reversible: bool,
    /// Refuses a step size that changes.
    pub fixed_step_only: bool,
    /// Accepts forces that depend on velocities.
    pub velocity_dependent_forces: bool,
    /// Keeps positions or velocities of other times: must be started anew when something outside
    /// changes the velocities.
    pub has_memory: bool,
    /// Whether total momentum is conserved (no noise).
    pub conserves_momentum: bool,
    /// Ends every step with half a kick and begins the next with the same one, so that v_n ± (h/2)·a_n are its
    /// velocities half a step later and earlier ([`crate::View::half_step_kinetic_energy`]).
    pub half_kicks: bool,
    /// Force evaluations a step; 0 where it varies or none is made.
    pub force_evaluations: u32,
    /// The largest stable ω·dt on the oscillator, if there is a finite one.
    pub stability_limit: Option<f64>,
    /// The one-step map on the oscillator ẍ = −ω²x, as the matrix on (x, v), for (ω, dt).
    pub oscillator_map: Option<fn(f64, f64) -> DMat2>,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What happened in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepReport {
    /// Force evaluations made.
    pub force_evaluations: u32,
    /// Iterations of an inner solver.
    pub iterations: u32,
    /// Residual that the inner solver ended with, in its own norm.
    pub residual: f64,
    /// Energy in ε put in by a heat bath inside the step: E − Σ heat is conserved.
    pub heat: f64,
}

/// Why a step failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The forces failed.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The method assumes F(x).
    #[error(
        "`{method}` assumes that forces depend on positions alone, and these depend on velocities"
    )]
    VelocityDependentForce {
        /// The method's name.
        method: &'static str,
    },
    /// The step changed under a method that needs it fixed.
    #[error(
        "`{method}` needs a fixed step: it was started with dt = {started} and asked for dt = {asked}"
    )]
    ChangingStep {
        /// The method's name.
        method: &'static str,
        /// The step it was started with.
        started: f64,
        /// The step asked for.
        asked: f64,
    },
    /// The step is zero, negative or not finite.
    #[error("dt must be a finite positive number, found {0}")]
    BadStep(f64),
    /// An inner solver did not converge.
    #[error(
        "`{method}` did not solve its equations in {iterations} iterations: residual {residual:e}, wanted {wanted:e}"
    )]
    NotConverged {
        /// The method's name.
        method: &'static str,
        /// Iterations made.
        iterations: u32,
        /// Residual reached.
        residual: f64,
        /// Residual wanted.
        wanted: f64,
    },
    /// The method needs something that this system does not offer.
    #[error("`{method}` cannot run this system: {reason}")]
    Unsuited {
        /// The method's name.
        method: &'static str,
        /// What is missing.
        reason: String,
    },
}

/// Advances a state in time.
///
/// Contract: after `start` and after each `step`, positions, velocities, forces and energetics in
/// `state` all belong to `state.time`, and `state.step` and `state.time` have been advanced by one
/// step and by `dt` (start leaves them as they are).
pub trait Integrator: Persist + Send {
    /// What the method declares about itself.
    fn spec(&self) -> &'static IntegratorSpec;

    /// Evaluates the forces at the start and prepares any memory; called again whenever something
    /// outside the method has changed the state.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail or do not suit the method.
    fn start(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<(), StepError>;

    /// Advances by one step of `dt` and asks the forces at the new time for `want`.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail, the step may not change, or a solver does not converge.
    fn step(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError>;

    /// Advances by up to `steps` steps of `dt` that nobody looks at in between, at least one, with the same bits as
    /// [`Integrator::step`] one by one; gives how many were taken, and what happened in them. The forces at the new time
    /// are asked for `want` where all were taken.
    ///
    /// # Errors
    /// As [`Integrator::step`], at the step where that would fail.
    fn stride(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        forces: &mut dyn ForceProvider,
        dt: f64,
        steps: u64,
        want: Want,
    ) -> Result<(u64, StepReport), StepError> {
        let want = if steps == 1 { want } else { Want::NOTHING };
        let report = self.step(dynamics, state, forces, dt, want)?;
        Ok((1, report))
    }
}
