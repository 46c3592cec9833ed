//! What each part of a run costs: a short measurement, which decides nothing.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use lennard_core::{
    Configuration, ForceStatistics, Integrator, NoForces, Part as Whole, Persist, StateArchive,
    Want,
};
use lennard_io::{Frame, Sink, TrajectoryWriter};
use lennard_scene::{Scene, Stage};

use crate::build::prepare_from;
use crate::course::{aside, set_aside};
use crate::failure::LARGEST_MOVE;
use crate::files::{header, style};
use crate::follower::bare;
use crate::follower::{Follower, StopAt};
use crate::planar_tail::PlanarTail;
use crate::schedule::{Action, Operation, Schedule, Trigger};
use crate::simulation::Simulation;
use crate::start::Start;
use crate::stopwatch::{Spread, Stopwatch, repeated, timed};
use crate::{EngineError, SET_ASIDE_EVERY, watchdog};

/// How long one part is measured alone.
const PART_FOR: Duration = Duration::from_millis(30);
/// Calls of a part that is measured alone, at most.
const CALLS: usize = 9;
/// The observable that every run has.
pub(super) const THERMODYNAMICS: &str = "thermodynamics";
/// Calls of a part of the watchdog in one measurement.
const WATCHING_CALLS: u32 = 50;

/// A part of the work of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// Its name in the plan.
    pub(super) name: String,
    /// How often the run calls it.
    pub(super) calls: f64,
    /// How long one call takes, s.
    seconds: f64,
}

impl Part {
    fn new(name: impl Into<String>, calls: f64, seconds: f64) -> Self {
        // Differences of two measurements may come out below nothing.
        Self { name: name.into(), calls, seconds: seconds.max(0.0) }
    }

    /// Seconds of the whole run.
    pub(super) fn of_run(&self) -> f64 {
        self.calls * self.seconds
    }
}

/// What the first steps of a scene cost, and each part of the run.
pub(super) struct Costs {
    /// Steps in the measurement.
    pub(super) steps: u64,
    /// The median time of a step with everything off, s.
    pub(super) median_step: f64,
    /// Bytes that the forces hold; fused steps are included where the scene has steps without an observer.
    pub(super) force_bytes: u64,
    /// Bytes of what a checkpoint is put together in.
    pub(super) checkpoint_bytes: usize,
    /// The parts of the run; `None` where steps are too slow to measure.
    pub(super) parts: Option<Vec<Part>>,
    /// The mean time of such a step, s; `None` where steps are too slow to measure.
    pub(super) mean_step: Option<f64>,
    /// Builds of the list in such a step, and their share of its time.
    pub(super) builds: f64,
    pub(super) building: f64,
}

impl Costs {
    /// Measures at the start of a scene, after some of its steps.
    pub(super) fn measure(simulation: &mut Simulation) -> Result<Self, EngineError> {
        let bare = with_everything_off(simulation)?;
        Self::after(FirstSteps::from(Instant::now()), bare, simulation)
    }

    /// As [`Costs::measure`], from the first steps of the scene with everything off.
    fn after(
        mut measured: FirstSteps,
        mut bare: Simulation,
        simulation: &mut Simulation,
    ) -> Result<Self, EngineError> {
        bare.follow(&mut measured)?;
        let (first, last) = (measured.first.unwrap_or_default(), bare.forces.statistics());
        let (step, times) = (measured.mean(), measured.seconds);
        let all = times.len().max(1) as f64;
        let force = (last.force_seconds - first.force_seconds) / all;
        let neighbor = (last.neighbor_seconds - first.neighbor_seconds) / all;
        let mut parts = of_parts(simulation, &mut bare)?;
        let others: f64 = parts.iter().filter(|p| is_of_a_step(&p.name)).map(|p| p.seconds).sum();
        let steps = simulation.scene.total_steps() as f64;
        let rest = step.unwrap_or_default() - force - neighbor - others;
        parts.extend([
            Part::new("pair forces", steps, force),
            Part::new("neighbor list", steps, neighbor),
            Part::new("integrator", steps, rest),
        ]);
        let under_a_bath = bytes_under_a_bath(&simulation.scene) * bare.state.len() as u64;
        Ok(Self {
            steps: times.len() as u64,
            median_step: Spread::of(times).map_or(f64::NAN, |steps| steps.median),
            force_bytes: bare.forces.statistics().bytes + under_a_bath,
            checkpoint_bytes: checkpoint_bytes(&bare),
            parts: step.map(|_| parts),
            mean_step: step,
            building: step.map_or(0.0, |step| neighbor / step),
            builds: (last.builds - first.builds) as f64 / all,
        })
    }
}

/// Parts of a bare step beside forces, lists and integrator.
const TAIL: &str = "tail correction";
const WATCHDOG: &str = "watchdog";

fn is_of_a_step(part: &str) -> bool {
    [TAIL, WATCHDOG].contains(&part)
}

/// Measures what a run has beside forces, lists and integrator; it takes some steps more.
fn of_parts(simulation: &mut Simulation, bare: &mut Simulation) -> Result<Vec<Part>, EngineError> {
    let scene = &simulation.scene;
    let mut evaluate = |want| -> Result<f64, EngineError> {
        let mut fault = None;
        let time = median(|| {
            let at = Configuration::at_rest(&bare.state.cell, &bare.state.positions);
            match bare.forces.evaluate(at, Whole::All, want, &mut bare.state.forces) {
                Ok(found) => bare.state.energetics = found,
                Err(error) => fault = Some(error),
            }
        });
        fault.map_or(Ok(time), |e| Err(bare.failed(e.into())))
    };
    let forces = evaluate(Want::NOTHING)?;
    let evaluation = evaluate(Want::ENERGY_AND_VIRIAL)?;
    let with_laplacian = evaluate(Want::TOTALS)?;
    // Measured only where an observer asks: on a large system it takes memory. It also leaves what observers look at.
    let wants = simulation.observers.iter().map(|o| o.observable.want());
    let wanted = wants.fold(Want::TOTALS, |all, want| all | want);
    let beyond = if is_beyond_totals(wanted) { evaluate(wanted)? - with_laplacian } else { 0.0 };
    let totals = evaluation - forces;
    // Seconds that `want` costs at the forces on a step that is due every so often.
    let rows = scene.output.thermo_every;
    let of_want = |want: Want, every: u64| {
        let totals = if want.is_nothing() { 0.0 } else { alone(every, rows) * totals.max(0.0) };
        totals + if is_beyond_totals(want) { beyond.max(0.0) } else { 0.0 }
    };
    let steps = scene.total_steps() as f64;
    let measured_every = |every: u64| scene.measured_steps() as f64 / every as f64;
    let mut parts = vec![
        Part::new("energy and virial", steps / rows as f64, totals),
        Part::new("configurational temperature", measured_every(rows), with_laplacian - evaluation),
    ];
    parts.extend(PlanarTail::of(&bare.scene, &bare.state.cell).map(|tail| {
        let mut forces = bare.state.forces.clone();
        let call = || drop(tail.push(&bare.state.cell, &bare.state.positions, &mut forces));
        Part::new(TAIL, steps, median(call))
    }));
    let view = bare.view();
    // The first is thermodynamics, whose wishes are parts of the plan by themselves.
    let named = scene.observables.iter().filter(|o| o.options.name() != THERMODYNAMICS);
    let named = named.map(|table| Some((table.options.name(), table.every)));
    for (observer, named) in simulation.observers.iter_mut().zip([None].into_iter().chain(named)) {
        let cost = median(|| observer.observable.sample(&view));
        parts.push(match named {
            None => Part::new(THERMODYNAMICS, measured_every(rows), cost),
            Some((name, every)) => {
                let wanted = of_want(observer.observable.want(), every);
                Part::new(name, measured_every(every), cost + wanted)
            }
        });
    }
    take_steps_unseen(bare, simulation)?;
    for stage in &simulation.scene.stages {
        if let Some(thermostat) = &stage.thermostat {
            let name = bath_name(stage, thermostat.name());
            parts.push(Part::new(name, stage.steps as f64, bath(bare, stage)));
        }
        if let Some(control) = &stage.barostat {
            let name = barostat_name(stage, control.options.name());
            let changes = stage.steps as f64 / control.options.interval() as f64;
            // The step before it asks for energy and virial too.
            let evaluations = control.options.evaluations() as f64;
            parts.push(Part::new(name, changes, evaluations * evaluation + totals));
        }
    }
    parts.extend(simulation.scene.output.trajectory_every.map(|every| {
        let wanted = of_want(Want::ENERGY_AND_VIRIAL, every);
        Part::new("trajectory", measured_every(every), frame(bare) + wanted)
    }));
    parts.push(Part::new(WATCHDOG, steps, watching_seconds(bare)));
    Ok(parts)
}

/// Whether an evaluation with totals alone does not give what is wanted.
fn is_beyond_totals(want: Want) -> bool {
    want | Want::TOTALS != Want::TOTALS
}

/// The share of the steps due every so often on which no row of thermo.csv is due, which has energy and virial computed.
fn alone(every: u64, rows: u64) -> f64 {
    1.0 - watchdog::greatest_common_divisor(every, rows) as f64 / rows as f64
}

/// The median time of a call, s.
fn median(call: impl FnMut()) -> f64 {
    repeated(PART_FOR, CALLS, call).median
}

/// Seconds that the watchdog takes per step, on the clock of the calling thread. It checks speeds and single forces,
/// and copies the state that it goes back to.
#[must_use]
pub fn watching_seconds(simulation: &Simulation) -> f64 {
    let Simulation { state, system, .. } = simulation;
    let per_call = |call: &mut dyn FnMut()| {
        let watch = Stopwatch::start();
        (0..WATCHING_CALLS).for_each(|_| call());
        watch.on_processor() / f64::from(WATCHING_CALLS)
    };
    let dt = simulation.stage_run().dt;
    let mut before = aside(state);
    per_call(&mut || drop(watchdog::check_speeds(system.own(), state, dt, LARGEST_MOVE)))
        / watchdog::EVERY as f64
        + per_call(&mut || {
            drop(simulation.force_check.look(system, state, |_| lennard_core::DVec3::ZERO))
        }) / watchdog::LISTS_EVERY as f64
        + per_call(&mut || set_aside(state, &mut before)) / SET_ASIDE_EVERY as f64
}

/// The same particles with everything off.
fn with_everything_off(simulation: &Simulation) -> Result<Simulation, EngineError> {
    let lennard_core::State { cell, positions, velocities, .. } = &simulation.state;
    let species = simulation.system.species().clone();
    let start = Start::at(*cell, positions.clone(), velocities.clone(), species);
    prepare_from(bare(&simulation.scene), start)
}

/// Takes some steps as the scene does, several in one go where nothing observes them: their memory is then there.
fn take_steps_unseen(bare: &mut Simulation, scene: &Simulation) -> Result<(), EngineError> {
    let end = bare.state.step + watchdog::EVERY;
    let samples = scene.observers.iter().map(|o| Operation {
        // Of observables only the times are followed; the bare scene is not measured.
        trigger: Trigger::Every(o.every),
        ..Operation::new(Action::Sample, o.trigger())
    });
    let schedule = samples.fold(Schedule::of_output(&scene.scene), Schedule::with);
    bare.follow(&mut StopAt::following(schedule, end)).map(drop)
}

/// What a stage's heat bath adds to a step: the mean over some steps in free flight. For a bath inside the step this is
/// the difference to the scene's method.
fn bath(bare: &Simulation, stage: &Stage) -> f64 {
    let Some(options) = &stage.thermostat else {
        return 0.0;
    };
    let noise = bare.streams.noise("thermostat");
    let method = || lennard_integrators::build(&bare.scene.integrator.method);
    let dt = bare.stage_run().dt;
    // Baths that act on some steps only are met on those and on others.
    const STEPS: u64 = 20;
    let time = |mut integrator: Integrator| {
        let mut state = bare.state.clone();
        let started = integrator.start(&bare.system, &mut state, &mut NoForces, dt, Want::NOTHING);
        let mut step =
            || integrator.step(&bare.system, &mut state, &mut NoForces, dt, Want::NOTHING);
        let (seconds, failed) = timed(|| started.is_err() || (0..STEPS).any(|_| step().is_err()));
        if failed { 0.0 } else { seconds / STEPS as f64 }
    };
    time(options.couple(method(), stage.temperature_ramp(0), noise)) - time(method())
}

/// Seconds that one frame of the trajectory takes without the disk.
fn frame(bare: &Simulation) -> f64 {
    let (extra, style, format) = (header(bare), style(bare), bare.scene.output.format);
    let frame = Frame { state: &bare.state, extra: &extra };
    let nowhere = Path::new("nowhere");
    let writer = TrajectoryWriter::to_sink(nowhere, format, &style, Box::new(Nowhere));
    writer.map_or(0.0, |mut writer| median(|| drop(writer.write(&frame))))
}

/// Takes everything and keeps nothing.
struct Nowhere;

impl Write for Nowhere {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Sink for Nowhere {
    fn cut_back(&mut self, _length: u64) -> io::Result<()> {
        Ok(())
    }
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
    fn is_still_at(&self, _path: &Path) -> bool {
        true
    }
}

/// The name of a stage's heat bath in the plan.
pub fn bath_name(stage: &Stage, thermostat: &str) -> String {
    format!("thermostat {thermostat} of {}", stage.name)
}

/// The name of a stage's barostat in the plan.
pub fn barostat_name(stage: &Stage, barostat: &str) -> String {
    format!("barostat {barostat} of {}", stage.name)
}

/// Bytes per particle that fused steps keep under a bath beside what they keep without one: positions, while forces wait.
const UNDER_A_BATH: u64 = 24;
/// A stage of so few steps takes none of them at once.
const FEW_STEPS: u64 = 3;

/// Bytes per particle that the fused steps of a scene keep under its baths beside what they keep without one.
pub(super) fn bytes_under_a_bath(scene: &Scene) -> u64 {
    let fuses = |stage: &Stage| stage.thermostat.is_some() && stage.steps > FEW_STEPS;
    if scene.stages.iter().any(fuses) { UNDER_A_BATH } else { 0 }
}

/// Bytes of what a checkpoint is put together in.
pub(super) fn checkpoint_bytes(bare: &Simulation) -> usize {
    let mut archive = StateArchive::default();
    Persist::save(bare, &mut archive.writer());
    archive.bytes()
}

// The first steps of a scene, taken until they tell how long a step takes.

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

#[cfg(test)]
mod tests;
