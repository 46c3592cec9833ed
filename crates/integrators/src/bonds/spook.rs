//! Bonds as the regularised, damped constraints of SPOOK.

use lennard_core::options::OptionError;
use lennard_core::{Bonds, ForceTerm, Molecules};

use super::spring::Springs;
use super::{BondHolder, BondMethod, BondSpec};
use crate::spook::{Damping, SpookBonds};

lennard_core::options! {
    /// Options of SPOOK's bonds.
    pub struct Options {
        /// Compliance ε, the inverse of a stiffness; 0 is rigid.
        compliance: f64 = 0.0, Between(0.0, 1e9), in "σ²/ε";
        /// Damping time τ over the time step; 2 is critical damping for rigid bonds.
        damping_steps: f64 = 2.0, Between(0.0, 1e9);
        /// Damping time τ, in place of a number of steps.
        damping_time: Option<f64> = None, else "`damping_steps`·`dt`", Between(0.0, 1e9), in "τ";
        /// Gauss–Seidel sweeps over the bonds of each molecule; 0 solves for all of them directly.
        sweeps: u32 = 0, Whole(0, 100_000);
    }
}

impl Options {
    fn damping(&self) -> Damping {
        Damping::new(self.damping_steps, self.damping_time)
    }
}

/// What this way declares about itself.
pub const SPEC: BondSpec = BondSpec {
    name: "spook",
    summary: "Regularised, damped constraints of SPOOK, solved exactly for each molecule; with the integrator `spook` alone.",
    equations: "g = |d| - r; S L = -(4/h) y g + y G v - G (v + h f/m), S = G M^-1 G^T + (4/h^2) eps y, y = 1/(1 + 4 tau/h); v' = v + h f/m + M^-1 G^T L",
    bonds: Bonds::Rigid,
    integrator: Some(crate::spook::SPEC.name),
    source: "Lacoursière, \"Ghosts and Machines: Regularized Variational Methods for Interactive Simulations of Multibodies with Dry Frictional Contacts\", PhD thesis, Umeå University (2007), the SPOOK stepper",
};

impl BondMethod for Options {
    fn bonds(&self) -> Bonds {
        match self.compliance > 0.0 {
            true => Bonds::Impulses,
            false => Bonds::Rigid,
        }
    }

    fn build(&self, molecules: &Molecules) -> BondHolder {
        let bonds = SpookBonds::new(self.compliance, self.damping(), self.sweeps);
        let energy = (self.compliance > 0.0).then(|| -> Box<dyn ForceTerm> {
            Box::new(Springs::of_energy(1.0 / self.compliance, molecules))
        });
        BondHolder::Spook(bonds, energy)
    }

    fn sweeps_alone(&self) -> u32 {
        self.sweeps
    }

    fn damps_vibrations(&self) -> bool {
        self.compliance > 0.0 && !self.damping().is_none()
    }

    fn check_together(&self) -> Result<(), OptionError> {
        self.damping().suits(self.compliance)
    }
}
