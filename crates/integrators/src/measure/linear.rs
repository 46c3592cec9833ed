//! One-step maps on the harmonic oscillator, and what follows from them.

use std::sync::Arc;

use glam::{DMat2, DVec2};
use lennard_core::{Backend, DVec3, Integrator, PeriodicBox, State, StepError, System};

use super::run;
use crate::oscillator::{ExactOscillator, HarmonicForces, OscillatorConstraint};
use crate::{IntegratorEntry, OscillatorModel};

/// A unit mass on a spring k with a damper c, in the form that a method of the list takes it.
pub struct OscillatorBench {
    stiffness: f64,
    system: System,
    forces: Box<dyn Backend>,
}

/// One moment of an oscillator's run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time, τ.
    pub time: f64,
    /// Displacement, σ.
    pub position: f64,
    /// Velocity, σ/τ.
    pub velocity: f64,
    /// Total energy ½v² + ½k·x², ε.
    pub energy: f64,
}

impl OscillatorBench {
    /// The oscillator of stiffness k (ε/σ²) and damper c (ε·τ/σ²) on a unit mass. An infinite k is
    /// for [`OscillatorModel::Constraint`] alone.
    #[must_use]
    pub fn new(model: OscillatorModel, stiffness: f64, damping: f64) -> Self {
        let mut system = System::atoms(1);
        let spring = || Box::new(HarmonicForces::new(stiffness).with_damping(damping));
        let forces = match model {
            OscillatorModel::Force => spring(),
            OscillatorModel::ExactSolution => {
                system.exact = Some(Arc::new(ExactOscillator::new(stiffness, damping, 1.0)));
                spring()
            }
            OscillatorModel::Constraint => {
                let constraint = OscillatorConstraint::spring(stiffness, damping);
                system.constraints.push(Arc::new(constraint));
                Box::new(HarmonicForces::new(0.0))
            }
        };
        Self { stiffness, system, forces }
    }

    /// A rigid constraint x = 0 (k = ∞) with the damping time τ, for methods that solve for constraints.
    #[must_use]
    pub fn rigid(damping_time: f64) -> Self {
        let mut bench = Self::new(OscillatorModel::Constraint, f64::INFINITY, 0.0);
        let constraint = OscillatorConstraint::new(0.0, damping_time);
        bench.system.constraints = vec![Arc::new(constraint)];
        bench
    }

    /// Runs a method from (x, v) along the x axis and returns the state after `steps` steps.
    ///
    /// # Errors
    /// As the method's own steps.
    pub fn advance(
        &mut self,
        integrator: &mut Integrator,
        start: DVec2,
        dt: f64,
        steps: u64,
    ) -> Result<DVec2, StepError> {
        let mut state = on_the_axis(start);
        let forces = self.forces.as_mut();
        run(integrator, &self.system, forces, &mut state, dt, steps, |_, _| {})?;
        Ok(DVec2::new(state.positions[0].x, state.velocities[0].x))
    }

    /// The whole run from (x, v): `steps` + 1 samples, the start included. The energy of a rigid
    /// constraint is the kinetic one alone.
    ///
    /// # Errors
    /// As the method's own steps.
    pub fn trajectory(
        &mut self,
        integrator: &mut Integrator,
        start: DVec2,
        dt: f64,
        steps: u64,
    ) -> Result<Vec<Sample>, StepError> {
        let stiffness = if self.stiffness.is_finite() { self.stiffness } else { 0.0 };
        let sample = |s: &State| {
            let (x, v) = (s.positions[0].x, s.velocities[0].x);
            Sample {
                time: s.time,
                position: x,
                velocity: v,
                energy: 0.5 * v * v + 0.5 * stiffness * x * x,
            }
        };
        let mut state = on_the_axis(start);
        let mut samples = vec![sample(&state)];
        let forces = self.forces.as_mut();
        run(integrator, &self.system, forces, &mut state, dt, steps, |s, _| {
            samples.push(sample(s))
        })?;
        Ok(samples)
    }

    /// The map of (x, v) over `steps` steps of `dt`, from the images of (1, 0) and (0, 1).
    ///
    /// # Errors
    /// As the method's own steps.
    pub fn map(
        &mut self,
        build: impl Fn() -> Integrator,
        dt: f64,
        steps: u64,
    ) -> Result<DMat2, StepError> {
        let x = self.advance(&mut build(), DVec2::X, dt, steps)?;
        let v = self.advance(&mut build(), DVec2::Y, dt, steps)?;
        Ok(DMat2::from_cols(x, v))
    }
}

fn on_the_axis(start: DVec2) -> State {
    State::new(PeriodicBox::boundless(), vec![DVec3::X * start.x], vec![DVec3::X * start.y])
}

/// The measured map of a method of the list over `steps` steps of `dt` on ẍ = −ω²x, as a matrix on (x, v).
///
/// # Errors
/// As the method's own steps.
pub fn measured_map(
    entry: &IntegratorEntry,
    omega: f64,
    dt: f64,
    steps: u64,
) -> Result<DMat2, StepError> {
    OscillatorBench::new(entry.oscillator, omega * omega, 0.0).map(|| entry.build(), dt, steps)
}

/// The eigenvalues of a map as (real part, imaginary part): a pair of conjugates, or two real ones.
///
/// For the real ones the larger is found first and the other from the determinant, so that neither
/// is lost in a difference.
#[must_use]
pub fn eigenvalues(map: &DMat2) -> [DVec2; 2] {
    let half_trace = 0.5 * (map.x_axis.x + map.y_axis.y);
    // ((m₁₁ − m₂₂)/2)² + m₁₂·m₂₁: the square of the half difference, without cancellation.
    let half_difference = 0.5 * (map.x_axis.x - map.y_axis.y);
    let discriminant = half_difference * half_difference + map.y_axis.x * map.x_axis.y;
    if discriminant < 0.0 {
        let imaginary = (-discriminant).sqrt();
        return [DVec2::new(half_trace, imaginary), DVec2::new(half_trace, -imaginary)];
    }
    let large = half_trace + discriminant.sqrt().copysign(half_trace);
    let small = if large == 0.0 { 0.0 } else { map.determinant() / large };
    [DVec2::new(large, 0.0), DVec2::new(small, 0.0)]
}

/// The amplification a step, the spectral radius of a map over `steps` steps to the power 1/`steps`.
///
/// For conjugate eigenvalues it is √|det|.
#[must_use]
pub fn amplification_per_step(map: &DMat2, steps: u64) -> f64 {
    let [first, second] = eigenvalues(map);
    let radius = if first.y == 0.0 {
        first.length().max(second.length())
    } else {
        map.determinant().abs().sqrt()
    };
    radius.powf(1.0 / steps as f64)
}

/// The angle by which a step turns the oscillator, between 0 and π; `None` where the eigenvalues are
/// real and nothing turns. The exact angle is ω·dt, up to whole turns.
#[must_use]
pub fn phase_per_step(one_step_map: &DMat2) -> Option<f64> {
    let [first, _] = eigenvalues(one_step_map);
    (first.y != 0.0).then(|| first.y.abs().atan2(first.x))
}

/// Growth beyond which a map counts as unstable. It is larger than the rounding of a determinant. A
/// symplectic method reaches it at a relative 1e-26 past its limit, and explicit Euler at ωh =
/// 5e-7.
const GROWTH: f64 = 1e-13;

/// Where to look for a stability limit: above `from`, up to `to`, on a grid of `spacing`, all in ω·dt.
///
/// Methods of higher order have windows of instability as narrow as 0.005; a coarser grid may step over them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchRange {
    /// Lower end, itself taken as stable.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Distance of the steps tried before the first unstable one is refined.
    pub spacing: f64,
}

impl SearchRange {
    /// The smallest step at which `unstable` holds, by grid and bisection; `None` where there is none.
    fn first(&self, unstable: impl Fn(f64) -> bool) -> Option<f64> {
        let cells = ((self.to - self.from) / self.spacing).ceil() as u64;
        let mut high = (1..=cells)
            .map(|i| self.from + self.spacing * i as f64)
            .find(|step| unstable(*step))?;
        let mut low = high - self.spacing;
        while high - low > BISECTION_END * high {
            let middle = 0.5 * (low + high);
            if unstable(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(0.5 * (low + high))
    }
}

/// Relative width at which a bisection ends: far below the 1e-6 asked of stability limits.
const BISECTION_END: f64 = 1e-12;

/// The first ω·dt in `range` at which a one-step map, as a function of ω·dt, amplifies; `None` where
/// there is none.
#[must_use]
pub fn first_unstable_step(map: impl Fn(f64) -> DMat2, range: SearchRange) -> Option<f64> {
    range.first(|step| amplification_per_step(&map(step), 1) > 1.0 + GROWTH)
}

/// Where the theory's map of a method starts to amplify, in ω·dt; `None` where it has no map or never
/// does.
#[must_use]
pub fn theoretical_stability_limit(entry: &IntegratorEntry, range: SearchRange) -> Option<f64> {
    let map = entry.spec.oscillator_map?;
    first_unstable_step(|step| map(1.0, step), range)
}

/// Where a method starts to amplify when it is run, in ω·dt; `None` where it never does.
///
/// Judged by the map over 64 steps: a step is unstable where the method stops or amplifies by
/// more than 10⁻⁶ a step.
#[must_use]
pub fn measured_stability_limit(entry: &IntegratorEntry, range: SearchRange) -> Option<f64> {
    range.first(|dt| match measured_map(entry, 1.0, dt, RUN_LENGTH) {
        Ok(map) => amplification_per_step(&map, RUN_LENGTH) > 1.0 + RUN_GROWTH,
        Err(_) => true,
    })
}

/// Steps of the runs that decide on stability: enough to involve a method's memory, few enough not to
/// overflow.
const RUN_LENGTH: u64 = 64;

/// Growth a step that counts as unstable. Rounding can split a double eigenvalue by √1e-12/64 = 2e-8;
/// a symplectic method passes this at a relative 1e-13 past its limit.
const RUN_GROWTH: f64 = 1e-6;
