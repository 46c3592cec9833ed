//! The list of contacts: one file and one line each.

mod hard;
mod soft;
mod spook;

use lennard_core::options::OptionError;
use lennard_forcefield::ContactLaw;
use serde::Serialize;

use crate::spook::UnilateralLaw;

/// What a contact declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ContactSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text; d is the depth of the overlap.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What happens where two bodies touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Response {
    /// A spring pushes them apart, and a dashpot may act in flights.
    Spring(ContactLaw),
    /// They bounce in flight, and keep this share of their normal speed.
    Impact {
        /// Restitution e, from 0 to 1.
        restitution: f64,
    },
    /// The step of SPOOK solves for the impulses of all that touch.
    Unilateral(UnilateralLaw),
}

impl Response {
    /// Whether the contact acts in flights: impacts, impulses or a dashpot.
    #[must_use]
    pub fn acts_in_flight(&self) -> bool {
        match self {
            Self::Spring(law) => law.is_damped(),
            Self::Impact { .. } | Self::Unilateral(_) => true,
        }
    }
}

/// The file of a contact provides this for its options type.
pub trait ContactKind {
    /// What happens where two bodies touch.
    fn response(&self) -> Response;

    /// The contact with its options, in words.
    fn in_words(&self) -> String;

    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

lennard_core::list_of_methods! {
    /// What a scene's table `[contact]` says beside `diameter`.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    #[non_exhaustive]
    pub enum ContactOptions: ContactKind, declared by SPEC: ContactSpec {
        /// Springs that push bodies apart, with a dashpot.
        Soft: soft::Options,
        /// Impacts in flight.
        Hard: hard::Options,
        /// Unilateral constraints.
        Spook: spook::Options,
    }
}

/// Every contact that a scene may name.
#[must_use]
pub fn contacts() -> &'static [ContactSpec] {
    ContactOptions::SPECS
}
