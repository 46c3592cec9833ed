//! The verdict on a measured number, and the one function that gives it: [`judge`].
//!
//! Comparisons with the literature, state cards, claims of studies, charts and checks of error bars all ask here. What a verdict
//! is called depends on the reader ([`Verdict::words`], [`Verdict::words_beside_band`], [`Verdict::words_of_claim`]); what it is
//! does not.
//!
//! ```
//! use lennard_observables::{Allowed, Reference, Verdict, judge};
//!
//! // A number beside a value, within a tolerance: a claim that holds.
//! assert_eq!(judge(2.04, Reference::value(2.0), Allowed::within(0.05)), Verdict::Agrees);
//! // A number that must be above a bound.
//! assert_eq!(judge(1.0, Reference::above(1.0), Allowed::within(0.0)), Verdict::Differs);
//! // An error of 0.4 sees nothing beside a quantity of size 2.
//! let allowed = Allowed { error: 0.4, scale: 2.0, ..Allowed::within(1.2) };
//! assert_eq!(judge(2.5, Reference::value(2.0), allowed), Verdict::TooCoarse);
//! // A run that tells equations apart.
//! let allowed = Allowed { error: 0.01, scale: 4.0, ..Allowed::within(0.04) };
//! assert_eq!(judge(4.1, Reference::band(4.0, 4.2), allowed), Verdict::Sharper);
//! ```

use crate::{Standing, Tone, finite};
use serde::{Deserialize, Serialize};

/// What can be said of a measured number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within the tolerance, which is small enough to see a difference.
    Agrees,
    /// Within the band of the references, which is wider than the error: the measurement tells the references apart.
    Sharper,
    /// Outside the tolerance, for no reason that is known.
    Differs,
    /// Within a tolerance that is too large to see a difference.
    TooCoarse,
    /// Outside the tolerance by as much as a known bias of the run makes it.
    PredictedBias,
    /// The run, or this quantity, still changes, or is not at the temperature of its bath.
    NotInEquilibrium,
    /// The run is too short for an error that covers.
    TooShort,
    /// The number lacks a part that is not known.
    Incomplete,
    /// A thermostat changes what is measured.
    Thermostat,
    /// There is nothing to compare the number with, in this state or at all.
    #[default]
    NoReference,
}

impl Verdict {
    /// Every verdict.
    pub const ALL: [Self; 10] = [
        Self::Agrees,
        Self::Sharper,
        Self::Differs,
        Self::TooCoarse,
        Self::PredictedBias,
        Self::NotInEquilibrium,
        Self::TooShort,
        Self::Incomplete,
        Self::Thermostat,
        Self::NoReference,
    ];

    /// A word or two for a table.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Sharper => "sharper than the band",
            Self::Differs => "differs",
            Self::TooCoarse => "too coarse to tell",
            Self::PredictedBias => "predicted bias",
            Self::NotInEquilibrium => "not in equilibrium",
            Self::TooShort => "too short",
            Self::Incomplete => "incomplete",
            Self::Thermostat => "changed by a bath or an exchange",
            Self::NoReference => "no reference",
        }
    }

    /// What the words say, in a sentence.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Agrees => "the difference is within what is allowed",
            Self::Sharper => {
                "the band reaches from the lowest to the highest equation, and the error of the run is below half of it: the run tells the \
                 equations apart"
            }
            Self::Differs => "the difference is beyond what is allowed",
            Self::TooCoarse => {
                "the difference is within what is allowed, which is above 5 % of the size of the quantity: a longer run tells"
            }
            Self::PredictedBias => "the difference is as large as a known bias of the run makes it",
            Self::NotInEquilibrium => "the mean still changes, and is no result",
            Self::TooShort => "the run has too few independent samples for an error",
            Self::Incomplete => "the number lacks a part that is not known",
            Self::Thermostat => "a bath or an exchange of velocities changes what is measured",
            Self::NoReference => "there is nothing to compare with",
        }
    }

    /// The words for a number beside the band of several equations.
    #[must_use]
    pub fn words_beside_band(self) -> &'static str {
        match self {
            Self::Agrees => "within the band",
            Self::Differs => "outside the band",
            Self::NoReference => "",
            other => other.words(),
        }
    }

    /// The words for a claim: it holds, or it does not.
    #[must_use]
    pub fn words_of_claim(self) -> &'static str {
        match self {
            Self::Agrees => "holds",
            Self::Differs => "does not hold",
            other => other.words(),
        }
    }

    /// The tone of a cell that says it.
    #[must_use]
    pub fn tone(self) -> Tone {
        match self {
            Self::Agrees => Tone::Good,
            Self::Differs => Tone::Bad,
            Self::TooCoarse
            | Self::PredictedBias
            | Self::NotInEquilibrium
            | Self::TooShort
            | Self::Incomplete
            | Self::Thermostat => Tone::Careful,
            Self::Sharper | Self::NoReference => Tone::Plain,
        }
    }

    /// Whether the number was held against a reference.
    #[must_use]
    pub fn is_judged(self) -> bool {
        matches!(
            self,
            Self::Agrees | Self::Sharper | Self::Differs | Self::TooCoarse | Self::PredictedBias
        )
    }
}

/// What speaks against a mean, before it is held against anything.
impl From<Standing> for Verdict {
    fn from(standing: Standing) -> Self {
        match standing {
            Standing::Sound => Self::NoReference,
            Standing::TooShort => Self::TooShort,
            Standing::NotInEquilibrium => Self::NotInEquilibrium,
            Standing::Incomplete => Self::Incomplete,
            Standing::Thermostat => Self::Thermostat,
        }
    }
}

/// A measured value beside one of the literature, at the measured temperature and density.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What is compared (`pressure`).
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Measured mean.
    #[serde(with = "finite")]
    pub measured: f64,
    /// Value of the literature, `finite_size` included.
    #[serde(with = "finite")]
    pub reference: f64,
    /// What was added to the value of an infinite system to obtain the value of N particles; `null` where nothing was.
    pub finite_size: Option<f64>,
    /// How far the value of N particles may be off by a finite-size term that is not small, or not trusted; `null` where it is.
    pub finite_size_uncertainty: Option<f64>,
    /// Uncertainty that the source states of its value; `null` where it states none.
    pub reference_uncertainty: Option<f64>,
    /// Measured − reference.
    #[serde(with = "finite")]
    pub difference: f64,
    /// Standard error of the difference, the correlation with the measured temperature included.
    #[serde(with = "finite")]
    pub standard_error: f64,
    /// Difference in standard errors.
    #[serde(with = "finite")]
    pub in_standard_errors: f64,
    /// Temperature and density that the reference is taken at.
    pub at: StatePoint,
    /// Author and title, and a DOI where there is one.
    pub source: String,
    /// Which model the source is of, and what else is to be known.
    pub remark: String,
}

/// A thermodynamic state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StatePoint {
    /// Temperature in ε/k_B: that which belongs to the positions.
    #[serde(with = "finite")]
    pub temperature: f64,
    /// Whether it is the temperature of half steps; else it is the temperature of whole steps.
    pub half_steps: bool,
    /// Number density in σ⁻³.
    #[serde(with = "finite")]
    pub density: f64,
}

/// What a number is held against: one value, the band of several, or a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    low: f64,
    high: f64,
}

impl Reference {
    /// One value.
    #[must_use]
    pub const fn value(value: f64) -> Self {
        Self::band(value, value)
    }

    /// Any value from `low` to `high`.
    #[must_use]
    pub const fn band(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Any value larger than a bound.
    #[must_use]
    pub const fn above(bound: f64) -> Self {
        Self::band(bound.next_up(), f64::INFINITY)
    }

    /// Any value smaller than a bound.
    #[must_use]
    pub const fn below(bound: f64) -> Self {
        Self::band(f64::NEG_INFINITY, bound.next_down())
    }

    /// The measured number less the nearest value of the reference; zero inside a band.
    #[must_use]
    pub fn difference(self, measured: f64) -> f64 {
        if (self.low..=self.high).contains(&measured) {
            0.0
        } else if measured < self.low {
            measured - self.low
        } else {
            measured - self.high
        }
    }
}

/// How far a number may be from its reference, and what else its verdict depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// The largest difference that agrees.
    pub tolerance: f64,
    /// The standard error of the measured number; infinite where it tells no references apart.
    pub error: f64,
    /// The size beside which a difference is small or large; infinite where every tolerance sees a difference.
    pub scale: f64,
    /// The difference that a known bias of the run makes.
    pub bias: Option<f64>,
}

impl Allowed {
    /// A difference up to this, and nothing else.
    #[must_use]
    pub const fn within(tolerance: f64) -> Self {
        Self { tolerance, error: f64::INFINITY, scale: f64::INFINITY, bias: None }
    }
}

/// A predicted bias is known to this part of itself: it leaves out how the cutoff changes the structure inside it.
const BIAS_KNOWN_TO: f64 = 0.35;
/// The largest tolerance that sees a difference, as a part of the scale of the quantity.
const COARSEST: f64 = 0.05;
/// A run is sharper than several equations where its error is below this part of their spread.
const SHARPER: f64 = 0.5;

/// The verdict on a measured number. A number that is not finite agrees with no value.
#[must_use]
pub fn judge(measured: f64, reference: Reference, allowed: Allowed) -> Verdict {
    let difference = reference.difference(measured);
    let is_the_bias = |bias: f64| {
        let left = (difference - bias).abs();
        bias * difference > 0.0 && left <= allowed.tolerance + BIAS_KNOWN_TO * bias.abs()
    };
    if difference.abs() <= allowed.tolerance {
        if allowed.error < SHARPER * (reference.high - reference.low) {
            Verdict::Sharper
        } else if allowed.tolerance <= COARSEST * allowed.scale {
            Verdict::Agrees
        } else {
            Verdict::TooCoarse
        }
    } else if allowed.bias.is_some_and(is_the_bias) {
        Verdict::PredictedBias
    } else {
        Verdict::Differs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_met_up_to_its_tolerance() {
        let by = |off: f64| judge(2.0 + off, Reference::value(2.0), Allowed::within(0.125));
        assert_eq!([-0.125, 0.125].map(by), [Verdict::Agrees; 2]);
        assert_eq!([-0.13, 0.13].map(by), [Verdict::Differs; 2]);
    }

    #[test]
    fn a_bound_is_met_beyond_it_alone_and_by_no_missing_number() {
        let any = |reference, measured| judge(measured, reference, Allowed::within(0.0));
        assert_eq!(any(Reference::above(1.0), 1.1), Verdict::Agrees);
        assert_eq!(any(Reference::above(1.0), 1.0), Verdict::Differs);
        assert_eq!(any(Reference::above(1.0), f64::INFINITY), Verdict::Agrees);
        assert_eq!(any(Reference::below(1.0), 1.0), Verdict::Differs);
        assert_eq!(any(Reference::below(1.0), -3.0), Verdict::Agrees);
        assert_eq!(any(Reference::below(1.0), f64::NAN), Verdict::Differs);
    }
}
