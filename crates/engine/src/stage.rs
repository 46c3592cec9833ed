//! The stage under way, and the way into the next one.

use lennard_core::{Integrator, Momentum, PressureBath, Want};
use lennard_integrators::BondHolder;

use crate::simulation::StageRun;
use crate::{EngineError, Simulation, baths, pressure, start};

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
        let was_noisy =
            self.stage.as_ref().is_some_and(|s| s.integrator.momentum() == Momentum::Free);
        let stage = self.stage_run_for(index);
        let keeps_momentum = stage.integrator.momentum() == Momentum::Conserved;
        self.stage = Some(stage);
        if keeps_momentum && was_noisy {
            // A Langevin stage leaves the fluid drifting; n_dof = 3N − 3 assumes that it does not.
            start::remove_drift(&self.system, &mut self.state.velocities);
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
        let molecule = self.scene.molecule.as_ref();
        let holder = molecule.map(|m| m.bonds.build(&self.system.molecules));
        let by_contacts = self.forces.properties().holds_bonds;
        let (method, solver) = match holder {
            Some(BondHolder::Spook(..)) if by_contacts => (self.method(), None),
            Some(BondHolder::Spook(bonds, _)) => {
                (lennard_integrators::spook::with_bonds(bonds), None)
            }
            Some(BondHolder::Drift(solver) | BondHolder::InDrift(solver, _)) => {
                (self.method(), Some(solver))
            }
            Some(BondHolder::Spring(_)) | None => (self.method(), None),
        };
        let first = self.scene.steps_before(index);
        let temperature = plan.temperature_ramp(first);
        let mut integrator = match &plan.thermostat {
            None => method,
            Some(bath) => bath.couple(method, temperature, noise),
        };
        let mut tail_work = 0.0;
        if let (Some(control), Some(thermostat), Some(pressure)) =
            (&plan.barostat, &plan.thermostat, plan.pressure_ramp(first))
        {
            tail_work = self.tail_work();
            let bath = PressureBath {
                pressure,
                temperature,
                tail: tail_work,
                compressibility: pressure::compressibility(&self.scene, plan, self.start_density()),
            };
            let noise = self.streams.noise("barostat");
            integrator = control.options.couple(integrator, thermostat, bath, noise);
        }
        // Last, since a barostat inside the step makes an integrator of its own.
        if let Some(solver) = solver {
            integrator = integrator.with_bonds(solver);
        }
        StageRun {
            index,
            steps_done: 0,
            dt: plan.dt.unwrap_or(self.scene.integrator.dt),
            integrator,
            heat: 0.0,
            start_energy: f64::NAN,
            tail_work,
        }
    }

    fn method(&self) -> Integrator {
        baths::method(&self.scene, &self.own)
    }

    /// c_P = V²·P_tail in ε·σ³, which does not depend on the volume; 0 without tail.
    fn tail_work(&self) -> f64 {
        let volume = self.start_cell.volume();
        let tail = self.tail_in(volume);
        tail.map_or(0.0, |tail| tail.pressure * volume * volume)
    }

    /// Number density of the start, σ⁻³.
    fn start_density(&self) -> f64 {
        self.state.len() as f64 / self.start_cell.volume()
    }

    /// Starts the method anew from the state as it is.
    fn restart_method(&mut self, want: Want) -> Result<(), EngineError> {
        let stage = self.stage.as_mut().expect("a stage has been entered");
        stage
            .integrator
            .start(&self.system, &mut self.state, self.forces.as_mut(), stage.dt, want)
            .map_err(|error| self.failed(error))
    }
}
