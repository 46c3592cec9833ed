//! The tables `[[stage]]`: what happens one after the other.

use lennard_core::options::OptionValue;
use lennard_integrators::{ExchangeOptions, ThermostatOptions};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::baths::{BarostatTable, Ends, Ramped, TemperatureRamp};
use crate::error::SceneError;
use crate::methods;
use crate::read::Reader;
use crate::reference::{COLDEST, HOTTEST, LONGEST_STEP, MOST_STEPS, SHORTEST_STEP, as_toml};
use crate::section::Section;
use crate::{Name, Stage};

lennard_core::options! {
    /// The keys of `[[stage]]`. Tables among the values are taken out and read one by one.
    pub(crate) struct StageKeys {
        /// Its name, by which `--set stage.NAME.steps=…` finds it.
        name: Option<String> = None, else "needed", Words("at most 200 letters, digits, `-` and `_`, beginning with a letter or digit, not digits alone, and unlike any other stage's");
        /// Number of steps.
        steps: Option<u64> = None, else "needed", Whole(1, MOST_STEPS);
        /// Temperature of the thermostat, or a ramp `{ from, to }`.
        temperature: Option<Ramped<TemperatureRamp>> = None, else "`system.temperature`", Between(COLDEST, HOTTEST), in "ε/k_B";
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

impl Reader<'_> {
    pub fn stages(&self, temperature: f64) -> Result<Vec<Stage>, SceneError> {
        let tables = self.list("stage")?;
        if tables.is_empty() {
            return Err(self
                .source
                .refuse("stage", "is missing")
                .found("no stage")
                .allowed("at least one `[[stage]]` with `name` and `steps`"));
        }
        let last = tables.len() - 1;
        let all = tables.into_iter().enumerate();
        all.map(|(i, table)| self.stage(&format!("stage.{i}"), table, temperature, i == last))
            .collect()
    }

    fn stage(
        &self,
        path: &str,
        table: &Table,
        temperature: f64,
        last: bool,
    ) -> Result<Stage, SceneError> {
        let section = Section::new(self.source, path, "stage");
        let mut table = table.clone();
        let [thermostat, barostat, exchange] =
            ["thermostat", "barostat", "exchange"].map(|part| table.remove(part));
        let ramp = self.take_ramp::<TemperatureRamp>(
            &mut table,
            "temperature",
            &section,
            "stage.temperature",
        )?;
        let keys: StageKeys = section.read(&table)?;
        let written = section.needed(&table, "name", keys.name)?;
        let steps = section.needed(&table, "steps", keys.steps)?;
        // Overrides find a stage by its name, between dots, or by its number.
        let finds = |name: &Name| !name.contains('.') && !name.chars().all(|c| c.is_ascii_digit());
        let Some(name) = Name::new(&*written).filter(finds) else {
            return Err(section.not_allowed("name", &written.into()));
        };
        let thermostat = thermostat.map(|written| self.thermostat(path, &written));
        let thermostat = thermostat.transpose()?.flatten();
        let barostat = barostat.map(|written| self.barostat(path, &written)).transpose()?.flatten();
        let exchange = exchange.map(|written| self.exchange(path, &written)).transpose()?.flatten();
        let ends = ramp.or(keys.temperature.and_then(|t| t.constant()));
        if let (None, Some(ends)) = (&thermostat, ends) {
            return Err(self
                .source
                .refuse(&section.name("temperature"), "has nothing to act on")
                .found(ends)
                .allowed("a thermostat beside it; a stage without one runs at constant energy"));
        }
        Ok(Stage {
            name,
            steps,
            temperature: ends.map_or(temperature, |ends| ends.to),
            temperature_from: ends.and_then(|ends| ends.from),
            dt: keys.dt,
            thermostat,
            barostat,
            exchange,
            measure: keys.measure.unwrap_or(last),
        })
    }

    fn thermostat(
        &self,
        stage: &str,
        written: &Value,
    ) -> Result<Option<ThermostatOptions>, SceneError> {
        let path = format!("{stage}.thermostat");
        let section = Section::new(self.source, &path, "stage.thermostat");
        let names = methods::names::<ThermostatOptions>();
        let named = self.part(stage, "thermostat", &names, written)?;
        named.map(|table| section.method(&table)).transpose()
    }

    /// The table of a part of a stage; `None` for "none". One of `names` alone stands for a table with this `kind`.
    pub fn part(
        &self,
        stage: &str,
        key: &str,
        names: &[&str],
        written: &Value,
    ) -> Result<Option<Table>, SceneError> {
        let section = Section::new(self.source, stage, "stage");
        match written {
            Value::Table(table) => Ok(Some(table.clone())),
            Value::String(name) if name == Without::None.name() => Ok(None),
            Value::String(name) if names.contains(&name.as_str()) => {
                Ok(Some(Table::from_iter([("kind".to_owned(), name.as_str().into())])))
            }
            Value::String(name) => {
                let known = [&Without::names(), names].concat();
                Err(section.unknown_name(key, name, &known))
            }
            _ => Err(section.not_allowed(key, written)),
        }
    }
}
