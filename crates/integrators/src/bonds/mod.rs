//! Ways to hold the bonds of molecules, one file each.
//!
//! A *rigid* way is a [`BondSolver`]: kick, drift and the position stage after it. The velocity stage is the same for all
//! ([`lennard_core::rigid::project_velocities`]). A *spring* is a force term, and takes no degree of freedom away.

mod chains;
mod dashpots;
pub mod direct;
mod dumbbells;
mod implicit_springs;
mod molecule;
pub mod relaxation;
pub mod spook;
pub mod spring;
#[cfg(test)]
mod tests;

use lennard_core::options::{Keys, OptionError, Options};
use lennard_core::{BondSolver, Bonds, ForceTerm, Molecules, Topology};
use serde::{Deserialize, Serialize};

use crate::spook::SpookBonds;

/// What a way to hold bonds declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct BondSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The equations, in plain text.
    pub equations: &'static str,
    /// Whether bonds are constraints or springs, with default options.
    pub bonds: Bonds,
    /// The one integrator that solves for them in its step; `None` where they are held in drifts, or by a force.
    pub integrator: Option<&'static str>,
    /// Author, title, equation.
    pub source: &'static str,
}

/// How bonds are held, ready for use.
pub enum BondHolder {
    /// By what happens in a drift.
    Drift(Box<dyn BondSolver>),
    /// By a force.
    Spring(Box<dyn ForceTerm>),
    /// By what acts in a drift, and a term: implicit springs, whose energy alone the term knows, or the dashpots of springs that are forces.
    InDrift(Box<dyn BondSolver>, Box<dyn ForceTerm>),
    /// By the method `spook`, which solves for them in its step, and a term that knows the energy of bonds with a compliance.
    Spook(SpookBonds, Option<Box<dyn ForceTerm>>),
}

/// What the options type of each way provides for the list.
pub(crate) trait BondMethod: Options {
    /// What the way declares about itself.
    const SPEC: BondSpec;
    /// The way with these options, for such molecules.
    fn build(&self, molecules: &Molecules) -> BondHolder;
    /// Whether bonds are constraints or springs with these options.
    fn bonds(&self) -> Bonds {
        Self::SPEC.bonds
    }
    /// Checks options that must go together.
    ///
    /// # Errors
    /// [`OptionError`] for the first that does not.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
    /// Checks options that do not suit every molecule.
    ///
    /// # Errors
    /// [`OptionError`] for the first that does not suit this one.
    fn check_for(&self, topology: &Topology) -> Result<(), OptionError> {
        let _ = topology;
        Ok(())
    }
    /// The angular frequency ω of a bond between two unit masses, τ⁻¹; zero where it does not limit the step.
    fn frequency(&self) -> f64 {
        0.0
    }
    /// Sweeps over the bonds alone in the step of the one integrator that solves for them; 0 without.
    fn sweeps_alone(&self) -> u32 {
        0
    }
    /// Whether vibrations of bonds lose energy, so that no bath keeps them at its temperature.
    fn damps_vibrations(&self) -> bool {
        false
    }
    /// Why a run samples no known ensemble with these options; `None` where it does.
    fn no_ensemble(&self) -> Option<&'static str> {
        self.damps_vibrations()
            .then_some("`[bonds]` take energy from vibrations: these stay colder than the rest")
    }
}

/// Makes the options enum and the list from lines `Variant: module,`.
macro_rules! list_of_bond_methods {
    ($($(#[$doc:meta])* $variant:ident: $module:ident,)*) => {
        /// A way to hold bonds, with its options: the scene's table `[bonds]`.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "method", rename_all = "kebab-case")]
        pub enum BondOptions {
            $($(#[$doc])* $variant($module::Options),)*
        }

        static BOND_METHODS: &[BondSpec] = &[$(<$module::Options as BondMethod>::SPEC,)*];

        impl BondOptions {
            /// What the chosen way declares about itself.
            #[must_use]
            pub fn spec(&self) -> BondSpec {
                match self {
                    $(Self::$variant(_) => <$module::Options as BondMethod>::SPEC,)*
                }
            }

            /// The scene keys of every entry of the list, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((
                    <$module::Options as BondMethod>::SPEC.name,
                    <$module::Options as Options>::KEYS,
                ),)*]
            }

            /// Whether every option has a possible value, and all of them go together.
            ///
            /// # Errors
            /// [`OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(options) => {
                        options.check()?;
                        options.check_together()
                    })*
                }
            }

            /// Whether the options suit such molecules.
            ///
            /// # Errors
            /// [`OptionError`], which names the key, what was found and what is allowed.
            pub fn check_for(&self, topology: &Topology) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(options) => BondMethod::check_for(options, topology),)*
                }
            }

            /// The way with these options, for such molecules.
            #[must_use]
            pub fn build(&self, molecules: &Molecules) -> BondHolder {
                match self {
                    $(Self::$variant(options) => BondMethod::build(options, molecules),)*
                }
            }

            /// Whether bonds are constraints or springs.
            #[must_use]
            pub fn bonds(&self) -> Bonds {
                match self {
                    $(Self::$variant(options) => BondMethod::bonds(options),)*
                }
            }

            /// The angular frequency ω of a bond between two unit masses, τ⁻¹; zero where it does not limit the step.
            #[must_use]
            pub fn frequency(&self) -> f64 {
                match self {
                    $(Self::$variant(options) => BondMethod::frequency(options),)*
                }
            }

            /// Sweeps over the bonds alone in the step of the one integrator that solves for them; 0 without.
            #[must_use]
            pub fn sweeps_alone(&self) -> u32 {
                match self {
                    $(Self::$variant(options) => BondMethod::sweeps_alone(options),)*
                }
            }

            /// Whether vibrations of bonds lose energy, so that no bath keeps them at its temperature.
            #[must_use]
            pub fn damps_vibrations(&self) -> bool {
                match self {
                    $(Self::$variant(options) => BondMethod::damps_vibrations(options),)*
                }
            }

            /// Why a run samples no known ensemble with these options; `None` where it does.
            #[must_use]
            pub fn no_ensemble(&self) -> Option<&'static str> {
                match self {
                    $(Self::$variant(options) => BondMethod::no_ensemble(options),)*
                }
            }

            /// Every way with its default options.
            #[must_use]
            pub fn examples() -> Vec<Self> {
                vec![$(Self::$variant(Default::default()),)*]
            }
        }
    };
}

list_of_bond_methods! {
    /// The exact solution for each molecule.
    Direct: direct,
    /// One bond after another, again and again.
    Relaxation: relaxation,
    /// The constraints of SPOOK.
    Spook: spook,
    /// Stiff springs.
    Spring: spring,
}

impl BondOptions {
    /// The name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.spec().name
    }
}

impl Default for BondOptions {
    fn default() -> Self {
        Self::Direct(Default::default())
    }
}

/// Every way to hold bonds, in the order of `lennard list`.
#[must_use]
pub fn bond_methods() -> &'static [BondSpec] {
    BOND_METHODS
}
