//! The list of truncations: one file and one line each.

mod cut;
mod force_shift;
mod options;
mod shift;
mod switch;
mod xplor;

use lennard_core::number::short;
use lennard_core::options::OptionValue;
use serde::{Deserialize, Serialize};

use super::potentials::Formula;
use super::smoothstep::{Smoothstep, weighted};
use super::{Pair, Side};
use crate::error::ForceFieldError;
pub use options::{CutoffUnit, LONGEST_CUTOFF, SHORTEST_CUTOFF, TruncationOptions};

/// What a truncation declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TruncationSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// The kind at the beginning of the truncation in words.
    #[serde(skip)]
    pub in_words: &'static str,
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

/// What a truncation makes of a potential up to r_cut, with its numbers in units of the potential.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Truncation {
    /// U − `shift`: a plain cutoff, or a shifted one.
    Plain {
        /// 0, or U(r_cut).
        shift: f64,
    },
    /// U − U(r_cut) − U′(r_cut)·(r − r_cut), so that −U′/r becomes −U′/r + U′(r_cut)/r.
    ForceShift {
        /// U′(r_cut).
        slope: f64,
        /// U(r_cut) − U′(r_cut)·r_cut.
        constant: f64,
    },
    /// U·S(r²) with the quintic step.
    Switch(Smoothstep),
    /// U·S(r²) with the cubic step.
    Xplor(Smoothstep),
}

impl Truncation {
    /// r² where the potential begins to change, σ²; none where it changes everywhere alike.
    pub fn joint2(&self) -> Option<f64> {
        match self {
            Self::Plain { .. } | Self::ForceShift { .. } => None,
            Self::Switch(step) | Self::Xplor(step) => Some(step.begin2()),
        }
    }

    /// The values of a pair at r² = `r2` σ² on a side of the joint.
    #[inline(always)]
    pub fn of(&self, pair: Pair<f64>, side: Side, r2: f64) -> Pair<f64> {
        match self {
            Self::Plain { shift } => Pair { energy: pair.energy - shift, ..pair },
            Self::ForceShift { slope, constant } => Pair {
                energy: pair.energy - (r2.sqrt() * slope + constant),
                force: (1.0 / r2).sqrt() * slope + pair.force,
                curvature: pair.curvature,
            },
            Self::Switch(step) => weighted(pair, step.quintic(side, r2), r2),
            Self::Xplor(step) => weighted(pair, step.cubic(side, r2), r2),
        }
    }
}

/// Makes kinds and dispatch from lines `Kind: file`.
macro_rules! list_of_truncations {
    ($($(#[$doc:meta])* $kind:ident: $file:ident,)*) => {
        /// How the potential ends at r_cut.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[non_exhaustive]
        pub enum TruncationKind {
            $($(#[$doc])* $kind,)*
        }

        impl TruncationKind {
            /// Every truncation, in the order of the list.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// What the truncation declares about itself.
            #[must_use]
            pub fn spec(self) -> &'static TruncationSpec {
                match self {
                    $(Self::$kind => &$file::SPEC,)*
                }
            }

            /// What the truncation makes of a potential.
            pub(super) fn of(self, formula: &Formula, options: &TruncationOptions) -> Truncation {
                match self {
                    $(Self::$kind => $file::truncation(formula, options),)*
                }
            }
        }

        static TRUNCATIONS: &[TruncationSpec] = &[$($file::SPEC,)*];
    };
}

list_of_truncations! {
    /// Plain cutoff: U as it is up to r_cut, zero beyond; the energy jumps there.
    #[default]
    Cut: cut,
    /// U − U(r_cut): the same forces as the plain cutoff, and a continuous energy.
    Shift: shift,
    /// U − U(r_cut) − U′(r_cut)·(r − r_cut): energy and force are continuous.
    ForceShift: force_shift,
    /// U·S with a quintic S in r², from 1 at `switch_from` to 0 at r_cut: energy, force and curvature are continuous.
    Switch: switch,
    /// U·S with a cubic S in r², from 1 at `switch_from` to 0 at r_cut: energy and force are continuous.
    Xplor: xplor,
}

impl TruncationKind {
    /// The truncation in words, at the end of a model's name.
    pub(super) fn in_words(self, options: &TruncationOptions) -> String {
        let TruncationSpec { in_words, weights, jumps, .. } = *self.spec();
        let at = options.length_in_words(options.r_cut);
        if weights {
            return format!("{in_words} from {} to {at}", short(options.switch_begins()));
        }
        let with = if options.tail_correction { "with" } else { "without" };
        let tail = if jumps { format!(", {with} tail correction") } else { String::new() };
        format!("{in_words} at {at}{tail}")
    }

    /// Refuses a start of a switch that does not go with the truncation.
    pub(super) fn check(self, options: &TruncationOptions) -> Result<(), ForceFieldError> {
        let r_cut = options.r_cut;
        match options.switch_from {
            Some(found) if !self.spec().weights => Err(ForceFieldError::SwitchWithoutSwitch(found)),
            Some(found) if !(found > 0.0 && found < r_cut) => {
                Err(ForceFieldError::BadSwitch { found, r_cut })
            }
            _ => Ok(()),
        }
    }

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
