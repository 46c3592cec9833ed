//! Heat baths that act on the velocities between steps.

use crate::random::NoiseStream;
use crate::{Dynamics, Persist, State};

/// What a thermostat declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct ThermostatSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Whether it samples the canonical ensemble.
    pub canonical: bool,
    /// Whether the motion of single particles stays that of the fluid left alone, but for what vanishes as 1/N.
    pub keeps_motion: bool,
    /// Whether the bath holds the temperature of half steps, and not that of whole steps.
    pub holds_half_steps: bool,
    /// Author, title, equation.
    pub source: &'static str,
}

/// Couples the velocities to a heat bath, once after each step.
pub trait Thermostat: Persist + Send {
    /// What it declares about itself.
    fn spec(&self) -> &'static ThermostatSpec;

    /// Changes the velocities and returns the energy put in, in ε, so that E − Σ heat is conserved;
    /// returns `None` where nothing was touched on this step. `noise` is keyed by `state.step`.
    fn apply(
        &mut self,
        dynamics: &Dynamics,
        state: &mut State,
        dt: f64,
        noise: &NoiseStream,
    ) -> Option<f64>;
}
