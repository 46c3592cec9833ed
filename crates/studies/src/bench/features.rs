//! What each feature of a scene costs when it is on, and that all of them off cost nothing.

use std::ops::ControlFlow;
use std::path::Path;

use lennard_core::Want;
use lennard_core::stopwatch::{Spread, Stopwatch, timed};
use lennard_engine::{
    Action, ENDLESS, EngineError, Follower, Operation, Past, RunFiles, Schedule, Simulation,
    Trigger, capture, take, watchdog, watching_seconds,
};
use lennard_integrators::{BarostatOptions, ThermostatOptions};
use lennard_observables::ObservableOptions;
use lennard_scene::{ObservableTable, PressureControl, Scene};
use serde::Serialize;

use super::blocks::{Blocks, SETTLING, clock_name, in_turns, spread};
use super::variants::Variant;
use super::{BenchError, BenchOptions};
use crate::Progress;
use crate::jobs::pool;
use crate::lab::Rig;

/// Blocks of the bare loop, and of the engine with everything off, in each round. The best counts for their ratio, which must be
/// known to a per cent, on machines where one block is known to ten. Features are compared with the median.
const BASE_BLOCKS: usize = 4;
/// Steps between two frames in the measurement.
const FRAMES_EVERY: u64 = 100;
/// Seconds between two checkpoints where the scene does not say otherwise.
const CHECKPOINTS_EVERY: f64 = 600.0;

/// One feature.
#[derive(Debug, Clone, Serialize)]
pub struct Feature {
    /// Its name.
    pub name: String,
    /// How often the feature is at work in this measurement.
    pub how: String,
    /// The time that it adds to a step, as a share of a step with everything off.
    pub share: Spread,
    /// The time that it adds, in nanoseconds per particle and step.
    pub ns: f64,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct FeatureStudy {
    /// Threads.
    pub threads: usize,
    /// Steps of a block.
    pub steps: u64,
    /// What was read: `processor time`, or `wall clock` where the system does not tell.
    pub clock: &'static str,
    /// Force provider and integrator called by hand, nanoseconds per particle and step.
    pub bare_ns: Spread,
    /// The engine with every feature off, nanoseconds per particle and step.
    pub off_ns: Spread,
    /// What the engine adds to the bare loop, as a share of it.
    pub engine_share: Spread,
    /// The features.
    pub features: Vec<Feature>,
    /// What could not be measured, and why.
    pub left_out: Vec<String>,
}

/// A feature that is measured over a block.
struct Item {
    name: String,
    how: String,
    on: On,
}

/// What is on in a block.
enum On {
    /// No engine at all.
    Bare,
    /// The engine, and something that is wanted of the forces on every step.
    Wanted(Want),
    /// A scene with one thing more.
    More(Box<Scene>),
    /// A scene whose rows or frames are written.
    Written(Box<Scene>),
}

/// Measures on as many threads as the variant has.
pub(super) fn measure(
    variant: &Variant,
    blocks: &Blocks,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<FeatureStudy, BenchError> {
    let (mut items, left_out) = items(&variant.scene, blocks);
    let features = items.len();
    for _ in 0..BASE_BLOCKS {
        items.push(item("bare", "", On::Bare));
        items.push(item("off", "", On::Wanted(Want::NOTHING)));
    }
    let labels: Vec<String> = items.iter().map(|item| item.name.clone()).collect();
    let pool = pool(variant.threads)?;
    let seconds = in_turns(&labels, options, progress, |i| {
        pool.install(|| block(&items[i].on, &variant.scene, blocks, &options.scratch))
    })?;
    // In each round, the blocks from `first` on, every second one.
    let in_rounds = |first: usize, of: &dyn Fn(Spread) -> f64| -> Vec<f64> {
        let base = &seconds[features + first..];
        let of_round = |round: usize| base.iter().step_by(2).map(move |s| s[round]);
        (0..options.repeats).map(|round| of(spread(of_round(round)))).collect()
    };
    let (bare, off) = (in_rounds(0, &|s| s.lowest), in_rounds(1, &|s| s.lowest));
    // A feature has one block in each round. Beside the best of several, it would seem to cost what blocks differ by.
    let usual = in_rounds(1, &|s| s.median);
    let shares = |seconds: &[f64], base: &[f64]| {
        spread(seconds.iter().zip(base).map(|(s, base)| s / base - 1.0))
    };
    let ns = |seconds: &[f64]| spread(seconds.iter().copied()).scaled(blocks.ns_per_second());
    let off_ns = ns(&off);
    let feature = |name: String, how: String, share: Spread| Feature {
        name,
        how,
        ns: share.median * off_ns.median,
        share,
    };
    let over_blocks = items[..features].iter().zip(&seconds);
    let mut found: Vec<Feature> = over_blocks
        .map(|(item, s)| feature(item.name.clone(), item.how.clone(), shares(s, &usual)))
        .collect();
    let step = spread(off.iter().copied()).median / blocks.steps as f64;
    let singly = pool.install(|| called_singly(&variant.scene, blocks, options, step))?;
    let singly = singly.into_iter();
    found.extend(singly.map(|(name, how, share)| feature(name.into(), how, share)));
    Ok(FeatureStudy {
        threads: variant.threads,
        steps: blocks.steps,
        clock: clock_name(Stopwatch::tells_processor_time()),
        bare_ns: ns(&bare),
        off_ns,
        engine_share: shares(&off, &bare),
        features: found,
        left_out,
    })
}

/// The thermostat beside a barostat that takes any.
const BATH_OF_BAROSTATS: &str = "bussi";

fn item(name: impl Into<String>, how: impl Into<String>, on: On) -> Item {
    let (name, how) = (name.into(), how.into());
    Item { name, how, on }
}

/// Makes the scene that a change leaves.
type Changed<'a> = dyn Fn(&dyn Fn(&mut Scene)) -> Box<Scene> + 'a;

/// Each barostat with the thermostat that it goes with, so slow that the box hardly changes.
fn barostats(scene: &Scene, with: &Changed<'_>) -> Vec<Item> {
    const SLOWEST: &str = "tau = 1e6";
    let specs = lennard_integrators::barostats().iter();
    let items = specs.filter_map(|spec| {
        let bath = spec.thermostat.unwrap_or(BATH_OF_BAROSTATS);
        let thermostat: ThermostatOptions = toml::from_str(&format!("kind = \"{bath}\"")).ok()?;
        let text = format!("kind = \"{}\"\n{SLOWEST}", spec.name);
        let options: BarostatOptions = toml::from_str(&text).ok()?;
        let control =
            PressureControl { pressure: scene.system.temperature, pressure_from: None, options };
        let how = format!("every {} steps, with {bath}", control.options.interval());
        let on = with(&|s| {
            s.stages[0].thermostat = Some(thermostat.clone());
            s.stages[0].barostat = Some(control.clone());
        });
        Some(item(format!("barostat {}", spec.name), how, On::More(on)))
    });
    items.collect()
}

/// Everything that can be measured over a block; and what cannot, with the reason.
fn items(scene: &Scene, blocks: &Blocks) -> (Vec<Item>, Vec<String>) {
    const EVERY_STEP: &str = "every step";
    let rows = scene.output.thermo_every;
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        scene.output.thermo_every = ENDLESS;
        // A bath of another temperature would change the fluid, and with it the time between two builds of a list.
        scene.stages[0].temperature = blocks.temperature();
        change(&mut scene);
        Box::new(scene)
    };
    let wants = [
        ("energy", Want::ENERGY),
        ("energy and virial", Want::ENERGY_AND_VIRIAL),
        ("energy, virial and Laplacian", Want::TOTALS),
    ];
    let mut items: Vec<Item> =
        wants.map(|(name, want)| item(name, EVERY_STEP, On::Wanted(want))).into();
    for spec in lennard_integrators::thermostats() {
        // A bath that may act every so many steps acts in each.
        let options = ["\nevery = 1", ""].into_iter().find_map(|more| {
            toml::from_str::<ThermostatOptions>(&format!("kind = \"{}\"{more}", spec.name)).ok()
        });
        if let Some(options) = options {
            let scene = with(&|s| s.stages[0].thermostat = Some(options.clone()));
            let name = format!("thermostat {}", spec.name);
            items.push(item(name, EVERY_STEP, On::More(scene)));
        }
    }
    items.extend(barostats(scene, &with));
    let mut left_out = Vec::new();
    for options in ObservableOptions::all() {
        let is_thermo = matches!(options, ObservableOptions::Thermodynamics(_));
        let every = if is_thermo { rows } else { options.default_every() };
        let scene = with(&|s| {
            s.stages[0].measure = true;
            if is_thermo {
                s.output.thermo_every = every;
            } else {
                let options = options.clone();
                s.observables = vec![ObservableTable { every, options }];
            }
        });
        let name = options.name();
        match blocks.simulation(&scene) {
            Ok(_) => items.push(item(name, format!("every {every} steps"), On::More(scene))),
            Err(error) => left_out.push(format!("{name}: {error}")),
        }
    }
    items.push(item(
        "thermo.csv",
        format!("a row every {rows} steps"),
        On::Written(with(&|s| s.output.thermo_every = rows)),
    ));
    items.push(item(
        "trajectory",
        format!("a frame every {FRAMES_EVERY} steps"),
        On::Written(with(&|s| {
            s.output.trajectory_every = Some(FRAMES_EVERY);
            s.stages[0].measure = true;
        })),
    ));
    (items, left_out)
}

/// Seconds of a block that the calling thread was on a processor.
fn block(on: &On, scene: &Scene, blocks: &Blocks, scratch: &Path) -> Result<f64, BenchError> {
    let taken = |scene: &Scene, want: Want| -> Result<f64, BenchError> {
        let mut simulation = blocks.simulation(scene)?;
        let watch = Stopwatch::start();
        take(&mut simulation, blocks.steps, want)?;
        Ok(watch.on_processor())
    };
    match on {
        On::Bare => {
            let start = &blocks.start;
            let method = lennard_integrators::build(&scene.integrator.method);
            let at = (start.system(), start.state());
            let dt = scene.stage_dt(&scene.stages[0]);
            let forces = Box::new(start.forces(scene)?);
            let mut fluid = Rig::start(method, at, forces, dt, Want::NOTHING)?;
            fluid.steps(SETTLING)?;
            let watch = Stopwatch::start();
            fluid.steps(blocks.steps)?;
            Ok(watch.on_processor())
        }
        On::Wanted(want) => taken(scene, *want),
        On::More(scene) => taken(scene, Want::NOTHING),
        On::Written(scene) => {
            let mut simulation = blocks.simulation(scene)?;
            let files = RunFiles::create(scratch, &simulation)?;
            let end = simulation.state.step + blocks.steps;
            let stop = Operation::new(Action::Call, Trigger::At(end));
            let schedule = Schedule::of_output(&simulation.scene).with(stop);
            let mut writing = Writing { files, schedule, end };
            let watch = Stopwatch::start();
            simulation.run(&mut writing)?;
            Ok(watch.on_processor())
        }
    }
}

/// Writes rows and frames as a run does.
struct Writing {
    files: RunFiles,
    schedule: Schedule,
    end: u64,
}

impl Follower for Writing {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let due = |action| self.schedule.does(action, simulation.state.step, true);
        let (row, frame) = (due(Action::Row), due(Action::Frame));
        if row {
            self.files.write_thermo(simulation)?;
        }
        if frame {
            self.files.write_frame(simulation)?;
        }
        Ok(if simulation.state.step == self.end {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    }
}

/// What is too rare or too short for a block: name, how often, and its share of a step of `step` seconds.
fn called_singly(
    scene: &Scene,
    blocks: &Blocks,
    options: &BenchOptions,
    step: f64,
) -> Result<[(&'static str, String, Spread); 2], BenchError> {
    let simulation = blocks.simulation(scene)?;
    let (mut watching, mut saving) = (Vec::new(), Vec::new());
    for _ in 0..options.repeats {
        watching.push(watching_seconds(&simulation) / step);
        // To the disk and back: here the clock on the wall counts.
        let (seconds, saved) = timed(|| save(&simulation, &options.scratch));
        saved?;
        saving.push(seconds / CHECKPOINTS_EVERY);
    }
    let saved = spread(saving);
    let saved_how = format!(
        "one each {CHECKPOINTS_EVERY:.0} s, {:.1} ms each with its disk",
        1e3 * CHECKPOINTS_EVERY * saved.median
    );
    let watched = watchdog::what_is_done();
    Ok([("watchdog (always on)", watched, spread(watching)), ("checkpoints", saved_how, saved)])
}

/// Writes a checkpoint as a run does.
fn save(simulation: &Simulation, folder: &Path) -> Result<(), EngineError> {
    let files = RunFiles::create(folder, simulation)?;
    let checkpoint = capture(simulation, files.marks(), &Past::default());
    let path = folder.join("checkpoint-000000000000.lennard");
    Ok(lennard_io::write_checkpoint(&path, &checkpoint)?)
}
