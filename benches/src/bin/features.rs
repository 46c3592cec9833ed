//! Measures on one thread how much each feature of a scene costs, and how much the engine with everything off adds to a bare loop:
//! `features [SCENE] [key=value ...]` with the keys `isa`, `precision`, `atoms`, `cutoff` and `repeats`.
//!
//! Every block of steps starts from the same state, and each round shuffles the order of the blocks. Time is counted by
//! the clock of the processor, where the system tells it.

use std::error::Error;
use std::io::{Write, stdout};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use lennard_benches::arguments::{Arguments, exit_code};
use lennard_core::Want;
use lennard_engine::stopwatch::{Spread, Stopwatch, in_turn, timed};
use lennard_engine::{
    Action, ENDLESS, EngineError, Follower, Operation, Past, RunFiles, Schedule, Simulation,
    Trigger, bare, capture, take, watchdog, watching_seconds,
};
use lennard_observables::ObservableOptions;
use lennard_scene::{Scene, shipped};
use lennard_studies::lab::{Rig, Start};

/// Keys that replace a key of the scene.
const OF_SCENE: [(&str, &str); 4] = [
    ("isa", "kernel.isa"),
    ("precision", "kernel.precision"),
    ("atoms", "system.n_atoms"),
    ("cutoff", "truncation.r_cut"),
];
/// The scene that runs where none is named.
const MELT: &str = "bench/melt-32k";
/// Blocks of the loop by hand, and of the engine with everything off, in each round. The best counts for their ratio, which must be
/// known to a per cent, on machines where one block is known to ten. Features are compared with the median.
const BASE_BLOCKS: usize = 4;
/// Steps to a state in which a lattice has melted, how long they may take, and seconds of a block.
const WARM: (u64, Duration, f64) = (300, Duration::from_secs(5), 0.1);
/// Steps between two frames in the measurement.
const FRAMES_EVERY: u64 = 100;
/// Seconds between two checkpoints where the scene does not say otherwise.
const CHECKPOINTS_EVERY: f64 = 600.0;

/// An error that may leave the thread that found it.
type Failure = Box<dyn Error + Send + Sync>;
/// Keys of a scene with their values, as `--set` takes them.
type Overrides = Vec<(String, String)>;

/// A row: the engine with these keys over everything off, with something wanted of the forces at each step.
struct Row {
    name: String,
    how: String,
    overrides: Overrides,
    want: Want,
    is_measured: bool,
    is_written: bool,
}

impl Row {
    fn new(name: impl Into<String>, how: impl Into<String>, overrides: &[(&str, String)]) -> Self {
        let owned = |(key, value): &(&str, String)| ((*key).to_owned(), value.clone());
        Self {
            name: name.into(),
            how: how.into(),
            overrides: overrides.iter().map(owned).collect(),
            want: Want::NOTHING,
            is_measured: false,
            is_written: false,
        }
    }
}

/// Everything that a scene can have on, each alone.
fn rows(scene: &Scene) -> Vec<Row> {
    const EVERY_STEP: &str = "every step";
    let rows = scene.output.thermo_every;
    let mut all: Vec<Row> = [
        ("energy", Want::ENERGY),
        ("energy and virial", Want::ENERGY_AND_VIRIAL),
        ("energy, virial and Laplacian", Want::TOTALS),
    ]
    .map(|(name, want)| Row { want, ..Row::new(name, EVERY_STEP, &[]) })
    .into();
    for spec in lennard_integrators::thermostats() {
        // `rescale` may act every so many steps: here it acts in each.
        let every = if spec.name == "rescale" { ", every = 1" } else { "" };
        let bath = format!("{{ kind = \"{}\"{every} }}", spec.name);
        let name = format!("thermostat {}", spec.name);
        all.push(Row::new(name, EVERY_STEP, &[("stage.0.thermostat", bath)]));
    }
    for spec in lennard_integrators::barostats() {
        // So slow that the box hardly changes.
        let control = format!(
            "{{ kind = \"{}\", tau = 1e6, pressure = {:?} }}",
            spec.name, scene.system.temperature
        );
        let bath = format!("\"{}\"", spec.thermostat.unwrap_or("bussi"));
        let keys = [("stage.0.thermostat", bath), ("stage.0.barostat", control)];
        all.push(Row::new(format!("barostat {}", spec.name), "with its thermostat", &keys));
    }
    for options in ObservableOptions::all() {
        let (every, key) = match options {
            ObservableOptions::Thermodynamics(_) => {
                (rows, ("output.thermo_every", rows.to_string()))
            }
            _ => {
                let every = options.spec().every;
                let table = format!("[{{ kind = \"{}\", every = {every} }}]", options.name());
                (every, ("observable", table))
            }
        };
        let how = format!("every {every} steps");
        all.push(Row { is_measured: true, ..Row::new(options.name(), how, &[key]) });
    }
    all.push(Row {
        is_written: true,
        ..Row::new(
            "thermo.csv",
            format!("a row every {rows} steps"),
            &[("output.thermo_every", rows.to_string())],
        )
    });
    all.push(Row {
        is_measured: true,
        is_written: true,
        ..Row::new(
            "trajectory",
            format!("a frame every {FRAMES_EVERY} steps"),
            &[("output.trajectory_every", FRAMES_EVERY.to_string())],
        )
    });
    all
}

fn main() -> ExitCode {
    exit_code(features())
}

fn features() -> Result<(), Box<dyn Error>> {
    let keys: Vec<&str> = OF_SCENE.iter().map(|(key, _)| *key).collect();
    let keys = [keys.as_slice(), &["repeats"]].concat();
    let given = Arguments::read(std::env::args().skip(1), &keys)?;
    let repeats = given.number("repeats", 1)?.unwrap_or(7);
    let settings: Overrides = OF_SCENE
        .iter()
        .filter_map(|(key, of_scene)| Some(((*of_scene).into(), given.value(key)?.into())))
        .collect();
    let file = shipped::locate(Path::new(given.word(0).unwrap_or(MELT)));
    let scene = Scene::load(&file, &settings)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| measure(&scene, repeats)).map_err(|error| error as Box<dyn Error>)
}

/// What is timed.
enum Timed<'a> {
    ByHand,
    Engine(&'a Scene, Want, bool),
}

fn measure(scene: &Scene, repeats: usize) -> Result<(), Failure> {
    let off = bare(scene);
    let (warm_steps, warm_for, block_seconds) = WARM;
    let (start, step) = Start::warmed(off.clone(), warm_steps, warm_for)?;
    let bench = Bench { start, steps: ((block_seconds / step) as u64).clamp(20, 20_000) };
    let text = off.resolved_toml();
    let still = ("output.thermo_every".to_owned(), ENDLESS.to_string());
    // A bath of another temperature would change the fluid, and with it the time between two builds of a list.
    let held = ("stage.0.temperature".to_owned(), format!("{:?}", bench.start.temperature()));
    let (mut on, mut left_out) = (Vec::new(), Vec::new());
    for row in rows(scene) {
        // A reader wants a measured stage; what is not measured is told after it.
        let mut overrides = vec![still.clone(), ("stage.0.measure".into(), "true".into())];
        if row.overrides.iter().any(|(key, _)| key == "stage.0.thermostat") {
            overrides.push(held.clone());
        }
        overrides.extend(row.overrides.clone());
        let with = Scene::parse(&text, "everything off", &overrides).map_err(EngineError::from);
        let settled = with.and_then(|mut with| {
            with.stages[0].measure = row.is_measured;
            bench.start.settled(with.clone()).map(|_| with)
        });
        match settled {
            Ok(with) => on.push((row, with)),
            Err(error) => left_out.push(format!("{}: {error}", row.name).replace('\n', ";")),
        }
    }
    let mut items: Vec<Timed<'_>> =
        on.iter().map(|(row, with)| Timed::Engine(with, row.want, row.is_written)).collect();
    for _ in 0..BASE_BLOCKS {
        items.extend([Timed::ByHand, Timed::Engine(&off, Want::NOTHING, false)]);
    }
    let scratch = std::env::temp_dir().join(format!("lennard-features-{}", std::process::id()));
    std::fs::create_dir_all(&scratch)?;
    let mut seconds = vec![vec![0.0; repeats]; items.len()];
    let timed = in_turn(items.len(), repeats, 1, |turn| -> Result<(), Failure> {
        seconds[turn.item][turn.round] = bench.block(&items[turn.item], &off, &scratch)?;
        Ok(())
    });
    let singly = timed.and_then(|()| bench.called_singly(&off, repeats, &scratch));
    std::fs::remove_dir_all(&scratch)?;
    let [watching, saving] = singly?;

    // In each round, the blocks from `first` on, every second one.
    let in_rounds = |first: usize, of: &dyn Fn(Spread) -> f64| -> Vec<f64> {
        let base = &seconds[on.len() + first..];
        let of_round = |round: usize| base.iter().step_by(2).map(move |s| s[round]);
        (0..repeats).map(|round| of(spread(of_round(round)))).collect()
    };
    let (by_hand, engine) = (in_rounds(0, &|s| s.lowest), in_rounds(1, &|s| s.lowest));
    // A feature has one block in each round. Beside the best of several, it would seem to cost what blocks differ by.
    let usual = in_rounds(1, &|s| s.median);
    let share = |of: &[f64], base: &[f64]| spread(of.iter().zip(base).map(|(s, b)| s / b - 1.0));
    let step = spread(engine.iter().copied()).median / bench.steps as f64;
    let ns = 1e9 / bench.start.positions.len() as f64;
    let mut to = stdout().lock();
    writeln!(
        to,
        "{}: {} particles, {} steps a block, {repeats} rounds; {:.1} ns a particle and step with everything off",
        scene.name,
        bench.start.positions.len(),
        bench.steps,
        ns * step
    )?;
    let mut tell = |name: &str, how: &str, share: Spread| {
        writeln!(
            to,
            "{name:<34} {:>7.1} % ({:.1} to {:.1}), {:.2} ns: {how}",
            100.0 * share.median,
            100.0 * share.lowest,
            100.0 * share.highest,
            ns * step * share.median
        )
    };
    tell("engine", "with everything off, over the loop by hand", share(&engine, &by_hand))?;
    for ((row, _), seconds) in on.iter().zip(&seconds) {
        tell(&row.name, &row.how, share(seconds, &usual))?;
    }
    let over = |seconds: Vec<f64>, each: f64| spread(seconds.into_iter().map(|s| s / each));
    tell("watchdog (always on)", &watchdog::what_is_done(), over(watching, step))?;
    let how = format!("one each {CHECKPOINTS_EVERY:.0} s, with its disk");
    tell("checkpoints", &how, over(saving, CHECKPOINTS_EVERY))?;
    for left in left_out {
        writeln!(to, "left out: {left}")?;
    }
    Ok(())
}

fn spread(values: impl IntoIterator<Item = f64>) -> Spread {
    Spread::of(values).expect("measured at least once")
}

/// The state that every block starts from, and the steps of a block.
struct Bench {
    start: Start,
    steps: u64,
}

impl Bench {
    /// Seconds of a block that the calling thread was on a processor.
    fn block(&self, timed: &Timed<'_>, off: &Scene, scratch: &Path) -> Result<f64, Failure> {
        let start = &self.start;
        match timed {
            Timed::ByHand => {
                let at = (start.system(), start.state());
                let dt = off.stage_dt(&off.stages[0]);
                let method = lennard_integrators::build(&off.integrator.method);
                let forces = Box::new(start.forces(off)?);
                let mut fluid = Rig::start(method, at, forces, dt, Want::NOTHING)?;
                fluid.steps(Start::SETTLING_STEPS)?;
                let watch = Stopwatch::start();
                fluid.steps(self.steps)?;
                Ok(watch.on_processor())
            }
            Timed::Engine(scene, want, false) => {
                let mut simulation = start.settled((*scene).clone())?;
                let watch = Stopwatch::start();
                take(&mut simulation, self.steps, *want)?;
                Ok(watch.on_processor())
            }
            Timed::Engine(scene, _, true) => {
                let mut simulation = start.settled((*scene).clone())?;
                let files = RunFiles::open(Some(scratch), &simulation, None)?;
                let end = simulation.state.step + self.steps;
                let stop = Operation::new(Action::Call, Trigger::At(end));
                let schedule = Schedule::of_output(&simulation.scene).with(stop);
                let mut writing = Writing { files, schedule, end };
                let watch = Stopwatch::start();
                simulation.follow(&mut writing)?;
                Ok(watch.on_processor())
            }
        }
    }

    /// Seconds of what is too rare or too short for a block: watching over a step, and saving a checkpoint to the disk.
    fn called_singly(
        &self,
        off: &Scene,
        repeats: usize,
        scratch: &Path,
    ) -> Result<[Vec<f64>; 2], Failure> {
        let simulation = self.start.settled(off.clone())?;
        let save = || -> Result<(), Failure> {
            let files = RunFiles::open(Some(scratch), &simulation, None)?;
            let checkpoint = capture(&simulation, files.marks(), &Past::default());
            let path = scratch.join("checkpoint-000000000000.lennard");
            Ok(lennard_io::write_checkpoint(&path, &checkpoint)?)
        };
        let (mut watching, mut saving) = (Vec::new(), Vec::new());
        for _ in 0..repeats {
            watching.push(watching_seconds(&simulation));
            let (seconds, saved) = timed(save);
            saved?;
            saving.push(seconds);
        }
        Ok([watching, saving])
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
        Ok(match simulation.state.step == self.end {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    }
}
