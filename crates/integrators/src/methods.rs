//! What each list of methods has: one enum, and everything that is made from it. What methods provide for their list.

use lennard_core::options::OptionError;
use lennard_core::random::NoiseStream;
use lennard_core::{Integrator, Ramp, System};

/// Makes the enum of a list from lines `Variant: module,`. Each variant holds the `Options` of its module, which implement the trait of
/// the list, and a constant of the module declares the method. The enum serves as the trait object of the chosen method.
macro_rules! list_of_methods {
    (
        $(#[$about:meta])*
        pub enum $list:ident: $trait:ident, declared by $constant:ident: $spec:ident {
            $($(#[$doc:meta])* $variant:ident: $module:ident,)*
        }
    ) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        $(#[$about])*
        pub enum $list {
            $($(#[$doc])* $variant($module::Options),)*
        }

        impl std::ops::Deref for $list {
            type Target = dyn $trait;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(options) => options,)*
                }
            }
        }

        impl $list {
            /// What each method declares about itself, in the order of the list.
            pub const SPECS: &'static [$spec] = &[$($module::$constant,)*];

            /// What the chosen method declares about itself, at its default options.
            #[must_use]
            pub fn spec(&self) -> &'static $spec {
                match self {
                    $(Self::$variant(_) => &$module::$constant,)*
                }
            }

            /// The name in scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                self.spec().name
            }

            /// Every method with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(Default::default()),)*]
            }

            /// The scene keys of every method, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, lennard_core::options::Keys)> {
                use lennard_core::options::Options;
                vec![$(($module::$constant.name, <$module::Options as Options>::KEYS),)*]
            }

            /// Whether every option has a possible value, and all of them go together.
            ///
            /// # Errors
            /// [`lennard_core::options::OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), lennard_core::options::OptionError> {
                use lennard_core::options::Options;
                match self {
                    $(Self::$variant(options) => Options::check(options)?,)*
                }
                self.check_together()
            }
        }
    };
}

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
