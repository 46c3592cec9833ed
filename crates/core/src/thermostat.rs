//! Heat baths that scale the velocities between steps.

use crate::Persist;

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

/// What a bath sees of the motion after a step.
#[derive(Debug, Clone, Copy)]
pub struct BathStep {
    /// The kinetic energy K > 0, ε.
    pub kinetic: f64,
    /// Degrees of freedom.
    pub n_dof: f64,
    /// The time step, τ.
    pub dt: f64,
    /// The number of the step.
    pub step: u64,
}

/// Couples the velocities to a heat bath after a step: one factor for all of them.
///
/// The heat is (factor² − 1)·K, and E − Σ heat is conserved.
pub trait Thermostat: Persist + Send {
    /// What it declares about itself.
    fn spec(&self) -> &'static ThermostatSpec;

    /// Whether the bath acts after this step.
    fn acts_after(&self, step: u64) -> bool {
        let _ = step;
        true
    }

    /// The factor of all velocities after a step. The bath's own memory advances by the step.
    fn factor(&mut self, at: BathStep) -> f64;

    /// A copy with the same memory.
    fn copy(&self) -> Box<dyn Thermostat>;
}

/// The factor of a bath and the heat that it puts in, ε; `None` for a system at rest, which has no velocities to scale.
pub(crate) fn act(bath: &mut dyn Thermostat, at: BathStep) -> Option<(f64, f64)> {
    let kinetic = at.kinetic;
    if kinetic <= 0.0 {
        return None;
    }
    let factor = bath.factor(at);
    Some((factor, factor * factor * kinetic - kinetic))
}

/// A bath that acts in fused steps, between the two half kicks of a step.
pub struct FusedBath<'a> {
    bath: &'a mut dyn Thermostat,
    n_dof: f64,
    dt: f64,
    /// The step that ends next.
    step: u64,
    heats: Vec<f64>,
}

impl<'a> FusedBath<'a> {
    /// A bath beside steps of `dt` τ, of which `step` ends first.
    pub fn new(bath: &'a mut dyn Thermostat, n_dof: f64, dt: f64, step: u64) -> Self {
        Self { bath, n_dof, dt, step, heats: Vec::new() }
    }

    /// Whether the bath acts after the step that ends next.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.bath.acts_after(self.step)
    }

    /// Ends a step after which the bath does not act.
    pub fn pass(&mut self) {
        self.step += 1;
    }

    /// Ends a step after which the bath acts; returns the factor of all velocities, whose kinetic energy is given, ε.
    pub fn factor(&mut self, kinetic: f64) -> f64 {
        let step = self.step;
        self.step += 1;
        let at = BathStep { kinetic, n_dof: self.n_dof, dt: self.dt, step };
        let Some((factor, heat)) = act(self.bath, at) else {
            return 1.0;
        };
        self.heats.push(heat);
        factor
    }

    /// The heats of the steps so far, ε.
    #[must_use]
    pub fn into_heats(self) -> Vec<f64> {
        self.heats
    }
}
