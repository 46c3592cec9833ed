//! What can be typed.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use lennard_core::parallel::{most_threads, processors};

mod eos;
mod studies;
#[cfg(test)]
mod tests;

pub use eos::{EosArgs, Values};
pub use studies::*;

/// Help that ends with the exit codes of a program.
macro_rules! with_exit_codes {
    ($help:literal) => {
        concat!(
            $help,
            "Exit codes: 0 done, 2 the input is wrong, 3 physics failed, 4 stopped on request and resumable, 1 anything else."
        )
    };
}

/// Molecular dynamics of Lennard-Jones fluids: fast, exact, and with error bars.
#[derive(Debug, Parser)]
#[command(
    name = "lennard",
    version,
    after_help = with_exit_codes!(
        "Examples:\n  \
        lennard run template                            a liquid, within seconds\n  \
        lennard new my-fluid                            a scene of your own, with comments\n  \
        lennard run my-fluid.toml --set system.density=0.7\n  \
        lennard sweep sweep/isotherm                    pressure along an isotherm\n  \
        lennard list scenes\n\n"
    ),
    propagate_version = true,
    arg_required_else_help = true
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// One big system on several ranks, which MPI starts: the same bits as `lennard`.
#[derive(Debug, Parser)]
#[command(
    name = "lennard-mpi",
    version,
    after_help = with_exit_codes!(
        "Examples:\n  \
        mpirun -n 4 lennard-mpi run big-fluid.toml --threads 16 --out runs/big\n  \
        mpirun -n 8 lennard-mpi resume runs/big\n\n\
        Any other command is one of `lennard`, which reads what this program writes.\n"
    ),
    propagate_version = true,
    arg_required_else_help = true
)]
pub struct RanksCli {
    /// What to do.
    #[command(subcommand)]
    pub command: RanksCommand,
}

/// The commands of `lennard-mpi`.
#[derive(Debug, Subcommand)]
pub enum RanksCommand {
    /// Run a scene on all ranks; rank 0 writes and prints.
    Run(RunArgs),
    /// Go on with a run on any number of ranks, to the bit, whether one process or several began it.
    Resume(ResumeArgs),
}

/// The commands: first what a user of fluids needs, then the two doors to the others.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene: melt, equilibrate, measure, compare with the literature.
    #[command(after_help = "Examples:\n  \
        lennard run template\n  \
        lennard run template --watch                     T, U and P as they go\n  \
        lennard run verlet-1967/triple-point --set stage.production.steps=200000 --seed 7\n  \
        lennard run fluid/gas --json --quiet > result.json")]
    Run(RunArgs),
    /// Write a scene of your own to change: a template with comments, or a copy of a shipped scene.
    #[command(after_help = "Examples:\n  \
        lennard new my-fluid\n  \
        lennard new my-gas --like fluid/gas\n  \
        lennard new my-isotherm --like sweep/isotherm\n\n\
        The shipped scenes: lennard list scenes\n\
        From an input of LAMMPS for Lennard-Jones atoms: lennard new --from in.melt")]
    New(NewArgs),
    /// Say what a scene computes, what it leaves out and why, its memory, and about how long it takes.
    #[command(after_help = "Examples:\n  \
        lennard plan template\n  \
        lennard plan verlet-1967/triple-point --verbose\n  \
        lennard plan bench/melt-32k --ranks 4 --latency 2us --bandwidth 12GB/s")]
    Plan(PlanArgs),
    /// Go on with a run that was stopped or killed, to the bit, or make a finished one longer.
    #[command(after_help = "Examples:\n  \
        lennard run template --out liquid                a run to go on with\n  \
        lennard resume liquid --steps 1000\n  \
        lennard resume liquid --steps 2000 --max-walltime 2h\n  \
        lennard resume liquid --older                    from the checkpoint before the newest")]
    Resume(ResumeArgs),
    /// Run many state points side by side; finished ones are not run again.
    #[command(after_help = "Examples:\n  \
        lennard sweep sweep/isotherm\n  \
        lennard sweep verlet-1967/table --out runs/verlet-2.5\n  \
        lennard sweep verlet-1967/table --out runs/verlet-4 --set truncation.r_cut=4\n\n\
        On many machines, each process runs points of its own in one common folder:\n  \
        lennard sweep sweep/isotherm --points\n  \
        lennard sweep sweep/isotherm --out runs/iso --point 3\n  \
        lennard sweep sweep/isotherm --out runs/iso --collect\n  \
        lennard sweep sweep/isotherm --out runs/iso --emit slurm > iso.sbatch")]
    Sweep(SweepArgs),
    /// Put finished runs beside the literature, beside each other, or beside values of your own, with errors and verdicts.
    #[command(after_help = "Examples:\n  \
        lennard run template --out liquid                a run to compare\n  \
        lennard compare liquid\n  \
        lennard compare liquid --verbose\n  \
        lennard compare liquid --json")]
    Compare(CompareArgs),
    /// Measure a trajectory of any program: the observables of a scene over its frames, with the errors, verdicts, files and page of a run.
    #[command(
        mut_arg("scene", |arg| arg.long("scene").value_name("SCENE").required(true)),
        mut_arg("max_walltime", |arg| {
            arg.help("Stop after this time with nothing written and exit code 1: 90s, 10m, 2h, 1h30m")
        }),
        after_help = "Examples:\n  \
            lennard run formats/lammps-dump --out mine       a trajectory to measure\n  \
            lennard measure mine/trajectory.lammpstrj --scene mine/scene.toml\n  \
            lennard measure mine/trajectory.lammpstrj --scene formats/xtc --interval 0.2\n  \
            lennard measure mine/trajectory.lammpstrj --scene mine/scene.toml --json --quiet > measured.json\n\n\
            The scene says the potential and what is measured. Number of particles, box and times are of the frames."
    )]
    Measure(MeasureArgs),
    /// Chart speed against accuracy: one scene with many settings, and which of them are worth their cost.
    #[command(after_help = "Examples:\n  \
        lennard chart verlet-1967/triple-point --quick\n  \
        lennard chart verlet-1967/triple-point --out runs/chart\n  \
        lennard chart npt/baths --ensemble               settings of the barostat and the thermostat\n\n\
        A scene with `[accuracy]` takes the settings that `lennard tune` found for it.\n\
        Finished points are kept in the output folder: the same command goes on where it was stopped.")]
    Chart(ChartArgs),
    /// Find the cheapest settings for the accuracy that a scene asks for, and keep them in a lock file.
    #[command(after_help = "The scene says how wrong the results may be:\n  \
        accuracy = { potential_energy = 1e-3, pressure = 5e-3, drift = 1e-5 }\n\
        A scene with settings of its own is asked for just that, and told the cheapest; no lock is written.\n\n\
        Examples:\n  \
        lennard tune fluid/accuracy                      then: lennard run fluid/accuracy\n  \
        lennard tune verlet-1967/triple-point\n  \
        lennard tune fluid/accuracy --set accuracy.pressure=0.02 --lock coarse.lock.toml --json")]
    Tune(TuneArgs),
    /// Evaluate energy, virial and pressure of a scene's start configuration once.
    #[command(after_help = "Examples:\n  \
        lennard energy template\n  \
        lennard energy verlet-1967/triple-point --set truncation.r_cut=4\n  \
        lennard energy verlet-1967/triple-point --forces forces.xyz --json")]
    Energy(EnergyArgs),
    /// Print what an equation of state gives at any state, without a run: properties, curves, coexistence.
    #[command(after_help = "Examples:\n  \
        lennard eos --density 0.8442 --temperature 0.722        every property by every equation\n  \
        lennard eos thol-2016 --density 0.1:0.8:0.1 --temperature 1.5\n  \
        lennard eos thol-2016 --pressure 1 --temperature 0.8:1.2:0.1 --properties speed_of_sound\n  \
        lennard eos thol-2015 --saturation\n  \
        lennard eos pohl-2023 --exponents 11.5,6 --density 0.7 --temperature 1\n  \
        lennard eos virial -d 0.01 -T 1 --json\n  \
        lennard eos thol-2016 --substance argon -T 94.4K -d 1.374g/cm3\n\n\
        Equations and their ranges: lennard list equations-of-state")]
    Eos(EosArgs),
    /// List the methods that a scene can name.
    #[command(
        after_help = "Examples:\n  lennard list                             what can be listed\n  \
        lennard list scenes\n  lennard list integrators                 the one to use comes first\n  \
        lennard list integrators leapfrog        one method with its equations and its source\n  \
        lennard list potentials --json"
    )]
    List(ListArgs),
    /// Measure the program itself: its speed, where integrators fail, how bonds and contacts hold.
    #[command(
        subcommand,
        disable_help_subcommand = true,
        after_help = "Examples:\n  \
        lennard study bench --quick\n  \
        lennard study stability --quick\n  \
        lennard study mechanics --quick"
    )]
    Study(StudyCommand),
    /// Generate what other programs read: input for LAMMPS, completions, man pages, the schema of a scene.
    #[command(
        subcommand,
        disable_help_subcommand = true,
        after_help = "Examples:\n  \
        lennard generate lammps verlet-1967/liquid lammps-liquid\n  \
        lennard generate schema > scene.schema.json\n  \
        lennard generate man man/man1"
    )]
    Generate(GenerateCommand),
    /// Print version, instruction sets and threads.
    #[command(after_help = "Examples:\n  \
        lennard version\n  \
        lennard version --json\n  \
        lennard version --json > machine.json")]
    Version {
        /// One JSON document on standard output.
        #[arg(long)]
        json: bool,
    },
}

/// The studies of `lennard study`.
#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// Measure how fast the force loop, the list build and whole steps are, for each kernel, precision and number of threads.
    #[command(after_help = "Examples:\n  \
        lennard study bench --quick\n  \
        lennard study bench verlet-1967/triple-point --threads 1,2 --repeats 15\n  \
        lennard study bench --isa portable --precision double --json\n\n\
        Without a scene: bench/melt-32k, and with --quick bench/fluid-864.")]
    Bench(BenchArgs),
    /// Measure where each integrator fails, on the oscillator and on the fluid, beside theory.
    #[command(after_help = "Examples:\n  \
        lennard study stability --quick\n  \
        lennard study stability studies/stability-quick --out runs/stability\n  \
        lennard study stability --quick --json > stability.json")]
    Stability(StudyArgs),
    /// Measure constraints, springs, SPOOK and collisions on few bodies and on dumbbells, beside theory.
    #[command(after_help = "Examples:\n  \
        lennard study mechanics --quick\n  \
        lennard study mechanics studies/mechanics-quick --out runs/mechanics\n  \
        lennard study mechanics --quick --json > mechanics.json")]
    Mechanics(StudyArgs),
}

/// What `lennard generate` makes for other programs.
#[derive(Debug, Subcommand)]
pub enum GenerateCommand {
    /// Write a scene, or the last state of a run, as the input of LAMMPS.
    #[command(after_help = "Examples:\n  \
        lennard generate lammps verlet-1967/liquid lammps-liquid\n  \
        lennard run template --out liquid\n  \
        lennard generate lammps liquid lammps-later              the last state of a run\n\n\
        It writes start.data and in.lammps: the same state, potential, truncation, stages and baths.\n\
        Where energies depend on something that LAMMPS does not have, it is refused; anything else is named in the script.")]
    Lammps(LammpsArgs),
    /// Print a completion script for a shell.
    #[command(after_help = "Examples:\n  \
        lennard generate completions bash > lennard.bash         then: source lennard.bash\n  \
        lennard generate completions zsh > _lennard\n  \
        lennard generate completions fish > lennard.fish")]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the man pages of all commands to a folder.
    #[command(after_help = "Examples:\n  \
        lennard generate man man/man1                            then: man -M man lennard-run\n  \
        lennard generate man ~/.local/share/man/man1             then: man lennard-run\n  \
        lennard generate man .                                   then: man ./lennard-run.1")]
    Man {
        /// The folder; it is made where it is missing.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Print the JSON Schema of a scene, with which editors complete keys and check values.
    #[command(after_help = "Examples:\n  \
        lennard generate schema > scene.schema.json\n  \
        lennard generate schema | head -n 20\n  \
        lennard new my-fluid --schema                            both files at once\n\n\
        Taplo and the TOML extensions of editors take it from the first line of a scene:\n  \
        #:schema ./scene.schema.json")]
    Schema,
}

/// The scene and what is changed in it.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// The scene: a file, or the name of a shipped scene (`lennard list scenes`).
    #[arg(value_parser = scene_file)]
    pub scene: PathBuf,
    /// Override a key, such as `system.density=0.8` or `stage.production.steps=100000`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Seed of all random streams (short for --set system.seed=N).
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads, at most four for each processor (or 16); by default as many as make this scene faster.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<u16>,
    /// Instruction set of the pair kernel (short for --set kernel.isa=NAME).
    #[arg(long, value_name = "NAME")]
    pub isa: Option<String>,
    /// Precision of the pair kernel (short for --set kernel.precision=NAME).
    #[arg(long, value_name = "NAME")]
    pub precision: Option<String>,
    /// Lock file with the settings for the scene's `[accuracy]`; by default NAME.lock.toml beside NAME.toml.
    #[arg(long, value_name = "FILE")]
    pub lock: Option<PathBuf>,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
}

impl SceneArgs {
    /// All overrides, the short forms included.
    pub fn overrides(&self) -> Vec<(String, String)> {
        let mut all = self.set.clone();
        let short = [
            ("system.seed", self.seed.map(|s| s.to_string())),
            ("kernel.isa", self.isa.clone()),
            ("kernel.precision", self.precision.clone()),
        ];
        all.extend(short.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))));
        all
    }
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Scene, overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Output folder; by default `runs/<scene>-<n>` with the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// Show the course of T, U and P beside the progress, and write report.html while the run goes on: at once, later every minute.
    #[arg(long, conflicts_with = "no_report")]
    pub watch: bool,
    /// How long, and how loud.
    #[command(flatten)]
    pub control: ControlArgs,
}

/// Arguments of `measure`.
#[derive(Debug, Args)]
pub struct MeasureArgs {
    /// The trajectory: XTC, LAMMPS dump, extended XYZ or GRO; text may be compressed by gzip.
    pub trajectory: PathBuf,
    /// Scene, overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Time between two frames in τ, where the file does not say it; by default its steps times the scene's integrator.dt.
    #[arg(long, value_name = "TIME", value_parser = above_zero, allow_hyphen_values = true)]
    pub interval: Option<f64>,
    /// One σ in the file's unit of length; by default the scene's start.length_scale, or 1. XTC takes the output.length_scale
    /// of the scene that wrote it.
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub length_scale: Option<f64>,
    /// One τ in the file's unit of time; by default the scene's start.time_scale, or 1.
    #[arg(long, value_name = "TIME", value_parser = above_zero, allow_hyphen_values = true)]
    pub time_scale: Option<f64>,
    /// Output folder; by default `runs/<scene>-<n>` with the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// How loud.
    #[command(flatten)]
    pub control: ControlArgs,
}

/// Arguments of `new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Name of the scene; the file is NAME.toml. By default the name of an input without `in.`.
    #[arg(required_unless_present = "from")]
    pub name: Option<PathBuf>,
    /// The shipped scene to copy; by default `template`.
    #[arg(long, value_name = "SCENE")]
    pub like: Option<PathBuf>,
    /// An input of LAMMPS for Lennard-Jones atoms, such as in.melt, to be made a scene.
    #[arg(long, value_name = "INPUT", conflicts_with = "like")]
    pub from: Option<PathBuf>,
    /// Write scene.schema.json beside it, and name it in the first line, for editors.
    #[arg(long)]
    pub schema: bool,
    /// Replace existing files.
    #[arg(long)]
    pub force: bool,
}

/// How long a run may take, and what it shows meanwhile.
#[derive(Debug, Args)]
pub struct ControlArgs {
    /// Stop after this time with a checkpoint and exit code 4: 90s, 10m, 2h, 1h30m.
    #[arg(long, value_name = "TIME", value_parser = wall_time, allow_hyphen_values = true)]
    pub max_walltime: Option<Duration>,
    /// Write no report.html.
    #[arg(long)]
    pub no_report: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
    /// Every quantity, tolerance, source and note, and where the time went.
    #[arg(long, alias = "all")]
    pub verbose: bool,
}

impl ControlArgs {
    /// When to stop, for a program that started at `start`; none where the time is longer than clocks go.
    pub fn deadline(&self, start: Instant) -> Option<Instant> {
        start.checked_add(self.max_walltime?)
    }
}

/// Arguments of `resume`.
#[derive(Debug, Args)]
pub struct ResumeArgs {
    /// The output folder of the run.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Make the last stage N steps longer than it is.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub steps: Option<u64>,
    /// Go on from the checkpoint before the newest.
    #[arg(long)]
    pub older: bool,
    /// Show the course of T, U and P beside the progress, and write report.html while the run goes on: at once, later every minute.
    #[arg(long, conflicts_with = "no_report")]
    pub watch: bool,
    /// Threads, at most four for each processor (or 16); by default as many as make this run faster. The bits do not depend
    /// on it.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<u16>,
    /// Go on with this instruction set. Where the run had another, bits may differ, and run.json says so.
    #[arg(long, value_name = "NAME")]
    pub isa: Option<String>,
    /// Another value of a key of [output], any number of times: output.format=xyz, or output.trajectory_every=0 for no more frames.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
    /// How long, and how loud.
    #[command(flatten)]
    pub control: ControlArgs,
}

/// A file, or a shipped scene where there is no such file.
fn scene_file(text: &str) -> Result<PathBuf, std::convert::Infallible> {
    Ok(lennard_scene::shipped::locate(text.as_ref()))
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("wanted KEY=VALUE, such as system.density=0.8".into()),
    }
}

/// A number of threads that this machine may be asked for.
fn threads(text: &str) -> Result<u16, String> {
    let most = most_threads();
    let number = text.parse().ok();
    number
        .filter(|number| (1..=most).contains(&usize::from(*number)))
        .ok_or_else(|| format!("allowed: 1 to {most} on {} processors", processors()))
}

/// A number above zero.
fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "wanted a number above zero, such as 0.25".into())
}

/// A time above zero.
fn wall_time(text: &str) -> Result<Duration, String> {
    let time = time(text, "90s, 10m, 2h or 1h30m")?;
    if time > Duration::ZERO {
        Ok(time)
    } else {
        Err("wanted a time above zero, such as 90s, 10m, 2h or 1h30m".into())
    }
}

/// A time with a unit; a message names `examples`.
fn time(text: &str, examples: &str) -> Result<Duration, String> {
    humantime::parse_duration(text).map_err(|e| format!("{e}; wanted a time such as {examples}"))
}
