//! Heat baths that act on the velocities between steps.

use crate::{Persist, Step};

/// What a thermostat declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct ThermostatSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Whether it samples the canonical ensemble.
    pub canonical: bool,
    /// Whether single particles move as in the isolated fluid, except for terms of order 1/N.
    pub keeps_motion: bool,
    /// Whether the bath holds the temperature of half steps, and not of whole steps.
    pub holds_half_steps: bool,
    /// Author, title, equation.
    pub source: &'static str,
}

/// Couples the velocities to a heat bath after a step.
pub trait Thermostat: Persist + Send {
    /// What it declares about itself.
    fn spec(&self) -> &'static ThermostatSpec;

    /// Whether the bath may act after this step. Between steps where it does not act, several steps are taken at once.
    fn acts_after(&self, step: u64) -> bool {
        let _ = step;
        true
    }

    /// Changes the velocities and counts the energy put in ([`Step::add_heat`]), so that E − Σ heat is conserved. Returns
    /// whether it changed anything.
    fn apply(&mut self, step: &mut Step<'_>) -> bool;
}
