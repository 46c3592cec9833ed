//! Barostats: operators between steps that change the box.

use crate::{Persist, Ramp, Step, StepError, Want};

/// What a barostat declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct BarostatSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The equation of motion of the box, in plain text.
    pub equation: &'static str,
    /// Name of the only thermostat that it goes with; `None` where each canonical one suits.
    pub thermostat: Option<&'static str>,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What a barostat holds, and what it has to know of the fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureBath {
    /// Pressure P₀, ε/σ³.
    pub pressure: Ramp,
    /// Temperature T₀ of the bath beside it, ε/k_B.
    pub temperature: Ramp,
    /// c_P = V²·P_tail of the homogeneous tail beyond the cutoff, ε·σ³; 0 without tail.
    pub tail: f64,
    /// Estimate of the isothermal compressibility κ, σ³/ε: it sets the pace alone.
    pub compressibility: f64,
}

/// Proposed and accepted changes of the box.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BoxMoves {
    /// Changes proposed.
    pub tried: u64,
    /// Changes accepted.
    pub accepted: u64,
}

crate::persist!(BoxMoves { [tried, accepted] as "moves" });

impl BoxMoves {
    /// The accepted part of the proposed changes; not a number where none was proposed.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        self.accepted as f64 / self.tried as f64
    }
}

/// Couples the box to a pressure after a step.
pub trait Barostat: Persist + Send {
    /// Whether the barostat acts after this step. It then finds what it [`wants`](Barostat::wants) in the state.
    fn acts_after(&self, step: u64) -> bool;

    /// What the barostat wants of the forces at the end of a step after which it acts.
    fn wants(&self) -> Want {
        Want::ENERGY_AND_VIRIAL
    }

    /// Changes box and positions, with the forces of the new state, and counts the work ([`Step::add_heat`]).
    ///
    /// The work is the change of U_s + V·P_tail, so that E + V·P_tail − Σ heat is conserved. Returns whether the box changed.
    ///
    /// # Errors
    /// [`StepError`] where the forces of the new state fail.
    fn apply(&mut self, step: &mut Step<'_>) -> Result<bool, StepError>;

    /// The changes so far.
    fn moves(&self) -> BoxMoves;
}
