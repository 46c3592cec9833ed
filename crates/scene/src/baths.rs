//! The barostat of a stage, and quantities that change along a ramp.

use lennard_integrators::BarostatOptions;
use serde::Deserialize;

use crate::PressureControl;
use crate::error::SceneError;
use crate::read::Reader;
use crate::tags::take;
use crate::tree::{Node, Value};
use crate::typed::Section;

/// A quantity that changes linearly with the steps of a stage.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RampTable {
    from: f64,
    to: f64,
}

impl Reader<'_> {
    /// Takes a key whose value is a table `{ from, to }`; a plain number stays where it is.
    pub fn take_ramp(
        &self,
        node: &mut Node,
        key: &str,
        section: &Section<'_>,
        table: &'static str,
    ) -> Result<Option<[f64; 2]>, SceneError> {
        let written = node.table().and_then(|t| t.get(key)?.table());
        if written.is_none() {
            return Ok(None);
        }
        let Some(entry) = take(node, key) else {
            return Ok(None);
        };
        let path = section.name(key);
        let ramp: RampTable = Section::new(self.source, &path, table).read(&entry.node)?;
        Ok(Some([ramp.from, ramp.to]))
    }

    /// The barostat of a stage: "none", or a table with `kind`, `pressure` and the keys of its kind.
    pub fn barostat(
        &self,
        stage: &str,
        node: &Node,
    ) -> Result<Option<PressureControl>, SceneError> {
        let path = format!("{stage}.barostat");
        let section =
            Section::new(self.source, &path, "stage.barostat").with(&["kind", "pressure"]);
        let mut names: Vec<&str> = vec!["none"];
        names.extend(lennard_integrators::barostats().iter().map(|b| b.name));
        match &node.value {
            Value::Table(_) => {}
            Value::Text(name) if name == "none" => return Ok(None),
            Value::Text(name) if names.contains(&name.as_str()) => {
                return Err(self
                    .source
                    .refuse(&section.name("pressure"), "is missing")
                    .found(format!("barostat = {name:?}"))
                    .allowed(format!("{{ kind = {name:?}, pressure = … }}")));
            }
            Value::Text(name) => {
                let stage = Section::new(self.source, stage, "stage");
                return Err(stage.unknown_name("barostat", name, &names));
            }
            _ => return Err(self.refuse_value("stage", "barostat", &path, node)),
        }
        let mut node = node.clone();
        let ramp = self.take_ramp(&mut node, "pressure", &section, "stage.barostat.pressure")?;
        let entry = take(&mut node, "pressure");
        let options: BarostatOptions = section.read(&node)?;
        options
            .check()
            .map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        let [from, pressure] = match (ramp, entry) {
            (Some([from, to]), _) => [Some(from), Some(to)],
            (None, Some(entry)) => [None, Some(section.number(&entry, None)?)],
            (None, None) => [None, None],
        };
        let Some(pressure) = pressure else {
            return Err(self
                .source
                .refuse(&section.name("pressure"), "is missing")
                .found(format!("kind = {:?} without a pressure", options.name()))
                .allowed("the pressure to hold in ε/σ³, or { from, to }"));
        };
        Ok(Some(PressureControl {
            pressure,
            pressure_from: from,
            options,
        }))
    }
}
