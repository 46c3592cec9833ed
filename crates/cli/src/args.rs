//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

/// Molecular dynamics of Lennard-Jones fluids: fast, exact, and with error bars.
#[derive(Debug, Parser)]
#[command(
    name = "lennard",
    version,
    about,
    after_help = "Examples:\n  \
        lennard run inputs/verlet-1967/triple-point.toml\n  \
        lennard run inputs/fluid/gas.toml --set system.density=0.02 --out runs/thin-gas\n  \
        lennard plan inputs/bench/melt-32k.toml\n  \
        lennard energy inputs/fluid/from-configuration.toml --json\n\n\
        Exit codes: 0 done, 2 the input is wrong, 3 physics failed, 4 stopped on request and resumable, 1 anything else.",
    propagate_version = true,
    arg_required_else_help = true
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene: melt, equilibrate, measure, compare with the literature.
    #[command(after_help = "Examples:\n  \
        lennard run inputs/verlet-1967/triple-point.toml\n  \
        lennard run inputs/verlet-1967/triple-point.toml --set stage.production.steps=200000 --seed 7\n  \
        lennard run inputs/fluid/gas.toml --json --quiet > result.json")]
    Run(RunArgs),
    /// Say what a scene computes, what it leaves out and why, its memory, and about how long it takes.
    #[command(after_help = "Example:\n  lennard plan inputs/verlet-1967/triple-point.toml")]
    Plan(PlanArgs),
    /// Evaluate energy, virial and pressure of a scene's start configuration once.
    #[command(after_help = "Examples:\n  \
        lennard energy inputs/fluid/from-configuration.toml\n  \
        lennard energy inputs/fluid/from-configuration.toml --forces forces.xyz --json")]
    Energy(EnergyArgs),
    /// List the methods that a scene can name.
    #[command(after_help = "Examples:\n  lennard list integrators\n  lennard list potentials --json")]
    List(ListArgs),
    /// Print a completion script for a shell.
    #[command(after_help = "Example:\n  lennard completions bash > ~/.local/share/bash-completion/completions/lennard")]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print version, instruction sets and threads.
    Version {
        /// One JSON document on standard output.
        #[arg(long)]
        json: bool,
    },
}

/// The scene and what is changed in it.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// The scene file (see inputs/README.md).
    pub scene: PathBuf,
    /// Override a key, such as `system.density=0.8` or `stage.production.steps=100000`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Seed of all random streams (short for --set system.seed=N).
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; by default as many as pay for this scene.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Instruction set of the pair kernel (short for --set kernel.isa=NAME).
    #[arg(long, value_name = "NAME")]
    pub isa: Option<String>,
    /// Precision of the pair kernel (short for --set kernel.precision=NAME).
    #[arg(long, value_name = "NAME")]
    pub precision: Option<String>,
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
    /// Output folder; by default runs/<scene>-<n> with the first free n.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// No progress and no table; errors only.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `plan`.
#[derive(Debug, Args)]
pub struct PlanArgs {
    /// Scene, overrides, threads.
    #[command(flatten)]
    pub scene: SceneArgs,
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

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// What to list.
    pub what: Listed,
    /// One JSON document on standard output.
    #[arg(long)]
    pub json: bool,
}

/// What can be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Listed {
    /// Methods that advance time.
    Integrators,
    /// Heat baths.
    Thermostats,
    /// Pair potentials.
    Potentials,
    /// Ways to end a potential.
    Truncations,
    /// What can be measured.
    Observables,
    /// What results are compared with.
    EquationsOfState,
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("wanted KEY=VALUE, such as system.density=0.8".into()),
    }
}
