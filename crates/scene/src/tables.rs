//! The tables after `[system]`: integrator, stages, observables, output, checkpoints.

use lennard_forcefield::SplitOptions;
use lennard_integrators::{IntegratorEntry, IntegratorOptions, OscillatorModel, ThermostatOptions};
use lennard_io::{FormatSpec, TrajectoryFormat};
use lennard_observables::ObservableOptions;
use serde::Deserialize;

use crate::error::SceneError;
use crate::read::Reader;
use crate::reference::quoted;
use crate::tags::{take, with_kind};
use crate::tree::{Node, Value};
use crate::typed::Section;
use crate::{Checkpoint, IntegratorTable, ObservableTable, Output, Stage};

/// The customary time step of Lennard-Jones fluids, τ.
const DEFAULT_DT: f64 = 0.004;
/// Where the near force of RESPA ends, σ, unless the scene says otherwise: beyond the first shell of neighbors.
pub const DEFAULT_SPLIT: SplitOptions = SplitOptions {
    r_split: 1.7,
    width: 0.4,
};
const DEFAULT_THERMO_EVERY: u64 = 10;
/// Wall-clock seconds between two checkpoints where the scene does not say. A killed run loses ten minutes at
/// most, a short run writes no checkpoint on its way, and a long run pays far below 1 %.
const DEFAULT_CHECKPOINT_SECONDS: f64 = 600.0;
const DEFAULT_ELEMENT: &str = "Ar";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StageTable {
    name: String,
    steps: u64,
    temperature: Option<f64>,
    dt: Option<f64>,
    measure: Option<bool>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OutputTable {
    trajectory_every: Option<u64>,
    format: Option<TrajectoryFormat>,
    precision: Option<f64>,
    ase: Option<bool>,
    thermo_every: Option<u64>,
    element: Option<String>,
    velocities: Option<bool>,
    forces: Option<bool>,
    unwrapped: Option<bool>,
    length_scale: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CheckpointTable {
    every_steps: Option<u64>,
    every_seconds: Option<f64>,
}

impl Reader<'_> {
    pub fn integrator(&self) -> Result<IntegratorTable, SceneError> {
        let default_kind = IntegratorOptions::default().name();
        let mut node = with_kind(self.node("integrator"), default_kind);
        let is_split = node.table().and_then(|t| t.get("kind")?.text()) == Some("respa");
        let section = self.section("integrator").with(match is_split {
            true => &["kind", "dt", "r_split", "split_width"],
            false => &["kind", "dt"],
        });
        let dt = take(&mut node, "dt");
        let dt = dt.map_or(Ok(DEFAULT_DT), |entry| section.number(&entry, None))?;
        let mut split = None;
        if is_split {
            let mut length = |key: &str, default| match take(&mut node, key) {
                Some(entry) => section.number(&entry, Some("respa")),
                None => Ok(default),
            };
            split = Some(SplitOptions {
                r_split: length("r_split", DEFAULT_SPLIT.r_split)?,
                width: length("split_width", DEFAULT_SPLIT.width)?,
            });
        }
        let method: IntegratorOptions = section.read(&node)?;
        method
            .check()
            .map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        self.suits_a_fluid(&method)?;
        Ok(IntegratorTable { dt, method, split })
    }

    /// Refuses methods that move nothing by pair forces.
    fn suits_a_fluid(&self, method: &IntegratorOptions) -> Result<(), SceneError> {
        let moves_fluids = |entry: &&IntegratorEntry| entry.oscillator == OscillatorModel::Force;
        let fit = lennard_integrators::integrators()
            .iter()
            .filter(moves_fluids);
        let names: Vec<&str> = fit.map(|entry| entry.spec.name).collect();
        // The bonds of molecules give SPOOK something to solve for; they are checked with it later.
        let has_molecules = self.source.wrote("molecule");
        let by_spook = has_molecules && method.name() == lennard_integrators::spook::SPEC.name;
        if by_spook || names.contains(&method.name()) {
            return Ok(());
        }
        Err(self
            .source
            .refuse(
                "integrator.kind",
                "cannot move a fluid: it works on the oscillator alone",
            )
            .found(format!("{:?}", method.name()))
            .allowed(quoted(&names)))
    }

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
        let section =
            Section::new(self.source, path, "stage").with(&["thermostat", "barostat", "exchange"]);
        let mut node = node.clone();
        let thermostat = take(&mut node, "thermostat");
        let barostat = take(&mut node, "barostat");
        let exchange = take(&mut node, "exchange");
        let ramp = self.take_ramp(&mut node, "temperature", &section, "stage.temperature")?;
        let table: StageTable = section.read(&node)?;
        let good_name = |name: &str| {
            name.chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
                && name.chars().any(|c| !c.is_ascii_digit())
        };
        if !good_name(&table.name) {
            let written = node.table().and_then(|t| t.get("name"));
            let written = written.unwrap_or(&self.empty);
            return Err(self.refuse_value("stage", "name", &section.name("name"), written));
        }
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
        let written = ramp.map(|[from, to]| format!("from {from} to {to}"));
        let written = written.or(table.temperature.map(|t| t.to_string()));
        if let (None, Some(written)) = (&thermostat, written) {
            return Err(self
                .source
                .refuse(&section.name("temperature"), "has nothing to act on")
                .found(written)
                .allowed("a thermostat beside it; a stage without one runs at constant energy"));
        }
        Ok(Stage {
            name: table.name,
            steps: table.steps,
            temperature: match ramp {
                Some([_, to]) => to,
                None => table.temperature.unwrap_or(temperature),
            },
            temperature_from: ramp.map(|[from, _]| from),
            dt: table.dt,
            thermostat,
            barostat,
            exchange,
            measure: table.measure.unwrap_or(last),
        })
    }

    fn thermostat(
        &self,
        stage: &str,
        node: &Node,
    ) -> Result<Option<ThermostatOptions>, SceneError> {
        let path = format!("{stage}.thermostat");
        let section = Section::new(self.source, &path, "stage.thermostat").with(&["kind"]);
        let mut names: Vec<&str> = vec!["none"];
        names.extend(lennard_integrators::thermostats().iter().map(|t| t.name));
        let named = match &node.value {
            Value::Table(_) => node.clone(),
            Value::Text(name) if name == "none" => return Ok(None),
            Value::Text(name) if names.contains(&name.as_str()) => with_kind(&self.empty, name),
            Value::Text(name) => {
                let stage = Section::new(self.source, stage, "stage");
                return Err(stage.unknown_name("thermostat", name, &names));
            }
            _ => return Err(self.refuse_value("stage", "thermostat", &path, node)),
        };
        let options: ThermostatOptions = section.read(&named)?;
        options
            .check()
            .map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        Ok(Some(options))
    }

    pub fn observables(&self) -> Result<Vec<ObservableTable>, SceneError> {
        let mut observables: Vec<ObservableTable> = Vec::new();
        for (i, node) in self.list("observable")?.iter().enumerate() {
            let path = format!("observable.{i}");
            let section = Section::new(self.source, &path, "observable").with(&["kind", "every"]);
            let mut node = node.clone();
            let every = take(&mut node, "every");
            let options: ObservableOptions = section.read(&node)?;
            let every = match &every {
                Some(entry) => section.count(entry)?,
                None => options.default_every(),
            };
            let twin = observables
                .iter()
                .position(|other| other.options.name() == options.name());
            if let Some(first) = twin {
                let first = format!("observable.{first}.kind");
                return Err(self
                    .source
                    .twice(&section.name("kind"), options.name(), &first));
            }
            observables.push(ObservableTable { every, options });
        }
        Ok(observables)
    }

    /// Thermodynamics is sampled every `output.thermo_every` steps; naming it as an observable with an
    /// `every` of its own says the same thing in another place.
    pub fn one_thermo_interval(
        &self,
        observables: &mut [ObservableTable],
        output: &mut Output,
    ) -> Result<(), SceneError> {
        let thermodynamics =
            |table: &ObservableTable| matches!(table.options, ObservableOptions::Thermodynamics(_));
        let Some(i) = observables.iter().position(thermodynamics) else {
            return Ok(());
        };
        let key = format!("observable.{i}.every");
        if !self.source.wrote(&key) {
            observables[i].every = output.thermo_every;
        } else if !self.source.wrote("output.thermo_every") {
            output.thermo_every = observables[i].every;
        } else if observables[i].every != output.thermo_every {
            return Err(self
                .source
                .refuse(&key, "differs from `output.thermo_every`")
                .found(format!(
                    "{} and {}",
                    observables[i].every, output.thermo_every
                ))
                .allowed("the same number, or one of them left out"));
        }
        Ok(())
    }

    pub fn output(&self) -> Result<Output, SceneError> {
        let node = self.node("output");
        let table: OutputTable = self.section("output").read(node)?;
        let element = table.element.unwrap_or_else(|| DEFAULT_ELEMENT.to_owned());
        if !lennard_io::is_element_symbol(&element) {
            let written = node.table().and_then(|t| t.get("element"));
            let written = written.unwrap_or(&self.empty);
            return Err(self.refuse_value("output", "element", "output.element", written));
        }
        let format = table.format.unwrap_or_default();
        let spec = format.spec();
        let output = Output {
            trajectory_every: table.trajectory_every.filter(|every| *every > 0),
            format,
            precision: table.precision.unwrap_or(lennard_io::DEFAULT_PRECISION),
            ase: table.ase.unwrap_or(false),
            thermo_every: table.thermo_every.unwrap_or(DEFAULT_THERMO_EVERY),
            element,
            velocities: table.velocities.unwrap_or(spec.holds_vectors),
            forces: table.forces.unwrap_or(false),
            unwrapped: table.unwrapped.unwrap_or(false),
            length_scale: table.length_scale.unwrap_or(1.0),
        };
        self.fits_format(&output, table.precision.is_some())?;
        Ok(output)
    }

    /// Refuses keys that the format of the trajectory has no place for.
    fn fits_format(&self, output: &Output, has_precision: bool) -> Result<(), SceneError> {
        let spec = output.format.spec();
        let name = output.format.name();
        let refuse = |key: &str, found: String, allowed: &str| {
            let key = format!("output.{key}");
            let error = self.source.refuse(&key, "does not go with the format");
            Err(error
                .found(format!("{found}, with format {name:?}"))
                .allowed(allowed))
        };
        let fitting = |fits: fn(&FormatSpec) -> bool| {
            let all = TrajectoryFormat::ALL.iter().filter(|f| fits(f.spec()));
            quoted(&all.map(|f| f.name()).collect::<Vec<_>>())
        };
        for (key, there) in [("velocities", output.velocities), ("forces", output.forces)] {
            if there && !spec.holds_vectors {
                let formats = fitting(|spec| spec.holds_vectors);
                return refuse(
                    key,
                    "true".into(),
                    &format!("false, or a format of {formats}"),
                );
            }
        }
        if has_precision && spec.limits.is_none() {
            let found = output.precision.to_string();
            let formats = fitting(|spec| spec.limits.is_some());
            return refuse(
                "precision",
                found,
                &format!("the format {formats}, or no such key"),
            );
        }
        if output.ase && !spec.holds_ase {
            let formats = fitting(|spec| spec.holds_ase);
            return refuse(
                "ase",
                "true".into(),
                &format!("false, or a format of {formats}"),
            );
        }
        if output.length_scale != 1.0 && !spec.names_scale {
            let found = output.length_scale.to_string();
            let formats = fitting(|spec| spec.names_scale);
            return refuse(
                "length_scale",
                found,
                &format!("1, or a format of {formats}"),
            );
        }
        if output.ase && output.length_scale != 1.0 {
            let found = format!("true, with length_scale = {}", output.length_scale);
            return refuse("ase", found, "`length_scale = 1`: energies are in ε");
        }
        Ok(())
    }

    pub fn checkpoint(&self) -> Result<Checkpoint, SceneError> {
        let table: CheckpointTable = self.plain("checkpoint")?;
        Ok(Checkpoint {
            every_steps: table.every_steps.filter(|every| *every > 0),
            every_seconds: Some(table.every_seconds.unwrap_or(DEFAULT_CHECKPOINT_SECONDS))
                .filter(|every| *every > 0.0),
        })
    }
}
