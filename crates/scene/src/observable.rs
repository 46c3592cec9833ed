//! The tables `[[observable]]`: what is measured.

use lennard_observables::ObservableOptions;

use crate::error::SceneError;
use crate::read::Reader;
use crate::reference::MOST_STEPS;
use crate::section::Section;
use crate::{ObservableTable, Output};

lennard_core::options! {
    /// The keys of `[[observable]]` that all kinds have.
    pub(crate) struct ObservableKeys {
        /// Steps between two samples.
        every: Option<u64> = None, else "the default of the kind", Whole(1, MOST_STEPS), in "steps";
    }
}

impl From<&ObservableTable> for ObservableKeys {
    fn from(table: &ObservableTable) -> Self {
        Self { every: Some(table.every) }
    }
}

impl Reader<'_> {
    pub fn observables(&self) -> Result<Vec<ObservableTable>, SceneError> {
        let mut observables: Vec<ObservableTable> = Vec::new();
        for (i, table) in self.list("observable")?.into_iter().enumerate() {
            let path = format!("observable.{i}");
            let section = Section::new(self.source, &path, "observable");
            let mut table = table.clone();
            let ObservableKeys { every } = section.take(&mut table)?;
            let options: ObservableOptions = section.method(&table)?;
            let every = every.unwrap_or(options.default_every());
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
                .source
                .refuse(&key, "differs from `output.thermo_every`")
                .found(format!("{} and {}", observables[i].every, output.thermo_every))
                .allowed("the same number, or one of them left out"));
        }
        Ok(())
    }
}
