//! A simulation: the system, its forces, the stage that runs, and who watches; and the main loop.

use std::time::Instant;

use lennard_core::random::Streams;
use lennard_core::{
    Backend, Integrator, Momentum, Observable, Persist, RestoreError, State, StateReader,
    StateWriter, StepError, System, Want,
};
use lennard_forcefield::ForceFieldOptions;
use lennard_observables::Thermodynamics;
use lennard_scene::{Scene, Stage};

use crate::force_check::{ForceCheck, Seen};
use crate::initial;
use crate::instant::view;
use crate::timers::Timers;
use crate::watchdog::{self, Circumstances, PhysicsFailure, Symptom};

/// An observable with its interval.
pub struct Observer {
    /// Steps between samples.
    pub every: u64,
    /// What samples.
    pub observable: Box<dyn Observable>,
}

/// The stage under way: its integrator, and what its heat bath has put in.
pub struct StageRun {
    /// Index in the scene.
    pub index: usize,
    /// Steps done of it.
    pub steps_done: u64,
    /// Step size in τ.
    pub dt: f64,
    /// The method that advances the state, with the heat bath between its steps.
    pub integrator: Integrator,
    /// Σ heat since the stage began, ε.
    pub heat: f64,
    /// Conserved energy per particle at the start, ε.
    pub start_energy: f64,
}

/// Everything that a run is made of.
pub struct Simulation {
    /// The scene as resolved.
    pub scene: Scene,
    /// Masses and constraints.
    pub system: System,
    /// Box, positions, velocities, forces.
    pub state: State,
    /// The forces.
    pub forces: Box<dyn Backend>,
    /// Forces of a few particles at a time against sums over all pairs.
    pub force_check: ForceCheck,
    /// What the forces are of, which the tail correction follows from.
    pub force_field: ForceFieldOptions,
    /// Random streams of the scene's seed.
    pub streams: Streams,
    /// The stage under way; `None` before the first.
    pub stage: Option<StageRun>,
    /// Thermodynamic averages of the measured stages.
    pub thermodynamics: Thermodynamics,
    /// The other observables, sampled in measured stages.
    pub observers: Vec<Observer>,
    /// Steps since the first measured stage began.
    pub measured_steps: u64,
    /// What is to be known of the start, for the record.
    pub remarks: Vec<String>,
    /// Where the time went.
    pub timers: Timers,
    /// Instruction set of the pair kernel, for the record.
    pub isa: String,
}

/// Up to this many particles a step is so short that a thread which falls asleep between two of its parts
/// wakes too late to help.
const SHORT_STEPS_UP_TO: usize = 50_000;

/// What the main loop hands to those outside after each step.
pub trait Follower {
    /// What this follower wants from the forces at a step.
    fn want(&self, scene: &Scene, step: u64, measured: bool) -> Want;
    /// Whether it has to be called after a step. Where nobody looks, several steps are taken in one go; up to
    /// [`watchdog::EVERY`] without a call.
    fn looks_at(&self, scene: &Scene, step: u64, measured: bool) -> bool;
    /// Called after steps with the simulation as it is; an error ends the run.
    ///
    /// # Errors
    /// Whatever keeps the run from going on (a full disk).
    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, crate::EngineError>;
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Go on.
    Continue,
    /// Stop after this step.
    Stop,
}

/// Follows nothing.
pub struct Nobody;

impl Follower for Nobody {
    fn want(&self, _scene: &Scene, _step: u64, _measured: bool) -> Want {
        Want::NOTHING
    }
    fn looks_at(&self, _scene: &Scene, _step: u64, _measured: bool) -> bool {
        false
    }
    fn after_step(&mut self, _simulation: &mut Simulation) -> Result<Verdict, crate::EngineError> {
        Ok(Verdict::Continue)
    }
}

impl Simulation {
    /// Runs stages until the scene's end, or until a follower says stop. `Ok(true)` at the end.
    ///
    /// # Errors
    /// [`crate::EngineError`] where physics or a follower fails.
    pub fn run(&mut self, follower: &mut dyn Follower) -> Result<bool, crate::EngineError> {
        if self.state.positions.len() <= SHORT_STEPS_UP_TO {
            lennard_core::parallel::awake(|| self.run_stages(follower))
        } else {
            self.run_stages(follower)
        }
    }

    fn run_stages(&mut self, follower: &mut dyn Follower) -> Result<bool, crate::EngineError> {
        while self.enter_next_stage()? {
            let steps = self.current_stage().steps;
            while self.stage_run().steps_done < steps {
                self.go_on(follower)?;
                if follower.after_step(self)? == Verdict::Stop {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Advances to the next step at which anything besides the motion is due, then watches and samples.
    fn go_on(&mut self, follower: &dyn Follower) -> Result<(), crate::EngineError> {
        let next = self.next_look(follower);
        let want =
            self.wanted_at(next) | follower.want(&self.scene, next, self.current_stage().measure);
        let clock = Instant::now();
        while self.state.step < next {
            self.advance(next, want)?;
        }
        self.timers.step += clock.elapsed();
        self.watch()?;
        self.sample(next);
        Ok(())
    }

    /// Advances by as many steps as the method takes at once, at most to step `next`.
    fn advance(&mut self, next: u64, want: Want) -> Result<(), crate::EngineError> {
        let stage = self.stage.as_mut().expect("a stage has been entered");
        let before = self.state.step;
        let advanced = stage.integrator.stride(
            &self.system,
            &mut self.state,
            self.forces.as_mut(),
            stage.dt,
            next - before,
            want,
        );
        match advanced {
            Ok((steps, report)) => {
                stage.steps_done += steps;
                stage.heat += report.heat;
                if self.current_stage().measure {
                    self.measured_steps += steps;
                }
                Ok(())
            }
            Err(error) => {
                // The last one that began was not done.
                stage.steps_done += (self.state.step - before).saturating_sub(1);
                Err(self.failed(error))
            }
        }
    }

    /// The next step that somebody looks at: a heat bath, an observable, the watchdog, the follower.
    fn next_look(&self, follower: &dyn Follower) -> u64 {
        let stage = self.stage_run();
        let plan = self.current_stage();
        let end = self.state.step + (plan.steps - stage.steps_done);
        let next = self.state.step + 1;
        (next..end)
            .find(|step| {
                step.is_multiple_of(watchdog::EVERY)
                    || self.samples_at(*step)
                    || follower.looks_at(&self.scene, *step, plan.measure)
            })
            .unwrap_or(end)
    }

    /// Whether an observable looks at a step.
    fn samples_at(&self, step: u64) -> bool {
        let due = |every: u64| step.is_multiple_of(every);
        self.current_stage().measure
            && (due(self.scene.output.thermo_every) || self.observers.iter().any(|o| due(o.every)))
    }

    /// What the observables want at a step.
    fn wanted_at(&self, step: u64) -> Want {
        if !self.current_stage().measure {
            return Want::NOTHING;
        }
        let mut want = Want::NOTHING;
        if step.is_multiple_of(self.scene.output.thermo_every) {
            want |= self.thermodynamics.want();
        }
        for observer in self
            .observers
            .iter()
            .filter(|o| step.is_multiple_of(o.every))
        {
            want |= observer.observable.want();
        }
        want
    }

    /// Lets everyone look whose turn it is.
    fn sample(&mut self, step: u64) {
        if !self.current_stage().measure {
            return;
        }
        let clock = Instant::now();
        let (tail, stage) = (self.tail(), self.stage.as_ref());
        let view = view(&self.state, &self.system, tail, stage);
        if step.is_multiple_of(self.scene.output.thermo_every) {
            self.thermodynamics.sample(&view);
        }
        for observer in self
            .observers
            .iter_mut()
            .filter(|o| step.is_multiple_of(o.every))
        {
            observer.observable.sample(&view);
        }
        self.timers.observe += clock.elapsed();
    }

    /// Looks for signs of a run gone wrong.
    fn watch(&mut self) -> Result<(), crate::EngineError> {
        let stage = self.stage_run();
        let (step, dt) = (self.state.step, stage.dt);
        let at_end = stage.steps_done == self.current_stage().steps;
        if let Some(energy) = self.conserved_energy_per_particle() {
            watchdog::check_energy(stage.start_energy, energy).map_err(|s| self.diagnosed(s))?;
        } else if !step.is_multiple_of(watchdog::EVERY) && !at_end {
            return Ok(());
        }
        if step.is_multiple_of(watchdog::LISTS_EVERY) || at_end {
            let seen = self.watch_closely()?;
            self.force_check.count(seen);
            return Ok(());
        }
        watchdog::check_speeds(&self.state, dt).map_err(|s| self.diagnosed(s))
    }

    /// Looks at speeds and at forces of a few particles whatever the step, and counts nothing: what a run counts must not
    /// depend on where checkpoints are.
    pub(crate) fn watch_closely(&self) -> Result<Seen, crate::EngineError> {
        watchdog::check_speeds(&self.state, self.stage_run().dt).map_err(|s| self.diagnosed(s))?;
        let seen = self.force_check.look(&self.state);
        seen.map_err(|s| self.diagnosed(s))
    }

    /// Moves on to the next stage where the current one is done; `false` at the end of the scene.
    fn enter_next_stage(&mut self) -> Result<bool, crate::EngineError> {
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
    fn stage_run_for(&self, index: usize) -> StageRun {
        let plan = &self.scene.stages[index];
        let noise = self.streams.noise("thermostat");
        let method = lennard_integrators::build(&self.scene.integrator.method);
        let integrator = match &plan.thermostat {
            None => method,
            Some(bath) => bath.couple(method, plan.temperature, noise),
        };
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
    fn restart_method(&mut self, want: Want) -> Result<(), crate::EngineError> {
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

    /// The stage under way.
    ///
    /// # Panics
    /// Before the first stage: callers run inside the loop.
    #[must_use]
    pub fn stage_run(&self) -> &StageRun {
        self.stage.as_ref().expect("a stage has been entered")
    }

    /// The scene's description of the stage under way.
    #[must_use]
    pub fn current_stage(&self) -> &Stage {
        &self.scene.stages[self.stage_run().index]
    }

    pub(crate) fn failed(&self, error: StepError) -> crate::EngineError {
        match error {
            StepError::Force(e) => self.diagnosed(Symptom::NonFinite(e)),
            StepError::NotConverged { .. } => self.diagnosed(Symptom::Method(error)),
            // Everything else is a combination that the scene should not ask for.
            other => self
                .scene
                .source
                .invalid("integrator.kind", other, "a method that suits the forces")
                .into(),
        }
    }

    fn diagnosed(&self, symptom: Symptom) -> crate::EngineError {
        let plan = self.current_stage();
        let stage = self.stage_run();
        let spec = stage.integrator.spec();
        let at = Circumstances {
            stage: &plan.name,
            method: spec.name,
            dt: stage.dt,
            dt_limit: spec
                .stability_limit
                .map(|limit| watchdog::rough_stable_dt(plan.temperature, limit)),
            steps_into_stage: stage.steps_done,
            temperature: plan.temperature,
            density: self.state.len() as f64 / self.state.cell.volume(),
        };
        let failure: PhysicsFailure = watchdog::diagnose(&self.state, at, symptom);
        crate::EngineError::Physics(Box::new(failure))
    }
}

impl Persist for Simulation {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.state.save(&mut to.section("state"));
        self.forces.save(&mut to.section("forces"));
        self.thermodynamics.save(&mut to.section("thermodynamics"));
        for (i, observer) in self.observers.iter().enumerate() {
            observer
                .observable
                .save(&mut to.section(&format!("observer-{i}")));
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
        self.forces.restore(&from.section("forces"))?;
        self.thermodynamics
            .restore(&from.section("thermodynamics"))?;
        for (i, observer) in self.observers.iter_mut().enumerate() {
            observer
                .observable
                .restore(&from.section(&format!("observer-{i}")))?;
        }
        self.force_check.restore(&from.section("force_check"))?;
        [self.measured_steps] = from.u64s("measured_steps")?;
        let [index, steps_done] = from.u64s("stage")?;
        if index as usize >= self.scene.stages.len() {
            return Err(from.misfit(
                "stage",
                format!("stage {index} of {}", self.scene.stages.len()),
            ));
        }
        let before: u64 = self.scene.stages[..index as usize]
            .iter()
            .map(|s| s.steps)
            .sum();
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
