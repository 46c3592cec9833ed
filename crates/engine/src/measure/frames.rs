//! The times of frames, and the method whose steps are frames.

use lennard_core::{
    ForceProperties, IntegratorSpec, Method, Step, StepError, System, remembers_nothing,
};
use lennard_io::TrajectoryFrame;
use lennard_scene::Scene;

use crate::from_frames::NAME;

/// Times of frames may be apart by this share of the interval, and by the rounding of single precision.
const SAME_TIME: f64 = 1e-3;

/// What was found and what is allowed.
type Refusal = (String, String);

/// When frames come.
pub(super) struct Clock {
    /// The time between two frames, τ.
    pub(super) interval: f64,
    /// What each frame says of its time: a step, or a time in τ.
    mark: Mark,
    /// How far apart these are; `None` where frames say nothing of use.
    apart: Option<f64>,
    last: Option<f64>,
}

type Mark = fn(&TrajectoryFrame) -> Option<f64>;

impl Clock {
    /// From what is asked for, from the times of two frames, or from their steps and the `dt` that the scene writes.
    pub(super) fn new(
        scene: &Scene,
        asked: Option<f64>,
        first: &TrajectoryFrame,
        second: Option<&TrajectoryFrame>,
    ) -> Result<Self, Refusal> {
        let marks: [Mark; 2] = [|frame| frame.step.map(|step| step as f64), |frame| frame.time];
        let apart = |mark: Mark| Some(mark(second?)? - mark(first)?).filter(|apart| *apart > 0.0);
        let [steps, times] = marks.map(apart);
        let is_written = scene.source.wrote("integrator.dt");
        let by_steps = steps.filter(|_| is_written).map(|steps| steps * scene.integrator.dt);
        // Times in single precision are coarser than steps.
        let same = |time: &f64| by_steps.is_some_and(|of| (time / of - 1.0).abs() < SAME_TIME);
        let known = asked.or(times.filter(|time| !same(time))).or(by_steps);
        let alone = second.is_none().then_some(scene.integrator.dt);
        let interval = known.or(alone).ok_or_else(|| {
            let found = match steps {
                Some(_) => "steps without times, and no `integrator.dt` in the scene",
                None => "no times and no steps",
            };
            let allowed = "`--interval`, the time between two frames in τ; or steps in the file and `integrator.dt` in the scene";
            (found.to_owned(), allowed.to_owned())
        })?;
        let mark = marks[usize::from(steps.is_none())];
        Ok(Self { interval, mark, apart: steps.or(times), last: None })
    }

    /// Whether a frame comes as long after the frame before it as the second came after the first.
    pub(super) fn check(&mut self, frame: &TrajectoryFrame) -> Result<(), Refusal> {
        let (Some(apart), now) = (self.apart, (self.mark)(frame).unwrap_or(f64::NAN)) else {
            return Ok(());
        };
        let wanted = self.last.replace(now).map_or(now, |last| last + apart);
        let allowed = SAME_TIME * apart + 2.0 * f64::from(f32::EPSILON) * now.abs();
        match (now - wanted).abs() <= allowed {
            true => Ok(()),
            false => Err((
                format!("the step or time {now}"),
                format!("{wanted}: frames at equal times, as the first two"),
            )),
        }
    }
}

static SPEC: IntegratorSpec = IntegratorSpec {
    name: NAME,
    summary: "Positions and velocities come from the frames of a trajectory.",
    equations: "x(t+h), v(t+h) as the file has them; F(t+h) of the scene",
    position_order: 0,
    velocity_order: 0,
    symplectic: false,
    reversible: false,
    fixed_step_only: true,
    velocity_dependent_forces: false,
    conserves_momentum: true,
    half_kicks: false,
    is_kick_drift_kick: false,
    holds_rigid_bonds: false,
    on_ranks: false,
    force_evaluations: 1,
    stability_limit: None,
    oscillator_map: None,
    source: "none: the trajectory is of another program",
};

/// A step to the next frame, whose positions and velocities are in the state already.
#[derive(Debug, Clone)]
pub(super) struct FrameByFrame;

impl Method for FrameByFrame {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    /// Another program has held the bonds.
    fn suits(&self, _system: &System, _forces: ForceProperties) -> Result<(), String> {
        Ok(())
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.forces()
    }
}

remembers_nothing!(FrameByFrame);
