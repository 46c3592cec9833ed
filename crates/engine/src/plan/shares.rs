//! What each part of a run costs: a short measurement, which decides nothing.

mod first_steps;
mod memory;
mod names;

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use lennard_core::stopwatch::{Spread, Stopwatch, repeated, timed};
use lennard_core::{Configuration, HaloSize, Integrator, NoForces, Part, Want};
use lennard_io::{Frame, Sink, TrajectoryWriter};
use lennard_scene::{Scene, Stage};

use crate::bare::bare;
use crate::beginning::Beginning;
use crate::build::prepare_from;
use crate::failure::LARGEST_MOVE;
use crate::files::{header, style};
use crate::follower::StopAt;
use crate::planar_tail::PlanarTail;
use crate::run::{aside, set_aside};
use crate::schedule::{Action, Observer, Operation, Schedule, Trigger};
use crate::simulation::Simulation;
use crate::{EngineError, SET_ASIDE_EVERY, watchdog};

use self::first_steps::FirstSteps;
use self::memory::{bytes_under_a_bath, checkpoint_bytes};
pub use first_steps::PATIENCE;
pub(super) use names::{barostat_name, bath_name};

/// How long one part is measured alone.
const PART_FOR: Duration = Duration::from_millis(30);
/// Calls of a part that is measured alone, at most.
const CALLS: usize = 9;
/// Calls of a part of the watchdog in one measurement.
const WATCHING_CALLS: u32 = 50;

/// Seconds of each part, for one call or one step.
pub(super) struct Costs {
    /// Steps in the measurement.
    pub(super) steps: u64,
    /// A step with everything off, mean; `None` where steps are too slow to measure.
    pub(super) step: Option<f64>,
    /// The same, median.
    pub(super) median_step: f64,
    /// Pair loops of such a step.
    force: f64,
    /// List building of such a step.
    neighbor: f64,
    /// A planar tail of such a step; 0 without one.
    tail: f64,
    /// Bytes that the forces hold; fused steps are included where the scene has steps without an observer.
    pub(super) force_bytes: u64,
    /// Bytes of what a checkpoint is put together in.
    pub(super) checkpoint_bytes: usize,
    /// An evaluation with energy and virial.
    evaluation: f64,
    /// What energy and virial add to an evaluation.
    totals: f64,
    /// What the Laplacian adds to that.
    laplacian: f64,
    /// What observers want beyond that adds to it: the tensor of the virial, or entries of single particles.
    beyond_totals: f64,
    thermodynamics: f64,
    /// What each observable wants of the forces, and a sample of it.
    observers: Vec<(Want, f64)>,
    baths: Vec<f64>,
    frame: f64,
    watch: f64,
    /// Builds of the list in such a step, and what a rank would need of others, by the number of ranks.
    pub(super) builds: f64,
    pub(super) halos: Vec<(usize, HaloSize)>,
}

impl Costs {
    /// Measures at the start of a scene, after some of its steps.
    pub(super) fn measure(
        simulation: &mut Simulation,
        ranks: &[usize],
    ) -> Result<Self, EngineError> {
        let mut bare = with_everything_off(simulation)?;
        let mut measured = FirstSteps::from(Instant::now());
        bare.follow(&mut measured)?;
        let (first, last) = (measured.first.unwrap_or_default(), bare.forces.statistics());
        let halo = |n: &usize| Some((*n, bare.forces.halo_on(*n)?));
        let halos = ranks.iter().filter_map(halo).collect();
        let (step, times) = (measured.mean(), measured.seconds);
        let all = times.len().max(1) as f64;
        let evaluate = |bare: &mut Simulation, want| -> Result<f64, EngineError> {
            let mut fault = None;
            let time = median(|| {
                let at = Configuration::at_rest(&bare.state.cell, &bare.state.positions);
                let forces = &mut bare.state.forces;
                match bare.forces.evaluate(at, Part::All, want, forces) {
                    Ok(found) => bare.state.energetics = found,
                    Err(error) => fault = Some(error),
                }
            });
            fault.map_or(Ok(time), |e| Err(bare.failed(e.into())))
        };
        let tail = PlanarTail::of(&bare.scene, &bare.state.cell).map_or(0.0, |tail| {
            let mut forces = bare.state.forces.clone();
            median(|| drop(tail.push(&bare.state.cell, &bare.state.positions, &mut forces)))
        });
        let forces = evaluate(&mut bare, Want::NOTHING)?;
        let energies = evaluate(&mut bare, Want::ENERGY_AND_VIRIAL)?;
        let laplacian = evaluate(&mut bare, Want::TOTALS)?;
        // Measured only where an observer asks: on a large system it takes memory. It also leaves what observers look at.
        let wants = simulation.observers.iter().map(|o| o.observable.want());
        let wanted = wants.fold(Want::TOTALS, |all, want| all | want);
        let beyond_totals =
            if is_beyond_totals(wanted) { evaluate(&mut bare, wanted)? - laplacian } else { 0.0 };
        let view = bare.view();
        let observers = simulation.observers.iter_mut();
        let sampled = |o: &mut Observer| median(|| o.observable.sample(&view));
        let mut observers = observers.map(|o| (o.observable.want(), sampled(o)));
        // The first is thermodynamics, whose wishes are parts of the plan by themselves.
        let thermodynamics = observers.next().map_or(0.0, |(_, cost)| cost);
        let observers = observers.collect();
        take_steps_unseen(&mut bare, simulation)?;
        let stages = simulation.scene.stages.iter();
        let baths = stages.map(|stage| bath(&bare, stage)).collect();
        let under_a_bath = bytes_under_a_bath(&simulation.scene) * bare.state.len() as u64;
        Ok(Self {
            steps: times.len() as u64,
            step,
            median_step: Spread::of(times).map_or(f64::NAN, |steps| steps.median),
            force: (last.force_seconds - first.force_seconds) / all,
            neighbor: (last.neighbor_seconds - first.neighbor_seconds) / all,
            tail,
            force_bytes: bare.forces.statistics().bytes + under_a_bath,
            checkpoint_bytes: checkpoint_bytes(&bare),
            evaluation: energies,
            totals: energies - forces,
            laplacian: laplacian - energies,
            beyond_totals,
            thermodynamics,
            observers,
            baths,
            frame: frame(&bare),
            watch: watching_seconds(&bare),
            builds: (last.builds - first.builds) as f64 / all,
            halos,
        })
    }

    /// Seconds of each part in the whole run, by the part's name in the plan; `None` where steps are too slow to measure.
    pub(super) fn of_run(&self, scene: &Scene) -> Option<BTreeMap<String, f64>> {
        let step = self.step?;
        let mut parts: BTreeMap<String, f64> = BTreeMap::new();
        let mut add = |part: &str, seconds: f64| {
            // Differences of two measurements may come out below nothing.
            *parts.entry(part.to_owned()).or_default() += seconds.max(0.0);
        };
        let rows = scene.output.thermo_every;
        for (stage, bath) in scene.stages.iter().zip(&self.baths) {
            let steps = stage.steps as f64;
            add("pair forces", steps * self.force);
            add("neighbor list", steps * self.neighbor);
            add("integrator", steps * (step - self.force - self.neighbor - self.tail - self.watch));
            if self.tail > 0.0 {
                add("tail correction", steps * self.tail);
            }
            add("watchdog", steps * self.watch);
            add("energy and virial", steps / rows as f64 * self.totals);
            if let Some(thermostat) = &stage.thermostat {
                add(&bath_name(stage, thermostat.name()), steps * bath);
            }
            if let Some(control) = &stage.barostat {
                let changes = steps / control.options.interval() as f64;
                let name = barostat_name(stage, control.options.name());
                // The step before it asks for energy and virial too.
                let evaluations = control.options.evaluations() as f64;
                add(&name, changes * (evaluations * self.evaluation + self.totals));
            }
            if !stage.measure {
                continue;
            }
            add("configurational temperature", steps / rows as f64 * self.laplacian);
            add("thermodynamics", steps / rows as f64 * self.thermodynamics);
            let others = scene.observables.iter().filter(|o| o.options.name() != "thermodynamics");
            for (table, (want, cost)) in others.zip(&self.observers) {
                let samples = steps / table.every as f64;
                let wanted = self.wanted(*want, alone(table.every, rows));
                add(table.options.name(), samples * (cost + wanted));
            }
            if let Some(every) = scene.output.trajectory_every {
                let wanted = self.wanted(Want::ENERGY_AND_VIRIAL, alone(every, rows));
                add("trajectory", steps / every as f64 * (self.frame + wanted));
            }
        }
        Some(parts)
    }

    /// Seconds that `want` costs at the forces, where a share `alone` of the steps has no other reason to compute totals.
    fn wanted(&self, want: Want, alone: f64) -> f64 {
        let totals = if want.is_nothing() { 0.0 } else { alone * self.totals.max(0.0) };
        let beyond = if is_beyond_totals(want) { self.beyond_totals.max(0.0) } else { 0.0 };
        totals + beyond
    }
}

/// Whether an evaluation with totals alone does not give what is wanted.
fn is_beyond_totals(want: Want) -> bool {
    want | Want::TOTALS != Want::TOTALS
}

/// The share of the steps due every so often on which no row of thermo.csv is due, which has energy and virial computed.
fn alone(every: u64, rows: u64) -> f64 {
    1.0 - gcd(every, rows) as f64 / rows as f64
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The median time of a call, s.
fn median(call: impl FnMut()) -> f64 {
    repeated(PART_FOR, CALLS, call).median
}

/// Seconds that the watchdog takes per step, on the clock of the calling thread. It checks speeds and single forces,
/// and copies the state that it goes back to.
#[must_use]
pub fn watching_seconds(simulation: &Simulation) -> f64 {
    let state = &simulation.state;
    let per_call = |call: &mut dyn FnMut()| {
        let watch = Stopwatch::start();
        (0..WATCHING_CALLS).for_each(|_| call());
        watch.on_processor() / f64::from(WATCHING_CALLS)
    };
    let dt = simulation.stage_run().dt;
    let mut before = aside(state);
    per_call(&mut || drop(watchdog::check_speeds(state, dt, LARGEST_MOVE))) / watchdog::EVERY as f64
        + per_call(&mut || drop(simulation.force_check.look(state, |_| lennard_core::DVec3::ZERO)))
            / watchdog::LISTS_EVERY as f64
        + per_call(&mut || set_aside(state, &mut before)) / SET_ASIDE_EVERY as f64
}

/// The same particles with everything off.
fn with_everything_off(simulation: &Simulation) -> Result<Simulation, EngineError> {
    let beginning = Beginning {
        cell: simulation.state.cell,
        positions: simulation.state.positions.clone(),
        velocities: Some(simulation.state.velocities.clone()),
        species: simulation.system.species().clone(),
        relax: false,
    };
    prepare_from(bare(&simulation.scene), beginning)
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

/// Formatting one frame, without the disk.
fn frame(bare: &Simulation) -> f64 {
    let extra = header(bare);
    let frame = Frame { state: &bare.state, extra: &extra };
    let nowhere = Path::new("nowhere");
    let format = bare.scene.output.format;
    match TrajectoryWriter::to_sink(nowhere, format, &style(bare), Box::new(Nowhere)) {
        Ok(mut writer) => median(|| drop(writer.write(&frame))),
        Err(_) => 0.0,
    }
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

#[cfg(test)]
mod tests;
