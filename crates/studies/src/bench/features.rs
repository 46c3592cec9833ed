//! What each feature of a scene costs when it is on, and that all of them off cost nothing.

use std::path::Path;

use lennard_core::{System, Want};
use lennard_engine::{
    Action, EngineError, Follower, Operation, Past, RunFiles, SET_ASIDE_EVERY, Schedule,
    Simulation, Trigger, Verdict, capture, watchdog,
};
use lennard_integrators::ThermostatOptions;
use lennard_observables::ObservableOptions;
use lennard_scene::{ObservableTable, Scene};
use serde::Serialize;

use super::blocks::{SETTLING, Start, take_wanting};
use super::clock::{Clock, tells_processor_time};
use super::variants::{Variant, in_shuffled_rounds};
use super::{BenchError, BenchOptions, Spread};
use crate::Progress;
use crate::jobs::pool;

/// Blocks of the bare loop and of the scene with everything off in each round, of which the best counts: their ratio is
/// to be known to a percent, on machines where one block is known to ten.
const BASE_BLOCKS: usize = 4;
/// Steps between two frames in the measurement.
const FRAMES_EVERY: u64 = 100;
/// Rows and thermodynamics where the scene does not say otherwise.
const NEVER: u64 = 1_000_000_000_000_000;
/// Seconds between two checkpoints where the scene does not say otherwise.
const CHECKPOINTS_EVERY: f64 = 600.0;
/// How often what is too short for a block is repeated.
const CALLS: u32 = 50;

/// One feature.
#[derive(Debug, Clone, Serialize)]
pub struct Feature {
    /// Its name.
    pub name: String,
    /// How often it is at work in this measurement.
    pub how: String,
    /// What it adds to a step in which everything is off, as a share of that step.
    pub share: Spread,
    /// The same in nanoseconds an atom and step.
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
    /// Force provider and integrator called by hand, nanoseconds an atom and step.
    pub bare_ns: Spread,
    /// The engine with every feature off, nanoseconds an atom and step.
    pub off_ns: Spread,
    /// What the engine adds to the bare loop, as a share of it.
    pub engine_share: Spread,
    /// The features.
    pub features: Vec<Feature>,
    /// What could not be measured, and why.
    pub left_out: Vec<String>,
}

/// What is on in a block.
enum On {
    /// No engine at all.
    Bare,
    /// The engine, and nothing asked for.
    Nothing,
    /// Something wanted of the forces at every step.
    Wanted(Want),
    /// A scene with one thing more.
    More(Box<Scene>),
    /// A scene whose rows or frames are written.
    Written(Box<Scene>),
}

/// Measures on as many threads as the variant has.
pub(super) fn measure(
    variant: &Variant,
    start: &Start,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<FeatureStudy, BenchError> {
    let (items, left_out) = items(&variant.scene, start);
    let base = [("bare", &On::Bare), ("off", &On::Nothing)];
    let blocks: Vec<(&str, &On)> = base
        .iter()
        .cycle()
        .take(2 * BASE_BLOCKS)
        .copied()
        .chain(items.iter().map(|(name, _, on)| (name.as_str(), on)))
        .collect();
    let pool = pool(variant.threads)?;
    let mut seconds: Vec<Vec<f64>> = blocks.iter().map(|_| Vec::new()).collect();
    in_shuffled_rounds(blocks.len(), options.repeats, |i, share| {
        let (name, on) = blocks[i];
        progress.update(name, 0.05 + 0.9 * share);
        let time = pool.install(|| block(on, &variant.scene, start, &options.scratch))?;
        seconds[i].push(time);
        Ok(())
    })?;
    let ns = 1e9 / (start.state.len() as f64 * start.steps as f64);
    let best = |first: usize, round: usize| {
        let of_round = (first..2 * BASE_BLOCKS)
            .step_by(2)
            .map(|i| seconds[i][round]);
        of_round.fold(f64::INFINITY, f64::min)
    };
    let rounds = 0..options.repeats;
    let (bare, off): (Vec<f64>, Vec<f64>) = rounds.map(|r| (best(0, r), best(1, r))).unzip();
    let off_ns = Spread::of(off.iter().map(|s| s * ns));
    let mut features: Vec<Feature> = items
        .iter()
        .zip(&seconds[2 * BASE_BLOCKS..])
        .map(|((name, how, _), all)| {
            let share = Spread::of(all.iter().zip(&off).map(|(s, off)| s / off - 1.0));
            Feature {
                name: name.clone(),
                how: how.clone(),
                share,
                ns: share.median * off_ns.median,
            }
        })
        .collect();
    let step = off_ns.median / ns / start.steps as f64;
    let singly = pool.install(|| called_singly(variant, start, options, step))?;
    features.extend(singly.into_iter().map(|(name, how, share)| Feature {
        name: name.into(),
        how,
        ns: share.median * off_ns.median,
        share,
    }));
    Ok(FeatureStudy {
        threads: variant.threads,
        steps: start.steps,
        clock: if tells_processor_time() {
            "processor time"
        } else {
            "wall clock"
        },
        bare_ns: Spread::of(bare.iter().map(|s| s * ns)),
        off_ns,
        engine_share: Spread::of(bare.iter().zip(&off).map(|(bare, off)| off / bare - 1.0)),
        features,
        left_out,
    })
}

/// Name, how often, and what is on, of everything that can be measured over a block; and what cannot.
fn items(scene: &Scene, start: &Start) -> (Vec<(String, String, On)>, Vec<String>) {
    let every_step = || "every step".to_owned();
    let mut items = vec![
        ("energy".to_owned(), every_step(), On::Wanted(Want::ENERGY)),
        (
            "energy and virial".into(),
            every_step(),
            On::Wanted(Want::ENERGY_AND_VIRIAL),
        ),
        (
            "energy, virial and Laplacian".into(),
            every_step(),
            On::Wanted(Want::TOTALS),
        ),
    ];
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        scene.output.thermo_every = NEVER;
        change(&mut scene);
        Box::new(scene)
    };
    for spec in lennard_integrators::thermostats() {
        let options: Result<ThermostatOptions, _> =
            toml::from_str(&format!("kind = \"{}\"", spec.name));
        if let Ok(options) = options {
            let scene = with(&|s| s.stages[0].thermostat = Some(options.clone()));
            items.push((
                format!("thermostat {}", spec.name),
                every_step(),
                On::More(scene),
            ));
        }
    }
    let mut left_out = Vec::new();
    let rows = scene.output.thermo_every;
    for options in ObservableOptions::all() {
        let name = options.name();
        let is_thermo = matches!(options, ObservableOptions::Thermodynamics(_));
        let every = if is_thermo {
            rows
        } else {
            options.default_every()
        };
        let scene = with(&|s| {
            s.stages[0].measure = true;
            if is_thermo {
                s.output.thermo_every = every;
            } else {
                s.observables = vec![ObservableTable {
                    every,
                    options: options.clone(),
                }];
            }
        });
        match start.simulation(&scene) {
            Ok(_) => items.push((
                name.to_owned(),
                format!("every {every} steps"),
                On::More(scene),
            )),
            Err(error) => left_out.push(format!("{name}: {error}")),
        }
    }
    items.push((
        "thermo.csv".into(),
        format!("a row every {rows} steps"),
        On::Written(with(&|s| s.output.thermo_every = rows)),
    ));
    items.push((
        "trajectory".into(),
        format!("a frame every {FRAMES_EVERY} steps"),
        On::Written(with(&|s| {
            s.output.trajectory_every = Some(FRAMES_EVERY);
            s.stages[0].measure = true;
        })),
    ));
    (items, left_out)
}

/// Seconds of a block, on the calling thread.
fn block(on: &On, scene: &Scene, start: &Start, scratch: &Path) -> Result<f64, BenchError> {
    let timed = |scene: &Scene, want: Want| -> Result<f64, BenchError> {
        let mut simulation = start.simulation(scene)?;
        let clock = Clock::start();
        take_wanting(&mut simulation, start.steps, want)?;
        Ok(clock.on_processor())
    };
    match on {
        On::Bare => bare(scene, start),
        On::Nothing => timed(scene, Want::NOTHING),
        On::Wanted(want) => timed(scene, *want),
        On::More(scene) => timed(scene, Want::NOTHING),
        On::Written(scene) => {
            let mut simulation = start.simulation(scene)?;
            let files = RunFiles::create(scratch, &simulation)?;
            let end = simulation.state.step + start.steps;
            let stop = Operation::new(Action::Call, Trigger::At(end));
            let schedule = Schedule::of_output(&simulation.scene).with(stop);
            let mut writing = Writing {
                files,
                schedule,
                end,
            };
            let clock = Clock::start();
            simulation.run(&mut writing)?;
            Ok(clock.on_processor())
        }
    }
}

/// The loop that everything else is compared with: a method and a force provider, and nothing else.
fn bare(scene: &Scene, start: &Start) -> Result<f64, BenchError> {
    let mut state = start.state.clone();
    let (_, mut forces) = lennard_engine::forces(scene, start.cell, state.len())?;
    let mut method = lennard_integrators::build(&scene.integrator.method);
    let system = System::atoms(state.len());
    let dt = scene.stage_dt(&scene.stages[0]);
    method.start(&system, &mut state, &mut forces, dt, Want::NOTHING)?;
    let mut steps = |count: u64| -> Result<(), BenchError> {
        let mut left = count;
        while left > 0 {
            let (taken, _) =
                method.stride(&system, &mut state, &mut forces, dt, left, Want::NOTHING)?;
            left -= taken;
        }
        Ok(())
    };
    steps(SETTLING)?;
    let clock = Clock::start();
    steps(start.steps)?;
    Ok(clock.on_processor())
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

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        let due = |action| self.schedule.does(action, simulation.state.step, true);
        let (row, frame) = (due(Action::Row), due(Action::Frame));
        if row {
            self.files.write_thermo(simulation)?;
        }
        if frame {
            self.files.write_frame(simulation)?;
        }
        Ok(if simulation.state.step == self.end {
            Verdict::Stop
        } else {
            Verdict::Continue
        })
    }
}

/// What is too rare or too short for a block: name, how often, and its share of a step of so many seconds.
fn called_singly(
    variant: &Variant,
    start: &Start,
    options: &BenchOptions,
    step: f64,
) -> Result<Vec<(&'static str, String, Spread)>, BenchError> {
    let simulation = start.simulation(&variant.scene)?;
    let dt = variant.scene.stage_dt(&variant.scene.stages[0]);
    let mut aside = simulation.state.clone();
    let (mut watching, mut saving) = (Vec::new(), Vec::new());
    for _ in 0..options.repeats {
        let clock = Clock::start();
        for _ in 0..CALLS {
            let _ = watchdog::check_speeds(&simulation.state, dt);
        }
        let look = clock.on_processor() / f64::from(CALLS);
        let clock = Clock::start();
        for _ in 0..CALLS {
            aside.positions.clone_from(&simulation.state.positions);
            aside.velocities.clone_from(&simulation.state.velocities);
        }
        let copy = clock.on_processor() / f64::from(CALLS);
        let clock = Clock::start();
        for _ in 0..CALLS {
            let _ = simulation.force_check.look(&simulation.state);
        }
        let check = clock.on_processor() / f64::from(CALLS);
        let a_step = look / watchdog::EVERY as f64
            + copy / SET_ASIDE_EVERY as f64
            + check / watchdog::LISTS_EVERY as f64;
        watching.push(a_step / step);
        // To the disk and back: here the clock on the wall counts.
        let clock = Clock::start();
        let files = RunFiles::create(&options.scratch, &simulation)?;
        let checkpoint = capture(&simulation, files.marks(), &Past::default());
        let path = options.scratch.join("checkpoint-000000000000.lennard");
        lennard_io::write_checkpoint(&path, &checkpoint).map_err(EngineError::from)?;
        saving.push(clock.wall() / CHECKPOINTS_EVERY);
    }
    let watched = watchdog::what_is_done();
    let saved = Spread::of(saving);
    let saved_how = format!(
        "one each {CHECKPOINTS_EVERY:.0} s, {:.1} ms each with its disk",
        1e3 * CHECKPOINTS_EVERY * saved.median
    );
    Ok(vec![
        ("watchdog (always on)", watched, Spread::of(watching)),
        ("checkpoints", saved_how, saved),
    ])
}
