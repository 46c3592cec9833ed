//! Ways to hold the bonds of molecules, one file each.
//!
//! A *rigid* way is a [`BondSolver`]: kick, drift and the position stage after it. The velocity stage is the same for all
//! ([`lennard_core::rigid::project_velocities`]). A *spring* is a force term, and takes no degree of freedom away.

mod chains;
pub mod direct;
mod molecule;
pub mod relaxation;
pub mod spook;
pub mod spring;
#[cfg(test)]
mod tests;

use lennard_core::options::OptionError;
use lennard_core::{BondSolver, Bonds, ForceTerm, Molecules, Topology};

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
pub trait BondMethod {
    /// The way with these options, for such molecules.
    fn build(&self, molecules: &Molecules) -> BondHolder;
    /// Whether bonds are constraints or springs with these options.
    fn bonds(&self) -> Bonds {
        Bonds::Rigid
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

lennard_core::list_of_methods! {
    /// A way to hold bonds, with its options: the scene's table `[bonds]`.
    #[serde(tag = "method", rename_all = "kebab-case")]
    pub enum BondOptions: BondMethod, declared by SPEC: BondSpec {
        /// The exact solution for each molecule.
        Direct: direct::Options,
        /// One bond after another, again and again.
        Relaxation: relaxation::Options,
        /// The constraints of SPOOK.
        Spook: spook::Options,
        /// Stiff springs.
        Spring: spring::Options,
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
    BondOptions::SPECS
}
