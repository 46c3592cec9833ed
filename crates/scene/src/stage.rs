//! The tables `[[stage]]`: what happens one after the other.

use lennard_core::options::OptionValue;
use lennard_integrators::{ExchangeOptions, ThermostatOptions};
use serde::{Deserialize, Serialize};

use crate::baths::{BarostatTable, Ends, Ramped, TemperatureRamp};
use crate::error::SceneError;
use crate::methods;
use crate::read::Reader;
use crate::reference::{COLDEST, HOTTEST, LONGEST_STEP, MOST_STEPS, SHORTEST_STEP, as_toml};
use crate::tags::{take, with_tag};
use crate::tree::{Node, Value};
use crate::typed::Section;
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
        let nodes = self.list("stage")?;
        if nodes.is_empty() {
            return Err(self
                .source
                .refuse("stage", "is missing")
                .found("no stage")
                .allowed("at least one `[[stage]]` with `name` and `steps`"));
        }
        let mut stages = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            let path = format!("stage.{i}");
            let last = i + 1 == nodes.len();
            stages.push(self.stage(&path, node, temperature, last)?);
        }
        Ok(stages)
    }

    fn stage(
        &self,
        path: &str,
        node: &Node,
        temperature: f64,
        last: bool,
    ) -> Result<Stage, SceneError> {
        let section = Section::new(self.source, path, "stage");
        let mut node = node.clone();
        let thermostat = take(&mut node, "thermostat");
        let barostat = take(&mut node, "barostat");
        let exchange = take(&mut node, "exchange");
        let ramp = self.take_ramp::<TemperatureRamp>(
            &mut node,
            "temperature",
            &section,
            "stage.temperature",
        )?;
        let keys: StageKeys = section.read(&node)?;
        let written = section.needed(&node, "name", keys.name)?;
        let steps = section.needed(&node, "steps", keys.steps)?;
        // Overrides find a stage by its name, between dots, or by its number.
        let finds = |name: &Name| !name.contains('.') && !name.chars().all(|c| c.is_ascii_digit());
        let Some(name) = Name::new(written).filter(finds) else {
            let written = node.table().and_then(|t| t.get("name"));
            let written = written.unwrap_or(&self.empty);
            return Err(self.refuse_value("stage", "name", &section.name("name"), written));
        };
        let thermostat = match &thermostat {
            Some(entry) => self.thermostat(path, &entry.node)?,
            None => None,
        };
        let barostat = match &barostat {
            Some(entry) => self.barostat(path, &entry.node)?,
            None => None,
        };
        let exchange = match &exchange {
            Some(entry) => self.exchange(path, &entry.node)?,
            None => None,
        };
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
        node: &Node,
    ) -> Result<Option<ThermostatOptions>, SceneError> {
        let path = format!("{stage}.thermostat");
        let section = Section::new(self.source, &path, "stage.thermostat");
        let names = methods::names::<ThermostatOptions>();
        let named = self.part(stage, "thermostat", &names, node)?;
        named.map(|node| section.method(&node)).transpose()
    }

    /// The table of a part of a stage; `None` for "none". One of `names` alone stands for a table with this `kind`.
    pub fn part(
        &self,
        stage: &str,
        key: &str,
        names: &[&str],
        node: &Node,
    ) -> Result<Option<Node>, SceneError> {
        let section = Section::new(self.source, stage, "stage");
        match &node.value {
            Value::Table(_) => Ok(Some(node.clone())),
            Value::Text(name) if name == Without::None.name() => Ok(None),
            Value::Text(name) if names.contains(&name.as_str()) => {
                Ok(Some(with_tag(&self.empty, "kind", name)))
            }
            Value::Text(name) => {
                let known = [&Without::names(), names].concat();
                Err(section.unknown_name(key, name, &known))
            }
            _ => Err(self.refuse_value("stage", key, &section.name(key), node)),
        }
    }
}
