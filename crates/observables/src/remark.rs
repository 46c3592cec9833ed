//! What belongs beside the numbers of a run, as values: words are made where they are shown.

use std::fmt;

use serde::{Deserialize, Serialize};

use lennard_core::number::plus_minus;

/// A remark on the numbers of a run. A program reads its kind and its fields, and a person its words (`Display`).
///
/// The text fields are clauses that complete the sentence of their kind. No program reads them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Remark {
    /// Anything that a reader should know and no program asks for.
    Note {
        /// The sentence.
        words: String,
    },
    /// Quantities that mean nothing in this run, and are not given.
    LeftOut {
        /// Names in the run record.
        quantities: Vec<String>,
        /// Why.
        why: String,
    },
    /// How the heat capacity was found.
    HeatCapacity {
        /// By which fluctuations.
        how: String,
    },
    /// How the response functions were found.
    ResponseFunctions {
        /// By which fluctuations, and what is not given.
        how: String,
    },
    /// The run gives no response functions.
    NoResponseFunctions {
        /// Why.
        why: String,
    },
    /// A fluid that was to be homogeneous has separated into two phases.
    Separated {
        /// By what that is seen.
        why: String,
    },
    /// The last state of a fluid is a crystal, or has one in it.
    Frozen {
        /// The share of solid-like particles.
        solid_share: f64,
    },
    /// Which phase grows, of a crystal beside its liquid.
    Fronts(Fronts),
    /// Few changes of the box are accepted, so that the box moves slowly.
    SlowBox {
        /// The share of accepted changes.
        acceptance: f64,
        /// An interval with enough accepted changes, in steps.
        interval: f64,
        /// A relaxation time with enough accepted changes, τ.
        tau: f64,
    },
    /// The state is no single stable phase by an equation of state, which therefore judges nothing.
    NotJudged {
        /// Name of the equation.
        equation: String,
        /// The state in numbers.
        state: String,
        /// What the equation says it is.
        phase: String,
    },
}

/// What a run tells of the fronts between a crystal and its liquid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "growth", rename_all = "kebab-case")]
pub enum Fronts {
    /// No observable looked.
    NotMeasured,
    /// Too few samples have both phases.
    TooFew {
        /// What there is too little of.
        why: String,
        /// The first and the last share of solid-like particles.
        solid_shares: [f64; 2],
    },
    /// Neither phase is seen to grow.
    Neither {
        /// The first and the last share of solid-like particles.
        solid_shares: [f64; 2],
    },
    /// The crystal grows or melts.
    Moving {
        /// Velocity of each front into the liquid, σ/τ.
        velocity: f64,
        /// Its standard error.
        standard_error: f64,
        /// The first and the last share of solid-like particles.
        solid_shares: [f64; 2],
    },
}

impl fmt::Display for Fronts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shares = |[first, last]: &[f64; 2]| {
            format!(
                "{:.0} % of the particles are solid-like at the beginning, {:.0} % at the end",
                100.0 * first,
                100.0 * last
            )
        };
        match self {
            Self::NotMeasured => {
                f.write_str("without the observable `bond-order` no run tells which phase grows")
            }
            Self::TooFew { why, solid_shares } => {
                write!(f, "no velocity is told, {why}: {}", shares(solid_shares))
            }
            Self::Neither { solid_shares } => {
                write!(f, "neither phase is seen to grow: {}", shares(solid_shares))
            }
            Self::Moving { velocity, standard_error, solid_shares } => write!(
                f,
                "the crystal {}, and each front moves by {} σ/τ while both phases are there: {}",
                if *velocity > 0.0 { "grows" } else { "melts" },
                plus_minus(*velocity, *standard_error),
                shares(solid_shares)
            ),
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Note { words } => f.write_str(words),
            Self::LeftOut { quantities, why } => {
                write!(f, "left out: {}. Here {why}", quantities.join(", "))
            }
            Self::HeatCapacity { how } => write!(f, "heat_capacity: {how}"),
            Self::ResponseFunctions { how } => write!(f, "response functions: {how}"),
            Self::NoResponseFunctions { why } => write!(f, "no response functions: {why}"),
            Self::Separated { why } => {
                write!(f, "separated: {why}; equations and tables of one phase do not describe it")
            }
            Self::Frozen { solid_share } => write!(
                f,
                "frozen: {:.0} % of the particles of the last state are solid-like, by the directions to their neighbors; \
                 equations and tables of fluids do not describe a crystal",
                100.0 * solid_share
            ),
            Self::Fronts(fronts) => write!(f, "crystal: {fronts}"),
            Self::SlowBox { acceptance, interval, tau } => write!(
                f,
                "barostat: {:.0} % of the changes of the box were accepted; the ensemble is right, and the box moves slowly: \
                 take interval = {interval} or tau = {tau:.2}",
                100.0 * acceptance
            ),
            Self::NotJudged { equation, state, phase } => {
                write!(f, "by {equation} the state {state} is {phase}: nothing is judged by it")
            }
        }
    }
}

impl From<String> for Remark {
    fn from(words: String) -> Self {
        Self::Note { words }
    }
}

impl From<&str> for Remark {
    fn from(words: &str) -> Self {
        words.to_owned().into()
    }
}
