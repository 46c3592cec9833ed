//! What the methods share: checks of their options, and the harmonic oscillator.

use lennard_core::options::Options;
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

/// What the options type of each method provides for the list.
pub(crate) trait MethodOptions: Options {
    /// How the method is given the oscillator.
    const OSCILLATOR: OscillatorModel = OscillatorModel::Force;
    /// The method with these options.
    fn build(&self) -> Integrator;
}

/// What the options type of each bath provides for the list.
pub(crate) trait BathOptions: Options {
    /// Couples a method to the bath at `temperature` (ε/k_B), whose random numbers come from `noise`.
    fn couple(&self, method: Integrator, temperature: Ramp, noise: NoiseStream) -> Integrator;
    /// The time in τ in which the bath reduces a deviation of the kinetic energy from its mean by a factor of e. It is 0
    /// for a bath that sets the energy.
    fn relaxation(&self) -> f64;
}

/// Whether drifts act on the bonds of a system: they are rigid, or springs of impulses.
pub(crate) fn acts_on_bonds(system: &System) -> bool {
    system.molecules.are_rigid() || system.molecules.hide_forces()
}
