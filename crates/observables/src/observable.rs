//! What observables are, and what they give back.

use std::any::Any;

use lennard_core::{MOST_SPECIES, Persist, View, Want};
use serde::{Deserialize, Serialize};

use crate::{Cell, Remark, Table};

/// What an observable declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct ObservableSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The defining equation, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
    /// Whether it follows the motion through time, which a bath that kicks particles changes.
    pub dynamic: bool,
    /// The particles that it is right for.
    pub suits: Suits,
    /// The least and the largest number of species that it is right for, beside what `suits` says.
    pub species: [usize; 2],
    /// The surroundings in which it means what its equation says.
    pub surroundings: Surroundings,
    /// Whether it is right in a box that a barostat changes.
    pub follows_changing_box: bool,
    /// Whether its equation needs a bath that holds one temperature.
    pub needs_temperature: bool,
    /// What the frames of a trajectory must have for it.
    pub frames: Frames,
    /// Steps between two samples where the scene names none.
    pub every: u64,
    /// Why one process alone can sample it, in words; `None` where several ranks can: then whatever joins particles is a sum over
    /// all ranks ([`View::sum`]).
    pub alone: Option<&'static str>,
}

impl ObservableSpec {
    /// What most observables declare: a mean over positions of any particles in any surroundings, every ten steps.
    pub const PLAIN: Self = Self {
        name: "",
        summary: "",
        equation: "",
        source: "",
        dynamic: false,
        suits: Suits::All,
        species: [1, MOST_SPECIES],
        surroundings: Surroundings::Any,
        follows_changing_box: true,
        needs_temperature: false,
        frames: Frames::Positions,
        every: 10,
        alone: Some("looks at all particles at once"),
    };
}

/// The surroundings in which an observable means what its equation says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surroundings {
    /// It holds in any.
    Any,
    /// The fluid is periodic along all axes, without walls, fields and held particles.
    Periodic,
    /// The fluid is between walls.
    Walls,
}

/// What the frames of a trajectory must have for an observable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frames {
    /// Positions.
    Positions,
    /// Positions that tell how far each particle has moved since the frame before.
    Paths,
    /// Velocities.
    Velocities,
    /// Velocities, and frames as dense as the samples of a run: an integral over time is taken.
    Flows,
}

/// The particles that an observable is right for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suits {
    /// Atoms and molecules.
    All,
    /// Atoms alone.
    Atoms,
    /// Atoms of one species alone.
    OneSpecies,
    /// Molecules alone.
    Molecules,
}

impl Suits {
    /// Whether it is right for atoms, or for molecules.
    #[must_use]
    pub fn includes(self, molecules: bool) -> bool {
        match self {
            Self::All => true,
            Self::Atoms | Self::OneSpecies => !molecules,
            Self::Molecules => molecules,
        }
    }

    /// Whether it is right for several species.
    #[must_use]
    pub fn includes_mixtures(self) -> bool {
        self != Self::OneSpecies
    }
}

/// An observable: looks at the run, never changes it.
pub trait Observable: Persist + Send + Any {
    /// What it declares about itself.
    fn spec(&self) -> &'static ObservableSpec;
    /// What it needs from the force evaluation on the steps when it samples; nothing where it looks at positions and velocities alone.
    fn want(&self) -> Want {
        Want::NOTHING
    }
    /// Looks at one state.
    fn sample(&mut self, view: &View<'_>);
    /// Averages and tables of the samples after the first `discarded` part of the run, from 0 to 1. All observables
    /// discard the same part, so that the numbers of one table belong to the same states.
    fn finish(&self, discarded: f64) -> Findings;
}

/// A mean with what is known of its error. Numbers that are not finite are `null` in JSON, and NaN when read back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean of the samples that were kept.
    #[serde(with = "finite")]
    pub mean: f64,
    /// Its standard error, correlation included.
    #[serde(with = "finite")]
    pub standard_error: f64,
    /// The number of independent samples that it is worth.
    #[serde(with = "finite")]
    pub n_effective: f64,
    /// The least number of independent samples that it may be worth, by the most careful estimate. This number decides
    /// whether it is too short. Otherwise, of many short series, just the series whose error is too small by chance would
    /// pass. It is in no file.
    #[serde(skip_serializing, default = "unknown")]
    pub least_effective: f64,
    /// Degrees of freedom ν of the standard error, which is itself known to 1/√(2ν) of its value.
    #[serde(with = "finite", default = "unknown")]
    pub freedom: f64,
    /// The number of samples discarded at the start.
    #[serde(default)]
    pub equilibration_cut: u64,
}

fn unknown() -> f64 {
    f64::NAN
}

impl Estimate {
    /// A mean that was not measured.
    pub const UNKNOWN: Self = Self {
        mean: f64::NAN,
        standard_error: f64::NAN,
        n_effective: 0.0,
        least_effective: 0.0,
        freedom: f64::NAN,
        equilibration_cut: 0,
    };

    /// A mean with a standard error, of a series that is worth so many independent samples.
    #[must_use]
    pub const fn new(mean: f64, standard_error: f64, n_effective: f64) -> Self {
        let least_effective = n_effective;
        Self { mean, standard_error, n_effective, least_effective, ..Self::UNKNOWN }
    }

    /// This less another, independent one.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self::new(
            self.mean - other.mean,
            self.standard_error.hypot(other.standard_error),
            self.n_effective.min(other.n_effective),
        )
    }
}

/// The mean and its standard error.
impl From<Estimate> for (f64, f64) {
    fn from(estimate: Estimate) -> Self {
        (estimate.mean, estimate.standard_error)
    }
}

impl From<Estimate> for Cell {
    fn from(estimate: Estimate) -> Self {
        Self::measured(estimate.mean, estimate.standard_error)
    }
}

/// JSON has no NaN and no infinity: they are written as `null` and read as NaN.
pub mod finite {
    use serde::{Deserialize, Deserializer, Serializer};

    /// Writes a number.
    ///
    /// # Errors
    /// As the serializer.
    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { to.serialize_f64(*value) } else { to.serialize_none() }
    }

    /// Reads a number.
    ///
    /// # Errors
    /// As the deserializer.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
    }
}

/// What kind of number a mean is, in one word of the run record.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// A result: nothing speaks against it.
    #[default]
    Sound,
    /// No result, for want of a longer run.
    TooShort,
    /// No result, since something still changes.
    NotInEquilibrium,
    /// No result, since a part of it is not known.
    Incomplete,
    /// Measured, but not the fluid's own.
    Thermostat,
}

impl Standing {
    /// The standing in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::TooShort => "too short",
            Self::NotInEquilibrium => "not in equilibrium",
            Self::Incomplete => "incomplete",
            Self::Thermostat => "thermostat",
        }
    }
}

/// Why a mean is no result, or not the fluid's own.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// The run is too short for an error that covers.
    TooShort {
        /// What there is too little of.
        why: String,
        /// How many times as long the measured part would have to be, at least.
        longer: f64,
    },
    /// What was averaged still changes, or is not at the temperature of its bath.
    NotInEquilibrium(String),
    /// The number lacks a part that is not known: a correlation has not decayed.
    Incomplete(String),
    /// A thermostat changes what is measured.
    Thermostat {
        /// How.
        why: String,
        /// Whether it sets the number, so that there is nothing to have an error.
        sets_it: bool,
    },
}

impl Doubt {
    /// What it makes of a mean.
    #[must_use]
    pub fn standing(&self) -> Standing {
        match self {
            Self::TooShort { .. } => Standing::TooShort,
            Self::NotInEquilibrium(_) => Standing::NotInEquilibrium,
            Self::Incomplete(_) => Standing::Incomplete,
            Self::Thermostat { .. } => Standing::Thermostat,
        }
    }

    /// Whether the mean has no standard error because of it. Under a thermostat that does not set the number, it is what was
    /// measured, and has its error, though the fluid left alone has another.
    #[must_use]
    pub fn takes_the_error(&self) -> bool {
        match self {
            Self::Thermostat { sets_it, .. } => *sets_it,
            Self::TooShort { .. } | Self::NotInEquilibrium(_) | Self::Incomplete(_) => true,
        }
    }

    /// The reason in words, for a run with so many measured steps.
    #[must_use]
    pub fn reason(&self, measured_steps: u64) -> String {
        match self {
            Self::TooShort { why, longer } => {
                let more = (measured_steps as f64 * (longer - 1.0)).max(1.0);
                // Two digits: the number is an estimate.
                let digit = 10_f64.powf(more.log10().floor() - 1.0).max(1.0);
                let more = (more / digit).ceil() * digit;
                if more.is_finite() && more < 1e18 {
                    format!("{why}: at least {more:.0} more steps")
                } else {
                    why.clone()
                }
            }
            Self::NotInEquilibrium(why) | Self::Incomplete(why) | Self::Thermostat { why, .. } => {
                why.clone()
            }
        }
    }

    /// The graver of two doubts, the first where they are alike: what is not in equilibrium needs no error, however long it
    /// is.
    #[must_use]
    pub fn graver(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        let weight = |doubt: &Self| match doubt {
            Self::NotInEquilibrium(_) => (3, 0.0),
            Self::TooShort { longer, .. } => (2, *longer),
            Self::Incomplete(_) => (1, 0.0),
            Self::Thermostat { .. } => (0, 0.0),
        };
        match (one, other) {
            (Some(one), Some(other)) if weight(&other) > weight(&one) => Some(other),
            (one, other) => one.or(other),
        }
    }
}

/// A named estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Average {
    /// Name in the run record (`potential_energy`).
    pub name: String,
    /// What it is and in which unit.
    pub unit: String,
    /// Value with error.
    pub estimate: Estimate,
    /// Why it is no result; `None` where nothing speaks against it.
    pub doubt: Option<Doubt>,
}

impl Average {
    /// A mean against which nothing speaks yet.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>, estimate: Estimate) -> Self {
        Self { name: name.into(), unit: unit.into(), estimate, doubt: None }
    }

    /// With a doubt, if there is one; of two the graver stays.
    #[must_use]
    pub fn doubted(mut self, doubt: Option<Doubt>) -> Self {
        self.doubt = Doubt::graver(self.doubt, doubt);
        self
    }
}

/// What an observable found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Means with their errors.
    pub averages: Vec<Average>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Remarks that belong beside the numbers ("not corrected for finite size: no viscosity given").
    pub remarks: Vec<Remark>,
}

impl Findings {
    /// Adds a remark.
    pub fn remark(&mut self, remark: impl Into<Remark>) {
        self.remarks.push(remark.into());
    }

    /// All remarks in words, each in a line.
    #[must_use]
    pub fn remarks_in_words(&self) -> String {
        let lines: Vec<String> = self.remarks.iter().map(Remark::to_string).collect();
        lines.join("\n")
    }
}
