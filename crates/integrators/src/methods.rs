//! What methods of the lists provide.

use lennard_core::options::OptionError;
use lennard_core::random::NoiseStream;
use lennard_core::{Integrator, Ramp, System};

/// How a method is given the harmonic oscillator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OscillatorModel {
    /// As the force −k·x of [`crate::oscillator::HarmonicForces`].
    Force,
    /// As the constraint of [`crate::oscillator::OscillatorConstraint`], with no other force.
    Constraint,
    /// As a force for the published forces, and as its own exact solution
    /// ([`crate::oscillator::ExactOscillator`]).
    ExactSolution,
}

/// What the options type of each integrator provides for the list.
pub trait MethodOptions {
    /// How the method is given the oscillator.
    fn oscillator(&self) -> OscillatorModel {
        OscillatorModel::Force
    }
    /// The method with these options.
    fn build(&self) -> Integrator;
    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

/// What the options type of each bath provides for the list.
pub trait BathOptions {
    /// Couples a method to the bath at `temperature` (ε/k_B), whose random numbers come from `noise`, keyed by step and particle.
    /// A bath that stands inside the step takes the place of the method.
    fn couple(&self, method: Integrator, temperature: Ramp, noise: NoiseStream) -> Integrator;
    /// The time in τ in which the bath reduces a deviation of the kinetic energy from its mean by a factor of e. It is 0
    /// for a bath that sets the energy.
    fn relaxation(&self) -> f64;
    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

/// Whether drifts act on the bonds of a system: they are rigid, or springs of impulses.
pub(crate) fn acts_on_bonds(system: &System) -> bool {
    system.molecules.are_rigid() || system.molecules.hide_forces()
}
