//! Whether parts of a program go with the stages and the observables of its scene.

use crate::{EngineError, Simulation};

impl Simulation {
    /// Refuses baths and barostats that take the place of a method of the program.
    pub(crate) fn keeps_own_method(&self) -> Result<(), EngineError> {
        let Some(own) = self.own.method_name() else {
            return Ok(());
        };
        for (index, stage) in self.scene.stages.iter().enumerate() {
            let there = self.stage_run_for(index).integrator.spec().name;
            if there != own {
                let key = match stage.barostat {
                    Some(_) => "barostat",
                    None => "thermostat",
                };
                let found = format!("`{there}`, which steps in the place of `{own}`");
                let allowed = "none, or a bath that acts between steps, such as `bussi`";
                let key = format!("stage.{index}.{key}");
                return Err(self.scene.source.invalid(&key, found, allowed).into());
            }
        }
        Ok(())
    }

    /// Refuses an observable of the program that has the name of another.
    pub(crate) fn tells_observables_apart(&self) -> Result<(), EngineError> {
        let names: Vec<&str> = self.observers.iter().map(|o| o.observable.spec().name).collect();
        for name in self.own.observable_names() {
            if names.iter().filter(|n| **n == name).count() > 1 {
                let allowed = "a name that no other observable of the run has";
                let source = &self.scene.source;
                return Err(source
                    .invalid("program.observables", format!("`{name}`"), allowed)
                    .into());
            }
        }
        Ok(())
    }
}
