//! The main loop enters the next stage and advances to the next step at which anything is due. Then it watches, samples and tells the
//! follower.

use std::time::Instant;

use lennard_core::{Integrator, Momentum, PressureBath, Want};
use lennard_integrators::BondHolder;

use crate::follower::Follower;
use crate::instant::view;
use crate::schedule::Observer;
use crate::simulation::StageRun;
use crate::watchdog;
use crate::{EngineError, Simulation, baths, pressure, start};

/// Up to this many particles a step is short: a thread that falls asleep between two parts of a step
/// wakes too late to help.
const SHORT_STEPS_UP_TO: usize = 50_000;

impl Simulation {
    /// Runs stages until the scene's end, or until a follower says stop. `Ok(true)` at the end.
    ///
    /// # Errors
    /// [`EngineError`] where physics or a follower fails.
    pub fn follow(&mut self, follower: &mut dyn Follower) -> Result<bool, EngineError> {
        if self.state.len() <= SHORT_STEPS_UP_TO {
            lennard_core::parallel::awake(|| self.run_stages(follower))
        } else {
            self.run_stages(follower)
        }
    }

    fn run_stages(&mut self, follower: &mut dyn Follower) -> Result<bool, EngineError> {
        while self.enter_next_stage()? {
            while self.steps_left() > 0 {
                let next = self.next_due(follower);
                self.advance_to(next, self.wanted_at(next, follower))?;
                self.exchange();
                self.watch()?;
                self.sample();
                if follower.after_step(self)?.is_break() {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn steps_left(&self) -> u64 {
        self.current_stage().steps - self.stage_run().steps_done
    }

    /// The next step at which anything is due: an observable, the watchdog, the follower, an exchange, or the end of the stage.
    fn next_due(&self, follower: &dyn Follower) -> u64 {
        let measured = self.current_stage().measure;
        let exchange = self.current_stage().exchange.as_ref();
        // Ranks check speeds inside of steps that are taken at once.
        let every = if self.team().is_some() { watchdog::LISTS_EVERY } else { watchdog::EVERY };
        let is_due = |step: &u64| {
            step.is_multiple_of(every)
                || exchange.is_some_and(|exchange| step.is_multiple_of(exchange.every))
                || self.observers.iter().any(|o| o.trigger().is_due(*step, measured))
                || follower.schedule().is_due(*step, measured)
        };
        let next = self.state.step + 1;
        let end = self.state.step + self.steps_left();
        if follower.is_waiting() {
            return next;
        }
        (next..end).find(is_due).unwrap_or(end)
    }

    /// What all that is due at a step wants of the forces.
    pub(crate) fn wanted_at(&self, step: u64, follower: &dyn Follower) -> Want {
        let measured = self.current_stage().measure;
        let samples = self.observers.iter().map(Observer::operation);
        samples
            .filter(|sample| sample.trigger.is_due(step, measured))
            .fold(follower.schedule().want(step, measured), |all, sample| all | sample.want)
    }

    /// Advances to a step, by as many steps at once as the integrator takes.
    pub(crate) fn advance_to(&mut self, next: u64, want: Want) -> Result<(), EngineError> {
        let clock = Instant::now();
        let measured = self.current_stage().measure;
        let stage = self.stage.as_mut().expect("a stage has been entered");
        while self.state.step < next {
            let before = self.state.step;
            let forces = self.forces.as_mut();
            let advanced = stage.integrator.stride(
                &self.system,
                &mut self.state,
                forces,
                stage.dt,
                next - before,
                want,
            );
            match advanced {
                Ok((steps, report)) => {
                    stage.steps_done += steps;
                    report.add_heat_to(&mut stage.heat);
                    if measured {
                        self.measured_steps += steps;
                    }
                    if steps == 1 && self.state.step.is_multiple_of(watchdog::EVERY) {
                        break;
                    }
                }
                Err(error) => {
                    // The last step that began was not done.
                    stage.steps_done += (self.state.step - before).saturating_sub(1);
                    return Err(self.failed(error));
                }
            }
        }
        self.timers.step += clock.elapsed();
        Ok(())
    }

    /// Lets the observables sample that are due.
    pub(crate) fn sample(&mut self) {
        let (step, measured) = (self.state.step, self.current_stage().measure);
        let clock = Instant::now();
        let (tail, stage) = (self.tail(), self.stage.as_ref());
        let walls = self.forces.walls();
        let view = view(&self.state, &self.system, tail, stage, walls);
        for observer in &mut self.observers {
            if observer.trigger().is_due(step, measured) {
                observer.observable.sample(&view);
            }
        }
        self.timers.observe += clock.elapsed();
    }

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
    #[must_use]
    pub fn stage_run_for(&self, index: usize) -> StageRun {
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
        self.system.len() as f64 / self.start_cell.volume()
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
