//! What is due beside the motion, and at which steps: the one place that knows.

use lennard_core::Want;
use lennard_observables::Observable;
use lennard_scene::Scene;

/// Steps between two states set aside for the case that physics fails. Copying so few bytes per particle takes
/// far below 1 % of the time of a hundred steps.
pub const SET_ASIDE_EVERY: u64 = 100;
/// When an operation is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trigger {
    /// At each step that is a multiple of the number.
    Every(u64),
    /// The same, in measured stages alone.
    EveryMeasured(u64),
    /// At one step.
    At(u64),
    /// At each step.
    Always,
}

impl Trigger {
    /// Whether an operation is due at a step of a stage that is measured or not.
    #[must_use]
    pub fn is_due(self, step: u64, measured: bool) -> bool {
        match self {
            Self::Every(every) => step.is_multiple_of(every),
            Self::EveryMeasured(every) => measured && step.is_multiple_of(every),
            Self::At(at) => step == at,
            Self::Always => true,
        }
    }
}

/// What an operation does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// An observable takes a sample.
    Sample,
    /// A row of `thermo.csv` is written.
    Row,
    /// A frame of the trajectory is written.
    Frame,
    /// The state is set aside for the case that physics fails.
    SetAside,
    /// A checkpoint is written.
    Checkpoint,
    /// The caller takes control.
    Call,
}

/// One operation: what it does, when it is due, and what it wants of the forces then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operation {
    /// What it does.
    pub action: Action,
    /// When it is due.
    pub trigger: Trigger,
    /// What the forces deliver for it.
    pub want: Want,
}

impl Operation {
    /// An operation that wants forces alone.
    #[must_use]
    pub fn new(action: Action, trigger: Trigger) -> Self {
        Self { action, trigger, want: Want::NOTHING }
    }

    /// The same operation with what it wants of the forces.
    #[must_use]
    pub fn wanting(self, want: Want) -> Self {
        Self { want, ..self }
    }
}

/// Operations beside the motion.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Schedule(Vec<Operation>);

impl Schedule {
    /// Nothing is due.
    #[must_use]
    pub const fn empty() -> Self {
        Self(Vec::new())
    }

    /// What a run of a scene writes: rows, frames, the state set aside, checkpoints by steps, and the last state.
    #[must_use]
    pub fn of_output(scene: &Scene) -> Self {
        let totals = Want::ENERGY_AND_VIRIAL;
        let rows = Operation::new(Action::Row, Trigger::Every(scene.output.thermo_every));
        let last = Operation::new(Action::Call, Trigger::At(scene.total_steps()));
        let aside = Operation::new(Action::SetAside, Trigger::Every(SET_ASIDE_EVERY));
        let frames = scene.output.trajectory_every.map(|every| {
            Operation::new(Action::Frame, Trigger::EveryMeasured(every)).wanting(totals)
        });
        let checkpoints = scene
            .checkpoint
            .every_steps
            .map(|every| Operation::new(Action::Checkpoint, Trigger::Every(every)));
        [rows.wanting(totals), last.wanting(totals), aside]
            .into_iter()
            .chain(frames)
            .chain(checkpoints)
            .collect()
    }

    /// The same schedule with one operation more.
    #[must_use]
    pub fn with(mut self, operation: Operation) -> Self {
        self.add(operation);
        self
    }

    /// Adds an operation.
    pub(crate) fn add(&mut self, operation: Operation) {
        self.0.push(operation);
    }

    /// Whether any operation is due at a step.
    #[must_use]
    pub fn is_due(&self, step: u64, measured: bool) -> bool {
        self.0.iter().any(|o| o.trigger.is_due(step, measured))
    }

    /// Whether an operation that does this is due at a step.
    #[must_use]
    pub fn does(&self, action: Action, step: u64, measured: bool) -> bool {
        let mut these = self.0.iter().filter(|o| o.action == action);
        these.any(|o| o.trigger.is_due(step, measured))
    }

    /// What the operations that are due at a step want of the forces.
    #[must_use]
    pub fn want(&self, step: u64, measured: bool) -> Want {
        let due = self.0.iter().filter(|o| o.trigger.is_due(step, measured));
        due.fold(Want::NOTHING, |all, o| all | o.want)
    }
}

impl FromIterator<Operation> for Schedule {
    fn from_iter<I: IntoIterator<Item = Operation>>(operations: I) -> Self {
        Self(operations.into_iter().collect())
    }
}

/// An observable with its interval; it samples in measured stages.
pub struct Observer {
    /// Steps between samples.
    pub every: u64,
    /// What samples.
    pub observable: Box<dyn Observable>,
}

impl Observer {
    /// When it samples.
    #[must_use]
    pub fn trigger(&self) -> Trigger {
        Trigger::EveryMeasured(self.every)
    }

    /// Its samples as an operation.
    #[must_use]
    pub fn operation(&self) -> Operation {
        Operation::new(Action::Sample, self.trigger()).wanting(self.observable.want())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_run_writes_is_due_where_the_scene_says() {
        let text = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.0\n[truncation]\nr_cut = 2.2\n\
                    [output]\nthermo_every = 10\ntrajectory_every = 15\n[checkpoint]\nevery_steps = 7\n\
                    [[stage]]\nname = \"a\"\nsteps = 101\n";
        let scene = Scene::parse(text, "scene.toml", &[]).unwrap_or_else(|e| panic!("{e}"));
        let schedule = Schedule::of_output(&scene);
        let due = |action, measured| -> Vec<u64> {
            let steps = 1..=101;
            steps.filter(|step| schedule.does(action, *step, measured)).collect()
        };
        assert_eq!(due(Action::Frame, true), [15, 30, 45, 60, 75, 90]);
        assert_eq!(due(Action::Frame, false), [0; 0]);
        assert_eq!(due(Action::Row, false).len(), 10);
        assert_eq!(due(Action::SetAside, true), [100]);
        assert_eq!(due(Action::Checkpoint, true).len(), 14);
        assert_eq!(schedule.want(15, true), Want::ENERGY_AND_VIRIAL);
        assert_eq!(schedule.want(15, false), Want::NOTHING);
        assert_eq!(schedule.want(7, true), Want::NOTHING);
        // The last state has its energy whatever else is due.
        assert_eq!(schedule.want(101, false), Want::ENERGY_AND_VIRIAL);
        assert!(schedule.is_due(7, false) && !schedule.is_due(11, true));
    }
}
