//! The barostat of a stage, and quantities that change along a ramp.

use std::fmt;

use lennard_core::options::{OptionValue, Options};
use lennard_integrators::BarostatOptions;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::PressureControl;
use crate::error::SceneError;
use crate::methods;
use crate::read::Reader;
use crate::reference::{COLDEST, HOTTEST, LARGEST_PRESSURE, LEAST_PRESSURE, as_toml};
use crate::section::Section;

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
        pressure: Option<Ramped<PressureRamp>> = None, else "needed", ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), in "ε/σ³";
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

/// A quantity that changes linearly with the steps of a stage.
pub(crate) trait RampKeys: Options + DeserializeOwned {
    fn between(from: f64, to: f64) -> Self;
    fn ends(&self) -> [Option<f64>; 2];
}

macro_rules! ramps {
    ($($ramp:ident)*) => {$(
        impl RampKeys for $ramp {
            fn between(from: f64, to: f64) -> Self {
                Self { from: Some(from), to: Some(to) }
            }
            fn ends(&self) -> [Option<f64>; 2] {
                [self.from, self.to]
            }
        }
    )*};
}

ramps! { TemperatureRamp PressureRamp }

/// A number, or a ramp as a table. A reader takes ramps out first, and reads each in its own section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, from = "f64")]
pub(crate) enum Ramped<R> {
    Constant(f64),
    Linear(R),
}

impl<R> Ramped<R> {
    /// The ends of a plain number.
    pub fn constant(&self) -> Option<Ends> {
        match self {
            Self::Constant(to) => Some(Ends { from: None, to: *to }),
            Self::Linear(_) => None,
        }
    }
}

impl<R> From<f64> for Ramped<R> {
    fn from(number: f64) -> Self {
        Self::Constant(number)
    }
}

impl<R: Serialize> OptionValue for Ramped<R> {
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

impl<R: RampKeys> From<Ends> for Ramped<R> {
    fn from(ends: Ends) -> Self {
        match ends.from {
            Some(from) => Self::Linear(R::between(from, ends.to)),
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

impl Reader<'_> {
    /// Takes a key whose value is a table `{ from, to }`; a plain number stays where it is.
    pub fn take_ramp<R: RampKeys>(
        &self,
        table: &mut Table,
        key: &str,
        section: &Section<'_>,
        of_ramp: &'static str,
    ) -> Result<Option<Ends>, SceneError> {
        let Some(Value::Table(ramp)) = table.get(key).cloned() else {
            return Ok(None);
        };
        table.remove(key);
        let path = section.name(key);
        let section = Section::new(self.source, &path, of_ramp);
        let [from, to] = section.read::<R>(&ramp)?.ends();
        Ok(Some(Ends {
            from: Some(section.needed(&ramp, "from", from)?),
            to: section.needed(&ramp, "to", to)?,
        }))
    }

    /// The barostat of a stage: "none", or a table with `kind`, `pressure` and the keys of its kind.
    pub fn barostat(
        &self,
        stage: &str,
        written: &Value,
    ) -> Result<Option<PressureControl>, SceneError> {
        const RAMP: &str = "stage.barostat.pressure";
        let path = format!("{stage}.barostat");
        let section = Section::new(self.source, &path, "stage.barostat");
        let names = methods::names::<BarostatOptions>();
        if let Some(name) = written.as_str().filter(|name| names.contains(name)) {
            return Err(self
                .source
                .refuse(&section.name("pressure"), "is missing")
                .found(format!("barostat = {name:?}"))
                .allowed(format!("{{ kind = {name:?}, pressure = … }}")));
        }
        let Some(mut table) = self.part(stage, "barostat", &names, written)? else {
            return Ok(None);
        };
        let ramp = self.take_ramp::<PressureRamp>(&mut table, "pressure", &section, RAMP)?;
        let keys: BarostatKeys = section.take(&mut table)?;
        let options: BarostatOptions = section.method(&table)?;
        let Some(pressure) = ramp.or(keys.pressure.and_then(|p| p.constant())) else {
            return Err(self
                .source
                .refuse(&section.name("pressure"), "is missing")
                .found(format!("kind = {:?} without a pressure", options.name()))
                .allowed("the pressure to hold in ε/σ³, or { from, to }"));
        };
        Ok(Some(PressureControl { pressure: pressure.to, pressure_from: pressure.from, options }))
    }
}
