//! What every integrator's file provides: its declaration and one step, written as kicks, drifts and force evaluations.

use crate::{ForceProperties, IntegratorSpec, Persist, Step, StepError, System, Want};

/// One method of integration: its step as a sequence of operators.
///
/// Contract: after `start` and after each `step`, positions, velocities, forces and energetics of the state all belong to
/// its time.
pub trait Method: Persist + Send {
    /// What the method declares about itself.
    fn spec(&self) -> &'static IntegratorSpec;

    /// Whether the method can run this system with such forces; else the reason.
    ///
    /// The default refuses constraints, which most methods do not solve for.
    ///
    /// # Errors
    /// The reason in words.
    fn suits(&self, system: &System, forces: ForceProperties) -> Result<(), String> {
        let _ = forces;
        without_constraints(system)
    }

    /// Whether particles move by forward [`Step::drift`] alone: hard walls act there and nowhere else.
    ///
    /// The default is that they do not.
    fn takes_hard_walls(&self) -> bool {
        false
    }

    /// Whether the flight of a step comes right after its whole kick, where unilateral contacts are solved for.
    ///
    /// The default is that it does not.
    fn solves_contacts(&self) -> bool {
        false
    }

    /// Whether steps that nothing looks at may be taken at once.
    ///
    /// Each is a kick, a drift and a kick, with friction and noise in the middle of the drift or without
    /// ([`Step::friction_and_noise`]). The default is what the declaration says.
    fn fuses_steps(&self) -> bool {
        self.spec().is_kick_drift_kick
    }

    /// Evaluates the forces at the start and remembers what the steps need.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    fn start(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.forces_at_start()?;
        self.remember(s)
    }

    /// Takes positions or velocities of other times from the present state, whose forces are known. This happens at the
    /// start, and after a bath has changed the velocities. The default remembers nothing.
    ///
    /// # Errors
    /// [`StepError`] where the state does not suit the method.
    fn remember(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let _ = s;
        Ok(())
    }

    /// What the method itself wants of the forces at the end of each step. The default wants forces alone.
    fn wants(&self) -> Want {
        Want::NOTHING
    }

    /// Whether the box may change between steps; else the reason. The default lets it change.
    ///
    /// # Errors
    /// The reason in words, for a method that keeps forces or positions of other times.
    fn lets_box_change(&self) -> Result<(), &'static str> {
        Ok(())
    }

    /// One step.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail or a solver does not converge.
    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError>;
}

/// Refuses a system with constraints or rigid bonds.
///
/// # Errors
/// The reason in words.
pub fn without_constraints(system: &System) -> Result<(), String> {
    rigid_bonds_alone(system)?;
    if system.molecules.are_rigid() {
        return Err("it has rigid bonds, and the method has no form that holds them".to_owned());
    }
    Ok(())
}

/// Refuses a system with constraints other than rigid bonds: what a method says whose kicks and drifts hold them.
///
/// # Errors
/// The reason in words.
pub fn rigid_bonds_alone(system: &System) -> Result<(), String> {
    if system.constraints.is_empty() {
        Ok(())
    } else {
        Err("it has constraints, and the method solves for none".to_owned())
    }
}
