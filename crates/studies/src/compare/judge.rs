//! The verdicts on measured numbers, and the one function that gives them.

use lennard_core::Tone;
use lennard_io::AverageRecord;
use serde::Serialize;

/// What can be said of a measured number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within the tolerance, which is small enough to see a difference.
    Agrees,
    /// Within the spread of the equations, which is wider than the error: the run tells them apart.
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
    /// There is nothing to compare it with, in this state or at all.
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

    /// The words for a number beside the band of several equations.
    pub(super) fn words_beside_band(self) -> &'static str {
        match self {
            Self::Agrees => "within the band",
            Self::Differs => "outside the band",
            Self::NoReference => "",
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

    /// The verdict of an average by its standing in the run record.
    pub(super) fn of_standing(average: &AverageRecord) -> Self {
        match average.standing.as_str() {
            "not-in-equilibrium" => Self::NotInEquilibrium,
            "too-short" => Self::TooShort,
            "incomplete" => Self::Incomplete,
            "thermostat" => Self::Thermostat,
            _ => Self::NoReference,
        }
    }
}

/// A predicted bias is known to this part of itself: it leaves out how the cutoff changes the structure inside it.
const BIAS_KNOWN_TO: f64 = 0.35;
/// The largest tolerance that sees a difference, as a part of the scale of the quantity.
const COARSEST: f64 = 0.05;
/// A run is sharper than several equations where its error is below this part of their spread.
const SHARPER: f64 = 0.5;

/// A difference from a reference, with all that its verdict depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged {
    /// Measured less reference; from the nearest edge where the reference is a band, and zero inside.
    pub(super) difference: f64,
    /// Standard error of the measured value.
    pub(super) error: f64,
    /// The largest difference that agrees.
    pub(super) tolerance: f64,
    /// The size beside which a difference is small or large.
    pub(super) scale: f64,
    /// The difference that a known bias of the run makes.
    pub(super) bias: Option<f64>,
    /// The width of the band; zero for one reference.
    pub(super) width: f64,
}

/// The verdict on a difference: every table and every sweep asks here. A difference that is not a number agrees with nothing.
pub(super) fn judge(of: Judged) -> Verdict {
    let is_the_bias = |bias: f64| {
        let left = (of.difference - bias).abs();
        bias * of.difference > 0.0 && left <= of.tolerance + BIAS_KNOWN_TO * bias.abs()
    };
    if of.difference.abs() <= of.tolerance {
        if of.error < SHARPER * of.width {
            Verdict::Sharper
        } else if of.tolerance <= COARSEST * of.scale {
            Verdict::Agrees
        } else {
            Verdict::TooCoarse
        }
    } else if of.bias.is_some_and(is_the_bias) {
        Verdict::PredictedBias
    } else {
        Verdict::Differs
    }
}
