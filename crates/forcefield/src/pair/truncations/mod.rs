//! The list of truncations: one file each, and one line for each form that kernels compile in.

mod cut;
mod force_shift;
mod shift;
mod switch;
mod xplor;

pub use force_shift::ForceShift;
pub use switch::Switch;
pub use xplor::Xplor;

use lennard_core::options::OptionValue;
use serde::{Deserialize, Serialize};

use super::{Constants, Pair, PairForm, PairPotential};
use crate::error::ForceFieldError;
use crate::options::TruncationOptions;
use crate::real::Real;

/// What a truncation declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TruncationSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
    /// Whether the energy jumps at r_cut. Conservation is then judged without the jump, and means may be corrected for the
    /// tail beyond.
    #[serde(skip)]
    pub jumps: bool,
    /// Whether it weights the potential below r_cut, which has no meaning for a potential that ends by itself.
    #[serde(skip)]
    pub weights: bool,
}

/// Plain or shifted cutoff: U − `shift`.
#[derive(Clone, Copy, Debug)]
pub struct Plain<P> {
    /// The potential.
    pub potential: P,
    /// What is subtracted from the energy: 0, or U(r_cut), in units of the potential.
    pub shift: f64,
}

impl<P: PairPotential> PairForm for Plain<P> {
    const RARE_IN_MIXTURES: bool = P::RARE_IN_MIXTURES;
    const VANISHES: bool = P::VANISHES;
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn constants(&self) -> Constants<f64> {
        [self.shift, 0.0]
    }
    #[inline(always)]
    fn eval_with<R: Real>(&self, [shift, _]: Constants<R>, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.potential.eval(r2, inv_r2);
        Pair { energy: pair.energy - shift, ..pair }
    }
    #[inline(always)]
    fn add_up<R: Real>(&self, r2: R, inv_r2: R, sums: [R; 3]) -> (R, [R; 3]) {
        self.potential.add_up(r2, inv_r2, sums)
    }
    fn totals(&self, sums: [f64; 3], pairs: u64) -> [f64; 3] {
        let [energy, virial, laplacian] = self.potential.totals(sums);
        [energy - pairs as f64 * self.shift, virial, laplacian]
    }
}

impl<P> Plain<P> {
    /// A potential that ends by itself.
    pub fn uncut(potential: P) -> Self {
        Self { potential, shift: 0.0 }
    }
}

/// Makes kinds, forms and dispatch from lines `Form { Kind: file, … }`: the truncations that share a form share its
/// instances of the kernels.
macro_rules! list_of_truncations {
    ($d:tt $($form:ident { $($(#[$doc:meta])* $kind:ident: $file:ident,)* })*) => {
        /// How the potential ends at r_cut.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[non_exhaustive]
        pub enum TruncationKind {
            $($($(#[$doc])* $kind,)*)*
        }

        impl TruncationKind {
            /// Every truncation, in the order of the list.
            pub const ALL: &'static [Self] = &[$($(Self::$kind,)*)*];

            /// What the truncation declares about itself.
            #[must_use]
            pub fn spec(self) -> &'static TruncationSpec {
                match self {
                    $($(Self::$kind => &$file::SPEC,)*)*
                }
            }

            /// The truncation in words, at the end of a model's name.
            pub(super) fn in_words(self, options: &TruncationOptions) -> String {
                match self {
                    $($(Self::$kind => $file::in_words(options),)*)*
                }
            }

            /// Refuses options that do not go with the truncation.
            pub(super) fn check(self, options: &TruncationOptions) -> Result<(), ForceFieldError> {
                match self {
                    $($(Self::$kind => $file::check(options),)*)*
                }
            }
        }

        /// A potential with any truncation.
        #[derive(Clone, Copy, Debug)]
        pub enum Truncated<P> {
            $(
                #[doc = concat!("The form `", stringify!($form), "`.")]
                $form($form<P>),
            )*
        }

        impl<P: PairPotential> Truncated<P> {
            /// The potential with the truncation of the options.
            pub(super) fn new(potential: P, options: &TruncationOptions) -> Self {
                match options.kind {
                    $($(TruncationKind::$kind => Self::$form($file::form(potential, options)),)*)*
                }
            }
        }

        static TRUNCATIONS: &[TruncationSpec] = &[$($($file::SPEC,)*)*];

        /// Runs `$body` with `$form` bound to the form of a truncated potential, or to a potential that ends by itself.
        macro_rules! with_truncated {
            (ends $d value:ident, $d form:ident => $d body:expr) => {{
                let $d form = $d value;
                $d body
            }};
            ($d value:ident, $d form:ident => $d body:expr) => {
                match $d value {
                    $($crate::pair::Truncated::$form($d form) => $d body,)*
                }
            };
        }
        pub(crate) use with_truncated;
    };
}

list_of_truncations! { $
    Plain {
        /// Plain cutoff: U as it is up to r_cut, zero beyond; the energy jumps there.
        #[default]
        Cut: cut,
        /// U − U(r_cut): the same forces as the plain cutoff, and a continuous energy.
        Shift: shift,
    }
    ForceShift {
        /// U − U(r_cut) − U′(r_cut)·(r − r_cut): energy and force are continuous.
        ForceShift: force_shift,
    }
    Switch {
        /// U·S with a quintic S in r², from 1 at `switch_from` to 0 at r_cut: energy, force and curvature are continuous.
        Switch: switch,
    }
    Xplor {
        /// U·S with a cubic S in r², from 1 at `switch_from` to 0 at r_cut: energy and force are continuous.
        Xplor: xplor,
    }
}

impl TruncationKind {
    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.spec().name
    }

    /// The names of all truncations.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        TRUNCATIONS.iter().map(|spec| spec.name).collect()
    }
}

impl OptionValue for TruncationKind {
    fn written(&self) -> String {
        format!("\"{}\"", self.name())
    }
}

/// Every truncation that a scene may name.
#[must_use]
pub fn truncations() -> &'static [TruncationSpec] {
    TRUNCATIONS
}

/// Refuses a start of a switch for a truncation that has none.
fn without_switch(options: &TruncationOptions) -> Result<(), ForceFieldError> {
    match options.switch_from {
        Some(from) => Err(ForceFieldError::SwitchWithoutSwitch(from)),
        None => Ok(()),
    }
}
