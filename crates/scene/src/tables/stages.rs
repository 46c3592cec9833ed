//! The tables `[integrator]`, `[[stage]]` and `[[observable]]`: how time advances, under which baths, and what is measured.

use lennard_core::options::MOST_STEPS;
use std::fmt;

use lennard_core::Ramp;
use lennard_core::options::OptionValue;
use lennard_forcefield::SplitOptions;
use lennard_integrators::{BarostatOptions, ExchangeOptions, IntegratorOptions, ThermostatOptions};
use lennard_observables::ObservableOptions;
use serde::{Deserialize, Serialize, Serializer};

use crate::Name;
use crate::limits::{
    COLDEST, HOTTEST, LARGEST_PRESSURE, LEAST_PRESSURE, LONGEST_SIDE, LONGEST_STEP, SHORTEST_STEP,
};
use crate::tables::as_toml;

/// The table `[integrator]`, in the order of its keys as a scene writes them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IntegratorTable {
    /// The method with its own keys.
    #[serde(flatten)]
    pub method: IntegratorOptions,
    /// Time step in τ.
    pub dt: f64,
    /// Where the pair force is split into a near and a far part, for a method that asks for them.
    #[serde(flatten, serialize_with = "as_keys")]
    pub split: Option<SplitOptions>,
}

/// A table `[[stage]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Its name; every stage has another name.
    pub name: Name,
    /// Number of steps.
    pub steps: u64,
    /// Temperature of its thermostat in ε/k_B, at the end of a ramp; the temperature of the system where none is given.
    pub temperature: f64,
    /// Temperature at the start of a ramp in ε/k_B; `None` for a constant temperature.
    pub temperature_from: Option<f64>,
    /// Its own time step in τ.
    pub dt: Option<f64>,
    /// The heat bath; `None` is constant energy.
    pub thermostat: Option<ThermostatOptions>,
    /// The pressure bath; `None` is constant volume.
    pub barostat: Option<PressureControl>,
    /// The exchange of velocities that drives a flow; `None` for a fluid at rest.
    pub exchange: Option<ExchangeOptions>,
    /// Whether observables look at it.
    pub measure: bool,
}

/// The `barostat` of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureControl {
    /// Pressure in ε/σ³, at the end of a ramp.
    pub pressure: f64,
    /// Pressure at the start of a ramp in ε/σ³; `None` for a constant pressure.
    pub pressure_from: Option<f64>,
    /// The barostat with its own keys.
    pub options: BarostatOptions,
}

impl PressureControl {
    /// "P = 1.2", or "P from 0.5 to 1.2" for a ramp.
    #[must_use]
    pub fn pressure_in_words(&self) -> String {
        in_words("P", self.pressure_from, self.pressure)
    }
}

pub(crate) fn in_words(symbol: &str, from: Option<f64>, to: f64) -> String {
    match from {
        Some(from) => format!("{symbol} from {from} to {to}"),
        None => format!("{symbol} = {to}"),
    }
}

impl Stage {
    /// "T = 1.2", or "T from 2 to 1.2" for a ramp.
    #[must_use]
    pub fn temperature_in_words(&self) -> String {
        in_words("T", self.temperature_from, self.temperature)
    }

    /// The temperature of the bath at each step, for a stage that begins at step `first`.
    #[must_use]
    pub fn temperature_ramp(&self, first: u64) -> Ramp {
        let from = self.temperature_from.unwrap_or(self.temperature);
        Ramp::linear(from, self.temperature, first, self.steps)
    }

    /// The pressure at each step, for a stage that begins at step `first`; `None` without a barostat.
    #[must_use]
    pub fn pressure_ramp(&self, first: u64) -> Option<Ramp> {
        let control = self.barostat.as_ref()?;
        let from = control.pressure_from.unwrap_or(control.pressure);
        Some(Ramp::linear(from, control.pressure, first, self.steps))
    }

    /// Whether temperature or pressure change on the way.
    #[must_use]
    pub fn is_ramp(&self) -> bool {
        let pressure = self.barostat.as_ref().and_then(|b| b.pressure_from);
        self.temperature_from.is_some() || pressure.is_some()
    }
}

/// A table `[[observable]]`, in the order of its keys as a scene writes them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservableTable {
    /// The observable with its own keys.
    #[serde(flatten)]
    pub options: ObservableOptions,
    /// Steps between two samples.
    pub every: u64,
}

lennard_core::options! {
    /// The keys of a ramp of the temperature.
    pub(crate) struct TemperatureRamp {
        /// Temperature at the start of the stage.
        from: Option<f64> = None, else "needed", Between(COLDEST, HOTTEST), in "ε/k_B";
        /// Temperature at its end.
        to: Option<f64> = None, else "needed", Between(COLDEST, HOTTEST), in "ε/k_B";
    }
}

lennard_core::options! {
    /// The keys of a ramp of the pressure.
    pub(crate) struct PressureRamp {
        /// Pressure at the start of the stage.
        from: Option<f64> = None, else "needed", ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), in "ε/σ³";
        /// Pressure at its end.
        to: Option<f64> = None, else "needed", ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), in "ε/σ³";
    }
}

lennard_core::options! {
    /// The keys of a barostat that all kinds have.
    pub(crate) struct BarostatKeys {
        /// Pressure to hold, or a ramp `{ from, to }`.
        pressure: Option<Ramped> = None, else "needed", ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), in "ε/σ³";
    }
}

/// A barostat as a scene writes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct BarostatTable {
    #[serde(flatten)]
    shared: BarostatKeys,
    #[serde(flatten)]
    method: BarostatOptions,
}

impl From<&PressureControl> for BarostatTable {
    fn from(control: &PressureControl) -> Self {
        let ends = Ends { from: control.pressure_from, to: control.pressure };
        Self {
            shared: BarostatKeys { pressure: Some(ends.into()) },
            method: control.options.clone(),
        }
    }
}

/// A number, or a ramp as a table. A reader takes ramps out first, and reads each in its own section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, from = "f64")]
pub(crate) enum Ramped {
    Constant(f64),
    Linear { from: f64, to: f64 },
}

impl Ramped {
    /// The ends of a plain number.
    pub fn constant(&self) -> Option<Ends> {
        match self {
            Self::Constant(to) => Some(Ends { from: None, to: *to }),
            Self::Linear { .. } => None,
        }
    }
}

impl From<f64> for Ramped {
    fn from(number: f64) -> Self {
        Self::Constant(number)
    }
}

impl OptionValue for Ramped {
    fn written(&self) -> String {
        as_toml(self)
    }
}

/// The first and the last value of a quantity; `from` is `None` for a constant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    pub from: Option<f64>,
    pub to: f64,
}

impl From<Ends> for Ramped {
    fn from(ends: Ends) -> Self {
        match ends.from {
            Some(from) => Self::Linear { from, to: ends.to },
            None => Self::Constant(ends.to),
        }
    }
}

impl fmt::Display for Ends {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.from {
            Some(from) => write!(f, "from {from} to {}", self.to),
            None => self.to.fmt(f),
        }
    }
}

impl Stage {
    /// Whether its bath samples the canonical ensemble at a constant temperature.
    pub(crate) fn holds_one_temperature(&self) -> bool {
        let bath = self.thermostat.as_ref().map(|bath| bath.spec());
        bath.is_some_and(|bath| bath.canonical) && self.temperature_from.is_none()
    }
}

/// Where the near force of RESPA ends, σ, unless the scene says otherwise: beyond the first shell of neighbors.
pub const DEFAULT_SPLIT: SplitOptions = SplitOptions { r_split: 1.7, width: 0.4 };

lennard_core::options! {
    /// The keys of `[integrator]` that all methods have.
    pub(crate) struct IntegratorKeys {
        /// Time step.
        dt: f64 = 0.004, Between(SHORTEST_STEP, LONGEST_STEP), in "τ";
    }
}

lennard_core::options! {
    /// The keys of the split force, which multiple time steps bring along.
    pub(crate) struct SplitKeys {
        /// Where the near force ends; below `truncation.r_cut`.
        r_split: f64 = DEFAULT_SPLIT.r_split, Between(1e-6, LONGEST_SIDE), in "σ";
        /// Over which distance it ends; at most `r_split`.
        split_width: f64 = DEFAULT_SPLIT.width, Between(1e-6, LONGEST_SIDE), in "σ";
    }
}

/// Writes the keys of a splitting into the table of its method.
fn as_keys<S: Serializer>(split: &Option<SplitOptions>, to: S) -> Result<S::Ok, S::Error> {
    split.map(|split| SplitKeys { r_split: split.r_split, split_width: split.width }).serialize(to)
}

lennard_core::options! {
    /// The keys of `[[observable]]` that all kinds have.
    pub(crate) struct ObservableKeys {
        /// Steps between two samples.
        every: Option<u64> = None, else "the default of the kind", Whole(1, MOST_STEPS), in "steps";
    }
}

lennard_core::options! {
    /// The keys of `[[stage]]`. Tables among the values are taken out and read one by one.
    pub(crate) struct StageKeys {
        /// Its name, by which `--set stage.NAME.steps=…` finds it.
        name: Option<String> = None, else "needed", Words("at most 200 letters, digits, `-` and `_`, beginning with a letter or digit, not digits alone, and unlike any other stage's");
        /// Number of steps.
        steps: Option<u64> = None, else "needed", Whole(1, MOST_STEPS);
        /// Temperature of the thermostat, or a ramp `{ from, to }`.
        temperature: Option<Ramped> = None, else "`system.temperature`", Between(COLDEST, HOTTEST), in "ε/k_B";
        /// Time step of this stage.
        dt: Option<f64> = None, else "`integrator.dt`", Between(SHORTEST_STEP, LONGEST_STEP), in "τ";
        /// Whether observables and the trajectory look at this stage. Measured stages must be alike in dt, thermostat, barostat and temperature, since their samples are pooled.
        measure: Option<bool> = None, else "`true` for the last stage, else `false`", Flag;
        /// The heat bath; none is constant energy.
        thermostat: Option<Part<ThermostatOptions>> = None, else "`\"none\"`", Words("\"none\", the name of a thermostat, or a table with `kind` and its keys");
        /// The pressure bath; none is constant volume.
        barostat: Option<Part<BarostatTable>> = None, else "`\"none\"`", Words("\"none\", or a table with `kind`, `pressure` and its keys");
        /// An exchange of velocities between two slabs, which drives heat or momentum through the fluid.
        exchange: Option<Part<ExchangeOptions>> = None, else "`\"none\"`", Words("\"none\", \"heat\", \"momentum\", or a table");
    }
}

lennard_core::choices! {
    /// The word for a part that a stage goes without.
    pub(crate) enum Without {
        /// The only one.
        #[default]
        None = "none",
    }
}

/// A part of a stage, such as its thermostat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Part<T> {
    Without(Without),
    With(T),
}

impl<T: Serialize> OptionValue for Part<T> {
    fn written(&self) -> String {
        as_toml(self)
    }
}

/// Every key in its place, except for baths and exchanges that the stage goes without.
impl From<&Stage> for StageKeys {
    fn from(stage: &Stage) -> Self {
        let ends = Ends { from: stage.temperature_from, to: stage.temperature };
        Self {
            name: Some(stage.name.to_string()),
            steps: Some(stage.steps),
            temperature: stage.thermostat.as_ref().map(|_| ends.into()),
            dt: stage.dt,
            measure: Some(stage.measure),
            thermostat: Some(match &stage.thermostat {
                None => Part::Without(Without::None),
                Some(options) => Part::With(options.clone()),
            }),
            barostat: stage.barostat.as_ref().map(|b| Part::With(b.into())),
            exchange: stage.exchange.clone().map(Part::With),
        }
    }
}
