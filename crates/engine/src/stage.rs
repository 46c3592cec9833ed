//! The stage under way, and the way into the next one.

use lennard_core::{Momentum, Want};
use lennard_integrators::BondHolder;

use crate::simulation::StageRun;
use crate::{EngineError, Simulation, initial};

impl Simulation {
    /// Moves on to the next stage where the current one is done; `false` at the end of the scene.
    pub(crate) fn enter_next_stage(&mut self) -> Result<bool, EngineError> {
        let index = match &self.stage {
            None => 0,
            Some(stage) if stage.steps_done < self.scene.stages[stage.index].steps => {
                return Ok(true);
            }
            Some(stage) => stage.index + 1,
        };
        if index >= self.scene.stages.len() {
            return Ok(false);
        }
        let was_noisy = self
            .stage
            .as_ref()
            .is_some_and(|s| s.integrator.momentum() == Momentum::Free);
        let stage = self.stage_run_for(index);
        let keeps_momentum = stage.integrator.momentum() == Momentum::Conserved;
        self.stage = Some(stage);
        if keeps_momentum && was_noisy {
            // A Langevin stage leaves the fluid drifting; n_dof = 3N − 3 assumes that it does not.
            initial::remove_drift(&self.system, &mut self.state.velocities);
        }
        self.restart_method(Want::ENERGY)?;
        let energy = self.conserved_energy_per_particle();
        self.stage.as_mut().expect("just entered").start_energy = energy.unwrap_or(f64::NAN);
        Ok(true)
    }

    /// A fresh method and bath for a stage.
    pub(crate) fn stage_run_for(&self, index: usize) -> StageRun {
        let plan = &self.scene.stages[index];
        let noise = self.streams.noise("thermostat");
        let method = lennard_integrators::build(&self.scene.integrator.method);
        let mut integrator = match &plan.thermostat {
            None => method,
            Some(bath) => bath.couple(method, plan.temperature, noise),
        };
        if let Some(molecule) = &self.scene.molecule
            && let BondHolder::Rigid(solver) = molecule.bonds.build(&self.system.molecules)
        {
            integrator = integrator.with_bonds(solver);
        }
        StageRun {
            index,
            steps_done: 0,
            dt: plan.dt.unwrap_or(self.scene.integrator.dt),
            integrator,
            heat: 0.0,
            start_energy: f64::NAN,
        }
    }

    /// Starts the method anew from the state as it is.
    fn restart_method(&mut self, want: Want) -> Result<(), EngineError> {
        let stage = self.stage.as_mut().expect("a stage has been entered");
        stage
            .integrator
            .start(
                &self.system,
                &mut self.state,
                self.forces.as_mut(),
                stage.dt,
                want,
            )
            .map_err(|error| self.failed(error))
    }
}
