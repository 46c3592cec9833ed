//! The list of combining rules, which say σ and ε of two unlike species: one file and one line each.

use lennard_core::options::{Keys, OptionError, Options};
use serde::{Deserialize, Serialize};

/// What a combining rule declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CombiningSpec {
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
}

/// Length and depth of a pair potential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// σ, in σ of the scene.
    pub sigma: f64,
    /// ε, in ε of the scene.
    pub epsilon: f64,
}

/// The deviations of one pair from a combining rule: ε is multiplied by 1 − k, and σ by 1 − l.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deviation {
    /// k; `None` leaves the rule's own.
    pub k: Option<f64>,
    /// l; `None` leaves the rule's own.
    pub l: Option<f64>,
}

/// The file of a combining rule provides this for its options type.
pub trait CombiningRule: Options + Clone + 'static {
    /// What the rule declares about itself.
    const SPEC: CombiningSpec;
    /// Whether a pair may deviate from the rule by its own k and l.
    const DEVIATES: bool = false;

    /// σ and ε of a pair of unlike species; `None` where the scene must write them.
    fn combine(&self, one: Size, other: Size) -> Option<Size>;

    /// The rule for a pair that deviates from it.
    #[must_use]
    fn deviating(&self, deviation: Deviation) -> Self {
        let _ = deviation;
        self.clone()
    }
}

/// Makes options, dispatch and lists from lines `file::Variant = "name",`.
macro_rules! list_of_combining_rules {
    ($($(#[$doc:meta])* $file:ident::$variant:ident = $name:literal,)*) => {
        $(mod $file; pub use $file::$variant;)*

        /// The rule for σ and ε of unlike species: the scene's table `[mixing]`.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "rule")]
        #[non_exhaustive]
        pub enum CombiningOptions {
            $($(#[$doc])* #[serde(rename = $name)] $variant($variant),)*
        }

        impl CombiningOptions {
            /// What the rule declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static CombiningSpec {
                match self {
                    $(Self::$variant(_) => &<$variant as CombiningRule>::SPEC,)*
                }
            }

            /// Whether a pair may deviate from the rule by its own k and l.
            #[must_use]
            pub fn deviates(&self) -> bool {
                match self {
                    $(Self::$variant(_) => <$variant as CombiningRule>::DEVIATES,)*
                }
            }

            /// σ and ε of a pair of unlike species; `None` where the scene must write them.
            #[must_use]
            pub fn combine(&self, one: Size, other: Size, deviation: Deviation) -> Option<Size> {
                match self {
                    $(Self::$variant(rule) => rule.deviating(deviation).combine(one, other),)*
                }
            }

            /// Whether the options lie in their ranges.
            ///
            /// # Errors
            /// [`OptionError`] with the key that is to blame.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(rule) => rule.check(),)*
                }
            }

            /// The scene keys of every rule, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$variant as CombiningRule>::SPEC.name, <$variant as Options>::KEYS),)*]
            }

            /// Every rule with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(<$variant>::default()),)*]
            }
        }

        static RULES: &[CombiningSpec] = &[$(<$variant as CombiningRule>::SPEC,)*];
    };
}

list_of_combining_rules! {
    /// Mean length and geometric mean of depths, with deviations k and l.
    lorentz_berthelot::LorentzBerthelot = "lorentz-berthelot",
    /// Geometric means of both.
    geometric::Geometric = "geometric",
    /// Means of sixth powers.
    waldman_hagler::WaldmanHagler = "waldman-hagler",
    /// Mean length and harmonic mean of depths.
    fender_halsey::FenderHalsey = "fender-halsey",
    /// No rule: the scene writes each pair.
    explicit::Explicit = "explicit",
}

/// Every combining rule that a scene may name.
#[must_use]
pub fn combining_rules() -> &'static [CombiningSpec] {
    RULES
}
