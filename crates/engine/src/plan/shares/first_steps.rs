//! The first steps of a scene, taken until they tell how long a step takes.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lennard_core::ForceStatistics;

use crate::EngineError;
use crate::follower::Follower;
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::simulation::Simulation;

/// How long the steps are measured.
const STEPS_FOR: Duration = Duration::from_millis(400);
/// The fewest steps after the first that tell what a step takes: the first one builds the list and touches new memory.
const FEWEST_STEPS: usize = 3;
/// Steps that are as good as a whole life of a list, where none is built again.
const MANY_STEPS: usize = 50;
/// How long `FEWEST_STEPS` are waited for, and a second build of the list.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// Times steps, and stops once they are enough.
pub(super) struct FirstSteps {
    schedule: Schedule,
    start: Instant,
    /// What the forces did up to the end of the first step.
    pub(super) first: Option<ForceStatistics>,
    /// The end of the last step.
    last: Instant,
    /// Seconds of each step after the first.
    pub(super) seconds: Vec<f64>,
}

impl FirstSteps {
    /// Measures from a start on.
    pub(super) fn from(start: Instant) -> Self {
        let each_step = Operation::new(Action::Call, Trigger::Always);
        Self {
            schedule: Schedule::empty().with(each_step),
            start,
            first: None,
            last: start,
            seconds: Vec::new(),
        }
    }

    /// The mean time of a step, seconds; `None` where the steps are too few to tell.
    pub(super) fn mean(&self) -> Option<f64> {
        let steps = self.seconds.len();
        (steps >= FEWEST_STEPS).then(|| self.seconds.iter().sum::<f64>() / steps as f64)
    }

    /// Whether the steps tell what a step takes, its share of the next build of the list included.
    fn is_enough(&self, simulation: &Simulation) -> bool {
        let built = self.first.map_or(0, |first| first.builds);
        self.last - self.start >= STEPS_FOR
            && self.seconds.len() >= FEWEST_STEPS
            && (self.seconds.len() >= MANY_STEPS
                || built == 0
                || simulation.forces.statistics().builds > built)
    }
}

impl Follower for FirstSteps {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        if self.first.is_some() {
            self.seconds.push(self.last.elapsed().as_secs_f64());
        } else {
            self.first = Some(simulation.forces.statistics());
        }
        self.last = Instant::now();
        let is_over = self.last - self.start >= PATIENCE || self.is_enough(simulation);
        Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }
}
