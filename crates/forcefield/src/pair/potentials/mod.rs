//! The list of potentials: one file and one line each.

use lennard_core::options::{Keys, OptionError, Options};
use serde::{Deserialize, Serialize};

use super::{PairPotential, TablePath};

/// The smallest exponent of an inverse power: below it the tail integrals diverge.
const SMALLEST_EXPONENT: i64 = 4;
/// The largest exponent of an inverse power: above it an overlap of 1e-4 σ overflows.
const LARGEST_EXPONENT: i64 = 72;

/// What a potential declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PotentialSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// Name in sentences.
    pub title: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
    /// Whether the potential is Lennard-Jones 12-6, which the literature's equations of state describe.
    pub is_lennard_jones: bool,
}

/// The file of a potential provides this for its options type; `PairPotential` holds the formula.
pub trait Potential: Options + Copy + 'static {
    /// What the potential declares about itself.
    const SPEC: PotentialSpec;
    /// Where the potential falls to zero by itself, with U = U′ = 0: this end replaces `truncation.r_cut`.
    const END: Option<OwnEnd> = None;
    /// Options for the tests, one for each way through the formula.
    const EXAMPLES: &'static [Self];
    /// The formula.
    type Formula: PairPotential;

    /// The formula with these options.
    fn formula(&self) -> Self::Formula;

    /// The potential with its options, in words.
    fn in_words(&self) -> String {
        Self::SPEC.title.to_owned()
    }

    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }

    /// Whether the options go with a cutoff, σ, and with a tail correction where means have one.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the truncation.
    fn check_with(&self, _r_cut: f64, _has_tail: bool) -> Result<(), OptionError> {
        Ok(())
    }

    /// What is to be known of the potential at a temperature (ε/k_B) before the first step.
    fn remark_at(&self, _temperature: f64) -> Option<String> {
        None
    }

    /// The file that the potential reads; `None` where it reads none.
    fn file(&self) -> Option<TablePath> {
        None
    }

    /// The potential with its file at another path, and with the checksum of the file.
    ///
    /// # Errors
    /// [`OptionError`] where the file cannot be used.
    fn with_file(&self, _file: TablePath) -> Result<Self, OptionError> {
        Ok(*self)
    }
}

/// Where a potential ends by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnEnd {
    /// The distance, σ.
    pub r: f64,
    /// The distance in plain text.
    pub in_words: &'static str,
}

/// Makes options, dispatch and lists from lines `file::Variant,`. A name in scene files that does not follow from the variant stands
/// at the end of the line, as `= "name"`.
macro_rules! list_of_potentials {
    ($($(#[$doc:meta])* $file:ident::$variant:ident $(= $name:literal)?,)*) => {
        $(mod $file; pub use $file::$variant;)*

        /// The pair potential U(r), before any truncation, in reduced units: the scene's table `[potential]`.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        #[non_exhaustive]
        pub enum PotentialOptions {
            $($(#[$doc])* $(#[serde(rename = $name)])? $variant($variant),)*
        }

        impl PotentialOptions {
            /// What the potential declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static PotentialSpec {
                match self {
                    $(Self::$variant(_) => &<$variant as Potential>::SPEC,)*
                }
            }

            /// The potential with its options, in words.
            #[must_use]
            pub fn in_words(&self) -> String {
                match self {
                    $(Self::$variant(potential) => potential.in_words(),)*
                }
            }

            /// Where the potential ends by itself; `None` where a truncation ends it.
            #[must_use]
            pub fn own_end(&self) -> Option<OwnEnd> {
                match self {
                    $(Self::$variant(_) => <$variant as Potential>::END,)*
                }
            }

            /// Options of every potential for tests, one for each way through its formula.
            #[must_use]
            pub fn examples() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend(<$variant as Potential>::EXAMPLES.iter().copied().map(Self::$variant));)*
                all
            }

            /// The scene keys of every potential, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$variant as Potential>::SPEC.name, <$variant as Options>::KEYS),)*]
            }

            /// Whether the options lie in their ranges and go together.
            ///
            /// # Errors
            /// [`OptionError`] with the key that is to blame.
            pub(crate) fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(potential) => {
                        potential.check()?;
                        potential.check_together()
                    })*
                }
            }

            /// Whether the options go with a cutoff, σ, and with a tail correction where means have one.
            ///
            /// # Errors
            /// [`OptionError`] with the key that does not fit.
            pub(crate) fn check_with(&self, r_cut: f64, has_tail: bool) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(potential) => potential.check_with(r_cut, has_tail),)*
                }
            }

            /// What is to be known of the potential at a temperature (ε/k_B) before the first step.
            #[must_use]
            pub fn remark_at(&self, temperature: f64) -> Option<String> {
                match self {
                    $(Self::$variant(potential) => potential.remark_at(temperature),)*
                }
            }

            /// The file that the potential reads; `None` where it reads none.
            #[must_use]
            pub fn file(&self) -> Option<TablePath> {
                match self {
                    $(Self::$variant(potential) => potential.file(),)*
                }
            }

            /// The potential with its file at another path, and with the checksum of the file.
            ///
            /// # Errors
            /// [`OptionError`] where the file cannot be used.
            pub fn with_file(&self, file: TablePath) -> Result<Self, OptionError> {
                match self {
                    $(Self::$variant(potential) => potential.with_file(file).map(Self::$variant),)*
                }
            }

            /// The formula with these options.
            pub(super) fn formula(&self) -> Formula {
                match self {
                    $(Self::$variant(potential) => Formula::$variant(potential.formula()),)*
                }
            }

        }

        static POTENTIALS: &[PotentialSpec] = &[$(<$variant as Potential>::SPEC,)*];

        /// The formula of a potential.
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum Formula {
            $($(#[$doc])* $variant(<$variant as Potential>::Formula),)*
        }

        impl std::ops::Deref for Formula {
            type Target = dyn PairPotential;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(formula) => formula,)*
                }
            }
        }
    };
}

list_of_potentials! {
    /// Lennard-Jones 12-6.
    lennard_jones::LennardJones,
    /// Weeks–Chandler–Andersen. Its own end replaces `truncation.r_cut`.
    wca::Wca,
    /// Lennard-Jones/spline. Its own end replaces `truncation.r_cut`.
    lj_spline::LjSpline,
    /// Mie n-m, two inverse powers.
    mie::Mie,
    /// Soft sphere, an inverse power.
    soft_sphere::SoftSphere,
    /// A table of r, U and F.
    table::Table,
    /// No pair potential at all.
    none::NoPotential = "none",
}

impl Default for PotentialOptions {
    fn default() -> Self {
        Self::LennardJones(LennardJones {})
    }
}

/// Every potential that a scene may name.
#[must_use]
pub fn potentials() -> &'static [PotentialSpec] {
    POTENTIALS
}
