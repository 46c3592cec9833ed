//! Heat baths that scale the velocities between steps.

use crate::{FrictionAndNoise, NoiseOfStep, Persist};

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

/// The heat bath of fused steps, and the heat of each step so far.
pub struct FusedBath<'a> {
    kind: Kind<'a>,
    dt: f64,
    /// The number of steps at the end of the step under way, which is where the next step begins.
    step: u64,
    heats: Vec<f64>,
}

enum Kind<'a> {
    /// A bath that scales all velocities between the two half kicks of a step, with the degrees of freedom.
    Scaling(&'a mut dyn Thermostat, f64),
    /// Friction and noise between the two half drifts that follow.
    Noise(FrictionAndNoise),
}

impl<'a> FusedBath<'a> {
    /// A bath that scales velocities, beside steps of `dt` τ, of which `step` ends first.
    pub fn scaling(bath: &'a mut dyn Thermostat, n_dof: f64, dt: f64, step: u64) -> Self {
        Self { kind: Kind::Scaling(bath, n_dof), dt, step, heats: Vec::new() }
    }

    /// Friction and noise in steps of `dt` τ, of which the first begins at a number of steps.
    #[must_use]
    pub fn noise(noise: FrictionAndNoise, dt: f64, step: u64) -> Self {
        Self { kind: Kind::Noise(noise), dt, step, heats: Vec::new() }
    }

    /// Whether the bath scales velocities at the end of the step under way.
    #[must_use]
    pub fn scales(&self) -> bool {
        matches!(&self.kind, Kind::Scaling(bath, _) if bath.acts_after(self.step))
    }

    /// Friction and noise after the step under way, where there are any.
    #[must_use]
    pub fn next_noise(&self) -> Option<NoiseOfStep> {
        match &self.kind {
            Kind::Scaling(..) => None,
            Kind::Noise(noise) => Some(noise.in_step(self.step, self.dt)),
        }
    }

    /// Ends a step at whose end the bath scales; returns the factor of all velocities, whose kinetic energy is given, ε.
    pub fn factor(&mut self, kinetic: f64) -> f64 {
        let (step, dt) = (self.step, self.dt);
        self.step += 1;
        let Kind::Scaling(bath, n_dof) = &mut self.kind else {
            return 1.0;
        };
        let Some((factor, heat)) = act(*bath, BathStep { kinetic, n_dof: *n_dof, dt, step }) else {
            return 1.0;
        };
        self.heats.push(heat);
        factor
    }

    /// Ends a step at whose end the bath does not scale; noise has put in the kinetic energy `gained`, ε: an exact total.
    pub fn pass(&mut self, gained: impl FnOnce() -> f64) {
        self.step += 1;
        if matches!(self.kind, Kind::Noise(_)) {
            self.heats.push(gained());
        }
    }

    /// The heats of the steps so far, ε.
    #[must_use]
    pub fn into_heats(self) -> Vec<f64> {
        self.heats
    }
}
