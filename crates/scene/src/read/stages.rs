//! Reads the tables `[integrator]`, `[[stage]]` and `[[observable]]`.

use lennard_core::options::Options;
use lennard_core::options::quoted;
use lennard_forcefield::SplitOptions;
use lennard_integrators::{
    BarostatOptions, ExchangeOptions, Exchanged, IntegratorEntry, IntegratorOptions,
    OscillatorModel, ThermostatOptions, respa,
};
use lennard_observables::ObservableOptions;
use serde::Deserialize;
use toml::{Table, Value};

use crate::methods;
use crate::read::Reader;
use crate::section::Section;
use crate::tables::stages::{
    BarostatKeys, Ends, IntegratorKeys, ObservableKeys, SplitKeys, StageKeys, Without,
};
use crate::{IntegratorTable, Name, ObservableTable, Output, PressureControl, SceneError, Stage};

/// A ramp as it is written; the reference knows the ranges of each.
#[derive(Deserialize)]
struct Written {
    from: Option<f64>,
    to: Option<f64>,
}

impl Reader<'_> {
    /// Takes a key whose value is a table `{ from, to }`; a plain number stays where it is.
    pub fn ramp(
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
        let Written { from, to } = section.read(&ramp)?;
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
                .refuse(&section.name("pressure"), "is missing")
                .found(format!("barostat = {name:?}"))
                .allowed(format!("{{ kind = {name:?}, pressure = … }}")));
        }
        let Some(mut table) = self.part(stage, "barostat", &names, written)? else {
            return Ok(None);
        };
        let ramp = self.ramp(&mut table, "pressure", &section, RAMP)?;
        let keys: BarostatKeys = section.shared(&mut table)?;
        let options: BarostatOptions = section.method(&table)?;
        let Some(pressure) = ramp.or(keys.pressure.and_then(|p| p.constant())) else {
            return Err(self
                .refuse(&section.name("pressure"), "is missing")
                .found(format!("kind = {:?} without a pressure", options.name()))
                .allowed("the pressure to hold in ε/σ³, or { from, to }"));
        };
        Ok(Some(PressureControl { pressure: pressure.to, pressure_from: pressure.from, options }))
    }

    /// The exchange of a stage: "none", a name, or a table.
    pub fn exchange(
        &self,
        stage: &str,
        written: &Value,
    ) -> Result<Option<ExchangeOptions>, SceneError> {
        let path = format!("{stage}.exchange");
        let section = Section::new(self.source, &path, "stage.exchange");
        let Some(named) = self.part(stage, "exchange", &Exchanged::names(), written)? else {
            return Ok(None);
        };
        let options: ExchangeOptions = section.read(&named)?;
        options.check().map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        if !options.slabs.is_multiple_of(2) {
            return Err(section.impossible("slabs", &options.slabs.to_string(), "an even number"));
        }
        Ok(Some(options))
    }

    pub fn integrator(&self) -> Result<IntegratorTable, SceneError> {
        let section = self.section("integrator");
        let mut table = self.table("integrator").clone();
        let IntegratorKeys { dt } = section.shared(&mut table)?;
        let kind = table.get("kind").and_then(Value::as_str);
        let split = match kind == Some(respa::SPEC.name) {
            false => None,
            true => {
                let keys: SplitKeys = section.shared(&mut table)?;
                Some(SplitOptions { r_split: keys.r_split, width: keys.split_width })
            }
        };
        let method = section.method(&table)?;
        self.suits_a_fluid(&method)?;
        Ok(IntegratorTable { dt, method, split })
    }

    /// Refuses methods that move nothing by pair forces.
    fn suits_a_fluid(&self, method: &IntegratorOptions) -> Result<(), SceneError> {
        let moves_fluids = |entry: &&IntegratorEntry| entry.oscillator == OscillatorModel::Force;
        let fit = lennard_integrators::integrators().iter().filter(moves_fluids);
        let names: Vec<&str> = fit.map(|entry| entry.spec.name).collect();
        // Bonds and contacts give SPOOK something to solve for; they are checked with it later.
        let solves = self.source.wrote("molecule") || self.source.wrote("contact");
        let by_spook = solves && method.name() == lennard_integrators::spook::SPEC.name;
        if by_spook || names.contains(&method.name()) {
            return Ok(());
        }
        Err(self
            .refuse(
                "integrator.kind",
                match method.name() == lennard_integrators::spook::SPEC.name {
                    true => "has nothing to solve for without `[molecule]` or `[contact]`",
                    false => "cannot move a fluid: it works on the oscillator alone",
                },
            )
            .found(format!("{:?}", method.name()))
            .allowed(quoted(&names)))
    }

    pub fn observables(&self) -> Result<Vec<ObservableTable>, SceneError> {
        let mut observables: Vec<ObservableTable> = Vec::new();
        for (i, table) in self.list("observable")?.into_iter().enumerate() {
            let path = format!("observable.{i}");
            let section = Section::new(self.source, &path, "observable");
            let mut table = table.clone();
            let ObservableKeys { every } = section.shared(&mut table)?;
            let options: ObservableOptions = section.method(&table)?;
            let every = every.unwrap_or(options.spec().every);
            let twin = observables.iter().position(|other| other.options.name() == options.name());
            if let Some(first) = twin {
                let first = format!("observable.{first}.kind");
                return Err(self.source.twice(&section.name("kind"), options.name(), &first));
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
                .refuse(&key, "differs from `output.thermo_every`")
                .found(format!("{} and {}", observables[i].every, output.thermo_every))
                .allowed("the same number, or one of them left out"));
        }
        Ok(())
    }

    pub fn stages(&self, temperature: f64) -> Result<Vec<Stage>, SceneError> {
        let tables = self.list("stage")?;
        let count = tables.len();
        let all = tables.into_iter().enumerate();
        all.map(|(i, table)| self.stage(&format!("stage.{i}"), table, temperature, i + 1 == count))
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
        let ramp = self.ramp(&mut table, "temperature", &section, "stage.temperature")?;
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
