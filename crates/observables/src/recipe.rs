//! What the file of an observable provides, and what it may know.

use crate::{Insertion, Observable, ObservableError, ObservableSpec};
use lennard_core::options::Options;
use lennard_core::{Molecules, Own, PeriodicBox, SpeciesTable};

/// What an observable may know when it is built.
#[derive(Debug, Clone, PartialEq)]
pub struct BuildContext {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// Number of particles, on all ranks.
    pub n_atoms: usize,
    /// Which of them this process keeps.
    pub own: Own,
    /// Time step in τ.
    pub dt: f64,
    /// Steps between two samples.
    pub every: u64,
    /// Cutoff of the forces in σ.
    pub r_cut: f64,
    /// How particles are bonded to molecules.
    pub molecules: Molecules,
    /// The species, and the species of each particle.
    pub species: SpeciesTable,
    /// What trial particles need; `None` where the measured stages hold no temperature.
    pub insertion: Option<Insertion>,
}

impl BuildContext {
    /// Number of molecules; the number of particles where they are not bonded.
    #[must_use]
    pub fn n_molecules(&self) -> usize {
        self.n_atoms / self.molecules.sites()
    }

    /// The unit of energies that are divided by the number of molecules.
    #[must_use]
    pub fn energy_unit(&self) -> &'static str {
        self.molecules.energy_unit()
    }

    /// The unit of heat capacities that are divided by the number of molecules.
    #[must_use]
    pub fn heat_capacity_unit(&self) -> &'static str {
        if self.molecules.are_atoms() { "k_B per particle" } else { "k_B per molecule" }
    }

    /// Refuses other numbers of species.
    pub(crate) fn has_species(&self, [least, most]: [usize; 2]) -> Result<(), ObservableError> {
        let found = self.species.n_species();
        if (least..=most).contains(&found) {
            return Ok(());
        }
        let allowed = match least == most {
            true => format!("{least} species"),
            false => format!("{least} to {most} species"),
        };
        Err(ObservableError::new("kind", found as f64, allowed))
    }

    /// The time between two samples, every·dt, in τ.
    #[must_use]
    pub fn sample_interval(&self) -> f64 {
        self.every as f64 * self.dt
    }
}

/// What the options type of an observable provides: the list is made of these.
pub trait Recipe: Options {
    /// What the observable declares about itself.
    const SPEC: &'static ObservableSpec;

    /// The shortest measured part of a run that gives it an error, τ.
    fn least_length(&self) -> f64 {
        0.0
    }

    /// Builds the observable.
    ///
    /// # Errors
    /// [`ObservableError`] where an option is impossible in this context.
    fn build(&self, context: &BuildContext) -> Result<Box<dyn Observable>, ObservableError>;
}

/// Says how an observable is made of its options and of what it may know. Some need a run of several of their windows.
macro_rules! recipe {
    ($options:ty $(, lasting $windows:ident windows)?, |$own:pat_param, $context:pat_param| $made:expr) => {
        impl $crate::recipe::Recipe for $options {
            const SPEC: &'static $crate::ObservableSpec = &SPEC;

            $(fn least_length(&self) -> f64 {
                $windows * self.window
            })?

            fn build(
                &self,
                context: &$crate::BuildContext,
            ) -> Result<Box<dyn $crate::Observable>, $crate::ObservableError> {
                let ($own, $context) = (self, context);
                Ok(Box::new($made))
            }
        }
    };
}

pub(crate) use recipe;
