//! A simulation as a checkpoint keeps it.

use lennard_core::{PeriodicBox, Persist, RestoreError, StateReader, StateWriter};

use crate::Simulation;
use crate::schedule::Observer;

impl Persist for Simulation {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.state.save(&mut to.section("state"));
        if self.state.cell != self.start_cell {
            to.put_vec3("box", &[self.state.cell.lengths()]);
        }
        self.forces.save(&mut to.section("forces"));
        let mut observables = to.section("observables");
        for Observer { observable, .. } in &self.observers {
            observable.save(&mut observables.section(observable.spec().name));
        }
        self.force_check.save(&mut to.section("force_check"));
        to.put_u64("measured_steps", &[self.measured_steps]);
        if let Some(stage) = &self.stage {
            to.put_u64("stage", &[stage.index as u64, stage.steps_done]);
            to.put_f64("stage_energy", &[stage.heat, stage.start_energy]);
            stage.integrator.save(&mut to.section("method"));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.state.restore(&from.section("state"))?;
        self.state.cell = saved_box(from)?.unwrap_or(self.start_cell);
        self.forces.restore(&from.section("forces"))?;
        let observables = from.section("observables");
        for Observer { observable, .. } in &mut self.observers {
            let name = observable.spec().name;
            observable.restore(&observables.section(name))?;
        }
        self.force_check.restore(&from.section("force_check"))?;
        [self.measured_steps] = from.u64s("measured_steps")?;
        let [index, steps_done] = match from.u64s("stage") {
            // It was saved before its first step.
            Err(RestoreError::Missing(_)) if self.state.step == 0 => return Ok(()),
            stage => stage?,
        };
        if index as usize >= self.scene.stages.len() {
            return Err(
                from.misfit("stage", format!("stage {index} of {}", self.scene.stages.len()))
            );
        }
        let before: u64 = self.scene.stages[..index as usize].iter().map(|s| s.steps).sum();
        let of_stage = self.scene.stages[index as usize].steps;
        if steps_done > of_stage || before + steps_done != self.state.step {
            return Err(from.misfit(
                "stage",
                format!(
                    "{steps_done} of {of_stage} steps after {before}, at step {}",
                    self.state.step
                ),
            ));
        }
        if self.measured_steps > self.state.step {
            return Err(from.misfit(
                "measured_steps",
                format!("{} of {}", self.measured_steps, self.state.step),
            ));
        }
        let mut stage = self.stage_run_for(index as usize);
        stage.steps_done = steps_done;
        [stage.heat, stage.start_energy] = from.f64s("stage_energy")?;
        stage.integrator.restore(&from.section("method"))?;
        self.stage = Some(stage);
        Ok(())
    }
}

/// The box of a saved run; `None` where the box is still the box of the start.
fn saved_box(from: &StateReader<'_>) -> Result<Option<PeriodicBox>, RestoreError> {
    let sides = match from.vec3("box") {
        Err(RestoreError::Missing(_)) => return Ok(None),
        Ok([sides]) => *sides,
        Ok(others) => {
            return Err(from.misfit("box", format!("{} boxes, wanted 1", others.len())));
        }
        Err(error) => return Err(error),
    };
    let cell = PeriodicBox::new(sides).map_err(|e| from.misfit("box", e.to_string()))?;
    Ok(Some(cell))
}
