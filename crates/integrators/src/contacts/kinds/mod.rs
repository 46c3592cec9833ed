//! The list of contacts: one file and one line each.

use lennard_core::options::{Keys, OptionError, Options};
use lennard_forcefield::ContactLaw;
use serde::{Deserialize, Serialize};

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
pub trait Contact: Options + 'static {
    /// What the contact declares about itself.
    const SPEC: ContactSpec;

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

/// Makes options, dispatch and lists from lines `file::Variant = "name",`.
macro_rules! list_of_contacts {
    ($($(#[$doc:meta])* $file:ident::$variant:ident = $name:literal,)*) => {
        $(mod $file; pub use $file::$variant;)*

        /// What a scene's table `[contact]` says beside `diameter`.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind")]
        #[non_exhaustive]
        pub enum ContactOptions {
            $($(#[$doc])* #[serde(rename = $name)] $variant($variant),)*
        }

        impl ContactOptions {
            /// What the contact declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static ContactSpec {
                match self {
                    $(Self::$variant(_) => &<$variant as Contact>::SPEC,)*
                }
            }

            /// What happens where two bodies touch.
            #[must_use]
            pub fn response(&self) -> Response {
                match self {
                    $(Self::$variant(contact) => contact.response(),)*
                }
            }

            /// The contact with its options, in words.
            #[must_use]
            pub fn in_words(&self) -> String {
                match self {
                    $(Self::$variant(contact) => contact.in_words(),)*
                }
            }

            /// Whether the options lie in their ranges.
            ///
            /// # Errors
            /// [`OptionError`] with the key that is to blame.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(contact) => {
                        contact.check()?;
                        contact.check_together()
                    })*
                }
            }

            /// The scene keys of every contact, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$variant as Contact>::SPEC.name, <$variant as Options>::KEYS),)*]
            }

            /// Every contact with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(<$variant>::default()),)*]
            }
        }

        static CONTACTS: &[ContactSpec] = &[$(<$variant as Contact>::SPEC,)*];
    };
}

list_of_contacts! {
    /// Springs that push bodies apart, with a dashpot.
    soft::Soft = "soft",
    /// Impacts in flight.
    hard::Hard = "hard",
    /// Unilateral constraints.
    spook::Spook = "spook",
}

/// Every contact that a scene may name.
#[must_use]
pub fn contacts() -> &'static [ContactSpec] {
    CONTACTS
}
