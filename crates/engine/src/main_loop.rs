//! The main loop: advance to the next step at which anything is due, then watch, sample, and hand over to the follower.

use std::time::Instant;

use lennard_core::Want;

use crate::follower::Follower;
use crate::instant::view;
use crate::schedule::Observer;
use crate::watch::WATCH;
use crate::{EngineError, Simulation};

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
        let is_due = |step: &u64| {
            WATCH.trigger.is_due(*step, measured)
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
}
