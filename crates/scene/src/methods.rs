//! Methods that a table names: each has keys of its own beside the keys of the table.

use lennard_core::options::{Keys, OptionError, Options};
use lennard_forcefield::{CombiningOptions, PotentialOptions, WallOptions};
use lennard_integrators::ContactOptions;
use lennard_integrators::{
    BarostatOptions, BondOptions, IntegratorOptions, ThermostatOptions, respa,
};
use lennard_observables::ObservableOptions;
use serde::de::DeserializeOwned;

use crate::tables::stages::SplitKeys;

/// The methods of one table.
pub(crate) trait Method: DeserializeOwned {
    /// The keys of each method by its name, each declared in the method's own file.
    fn keys() -> Vec<(&'static str, Keys)>;

    /// Whether the keys of the method lie in their ranges and go together.
    ///
    /// # Errors
    /// [`OptionError`] with the key that is to blame.
    fn check(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

/// The names of the methods, in the order of their list.
pub(crate) fn names<M: Method>() -> Vec<&'static str> {
    let mut names = Vec::new();
    for (name, _) in M::keys() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Methods that check themselves, then methods that are checked once all tables are read.
macro_rules! methods {
    (checked $($checked:ident)*; unchecked $($options:ident)*) => {
        $(impl Method for $checked {
            fn keys() -> Vec<(&'static str, Keys)> {
                Self::keys()
            }
            fn check(&self) -> Result<(), OptionError> {
                Self::check(self)
            }
        })*
        $(impl Method for $options {
            fn keys() -> Vec<(&'static str, Keys)> {
                Self::keys()
            }
        })*
    };
}

methods! {
    checked CombiningOptions BondOptions WallOptions ContactOptions ThermostatOptions BarostatOptions;
    unchecked PotentialOptions ObservableOptions
}

impl Method for IntegratorOptions {
    fn keys() -> Vec<(&'static str, Keys)> {
        let mut all = Self::keys();
        // Multiple time steps bring the keys of the split force along.
        all.push((respa::SPEC.name, SplitKeys::KEYS));
        all
    }
    fn check(&self) -> Result<(), OptionError> {
        Self::check(self)
    }
}
