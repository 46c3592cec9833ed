//! What the methods share: the checks at their door, the clock, and the force call.

use std::ops::Range;

use lennard_core::parallel::{all_pieces, for_each_piece};
use lennard_core::{
    Configuration, DVec3, Dynamics, ForceError, ForceProvider, Integrator, IntegratorSpec, Part,
    State, StepError, Want,
};

use crate::OscillatorModel;

/// An option with an impossible value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` = {found} is not allowed: {allowed}")]
pub struct OptionError {
    /// The key inside the method's table (`tau`).
    pub key: &'static str,
    /// The value found.
    pub found: String,
    /// What is allowed, in words.
    pub allowed: &'static str,
}

impl OptionError {
    /// Refuses a number that is not finite and positive.
    pub(crate) fn unless_positive(key: &'static str, value: f64) -> Result<(), Self> {
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(Self {
                key,
                found: format!("{value:?}"),
                allowed: "a finite positive number",
            })
        }
    }

    /// Refuses a count of zero.
    pub(crate) fn unless_counted(key: &'static str, value: u64) -> Result<(), Self> {
        if value > 0 {
            Ok(())
        } else {
            Err(Self {
                key,
                found: value.to_string(),
                allowed: "a whole number of at least 1",
            })
        }
    }
}

/// What the options type of each method provides for the list.
pub(crate) trait Method: Default {
    /// How the method is given the oscillator.
    const OSCILLATOR: OscillatorModel = OscillatorModel::Force;
    /// The method with these options.
    fn build(&self) -> Box<dyn Integrator>;
    /// Whether every option has a possible value.
    fn check(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

/// Implements [`lennard_core::Persist`] for a type that remembers nothing between steps.
macro_rules! remembers_nothing {
    ($type:ty) => {
        impl lennard_core::Persist for $type {
            fn save(&self, _to: &mut lennard_core::StateWriter<'_>) {}
            fn restore(
                &mut self,
                _from: &lennard_core::StateReader<'_>,
            ) -> Result<(), lennard_core::RestoreError> {
                Ok(())
            }
        }
    };
}
pub(crate) use remembers_nothing;

/// Refuses a step that is zero, negative or not finite.
pub(crate) fn check_step(dt: f64) -> Result<(), StepError> {
    if dt.is_finite() && dt > 0.0 {
        Ok(())
    } else {
        Err(StepError::BadStep(dt))
    }
}

/// Refuses a step other than the one that a fixed-step method was started with.
pub(crate) fn check_same_step(
    spec: &'static IntegratorSpec,
    started: f64,
    asked: f64,
) -> Result<(), StepError> {
    check_step(asked)?;
    if asked == started {
        Ok(())
    } else {
        Err(StepError::ChangingStep {
            method: spec.name,
            started,
            asked,
        })
    }
}

/// What the `start` of every method without a constraint solver does first: checks the step, the
/// system and the kind of force, then evaluates the forces.
pub(crate) fn begin(
    spec: &'static IntegratorSpec,
    dynamics: &Dynamics,
    state: &mut State,
    forces: &mut dyn ForceProvider,
    dt: f64,
    want: Want,
) -> Result<(), StepError> {
    check_suited(spec, forces, dt)?;
    refuse_constraints(spec, dynamics)?;
    evaluate(spec, state, forces, want)
}

/// Refuses a system with constraints, for methods that do not solve for them.
pub(crate) fn refuse_constraints(
    spec: &'static IntegratorSpec,
    dynamics: &Dynamics,
) -> Result<(), StepError> {
    if dynamics.constraints.is_empty() {
        Ok(())
    } else {
        Err(StepError::Unsuited {
            method: spec.name,
            reason: "it has constraints, and the method solves for none".to_owned(),
        })
    }
}

/// Checks the step and the kind of force.
pub(crate) fn check_suited(
    spec: &'static IntegratorSpec,
    forces: &dyn ForceProvider,
    dt: f64,
) -> Result<(), StepError> {
    check_step(dt)?;
    if forces.properties().velocity_dependent && !spec.velocity_dependent_forces {
        return Err(StepError::VelocityDependentForce { method: spec.name });
    }
    Ok(())
}

/// Advances the clock by one step of `dt`.
pub(crate) fn tick(state: &mut State, dt: f64) {
    state.step += 1;
    state.time += dt;
}

/// Evaluates the whole force at the state's positions and time, into the state.
pub(crate) fn evaluate(
    spec: &'static IntegratorSpec,
    state: &mut State,
    forces: &mut dyn ForceProvider,
    want: Want,
) -> Result<(), StepError> {
    let at = Configuration {
        positions: &state.positions,
        // Only methods made for it may feed velocities to a force.
        velocities: spec
            .velocity_dependent_forces
            .then_some(state.velocities.as_slice()),
        time: state.time,
    };
    state.energetics = forces.evaluate(at, Part::All, want, &mut state.forces)?;
    check_finite(&state.forces)?;
    Ok(())
}

/// Refuses forces that are not finite, whatever the provider said.
///
/// One running sum is enough to see it: what is not finite never becomes finite again.
pub(crate) fn check_finite(forces: &[DVec3]) -> Result<(), ForceError> {
    let is_finite = |range: Range<usize>| forces[range].iter().sum::<DVec3>().is_finite();
    if all_pieces(forces.len(), is_finite) {
        return Ok(());
    }
    match forces.iter().position(|f| !f.is_finite()) {
        Some(particle) => Err(ForceError::NonFiniteForce { particle }),
        // Finite forces whose sum overflows: absurd, but not what is asked here.
        None => Ok(()),
    }
}

/// Multiplies every velocity by `factor` and returns the kinetic energy gained, in ε, as the
/// difference of the two sums, so that the books balance to the last rounding.
pub(crate) fn scale_velocities(
    dynamics: &Dynamics,
    state: &mut State,
    kinetic_before: f64,
    factor: f64,
) -> f64 {
    for_each_piece(&mut state.velocities, |_, chunk| {
        for v in chunk {
            *v *= factor;
        }
    });
    dynamics.kinetic_energy(&state.velocities) - kinetic_before
}
