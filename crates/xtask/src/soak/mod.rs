//! Kills, starves and resumes runs on changing numbers of threads: `cargo xtask soak`.
//!
//! Each run must leave the same bytes as an undisturbed run.

mod compare;
mod rig;

use std::error::Error;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use crate::workspace::{Workspace, cargo};
use rig::{Rig, Tally};

/// Observables that a changing box allows.
const RADIAL_DISTRIBUTION: &str = "observable=[{ kind = \"rdf\", every = 20 }]";

/// What is run: name and overrides of the scene in [`rig`].
const VARIANTS: &[(&str, &[&str])] = &[
    ("velocity Verlet", &[]),
    (
        "leapfrog, langevin bath",
        &["integrator.kind=leapfrog", "stage.production.thermostat=langevin"],
    ),
    ("time-based checkpoints", &["checkpoint.every_steps=0", "checkpoint.every_seconds=0.02"]),
    (
        "Störmer–Verlet, rescale, 864 particles",
        &["integrator.kind=stormer-verlet", "stage.melt.thermostat=rescale", "system.n_atoms=864"],
    ),
    ("RESPA", &["integrator.kind=respa"]),
    (
        "mixed precision, bussi bath",
        &["kernel.precision=mixed", "stage.production.thermostat=bussi"],
    ),
    ("every pair, no list", &["neighbor.mode=direct"]),
    ("random start", &["start.kind=random"]),
    (
        "constant pressure, stochastic cell rescaling",
        &[
            "stage.melt.barostat={ kind = \"stochastic-cell-rescaling\", pressure = 4.0 }",
            "stage.production.thermostat=bussi",
            "stage.production.barostat={ kind = \"stochastic-cell-rescaling\", pressure = 4.0 }",
            RADIAL_DISTRIBUTION,
        ],
    ),
    (
        "constant pressure, chains and a ramp",
        &[
            "stage.melt.temperature={ from = 2.0, to = 1.4 }",
            "stage.production.thermostat=nose-hoover",
            "stage.production.barostat={ kind = \"mtk\", pressure = 4.0 }",
            RADIAL_DISTRIBUTION,
        ],
    ),
    ("PEFRL, forces in the trajectory", &["integrator.kind=pefrl", "output.forces=true"]),
    ("a compressed trajectory", &["output.format=xyz.gz"]),
    ("a trajectory in XTC", &["output.format=xtc"]),
];

/// How much is done.
struct Extent {
    /// Kills of the one long chain.
    chain: u32,
    /// Kills altogether.
    kills: u32,
    /// Kills in one of the short chains.
    short_chain: u32,
    /// Runs that hit a full disk.
    starved: u32,
    /// Production steps of the short chains and of the long one.
    steps: [u64; 2],
}

const QUICK: Extent =
    Extent { chain: 4, kills: 10, short_chain: 2, starved: 2, steps: [4_000, 6_000] };
const FULL: Extent =
    Extent { chain: 50, kills: 200, short_chain: 5, starved: 30, steps: [20_000, 200_000] };

/// Seed of the random times where none is given.
const DEFAULT_SEED: u64 = 1;

/// Steps of the long conservation run.
const LONG_STEPS: u64 = 10_000_000;

/// Builds the program and runs the command.
pub fn build_and_run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let mut build = workspace.command(cargo());
    build.args(["build", "--quiet", "--release", "--package", "lennard"]);
    if build.status().is_ok_and(|status| status.success()) {
        run(workspace, arguments)
    } else {
        eprintln!("the program cannot be built");
        ExitCode::FAILURE
    }
}

/// Runs the command; the exit code says whether every byte was the same.
fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let mut extent = &FULL;
    let mut long = false;
    let mut seed = DEFAULT_SEED;
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match *argument {
            "--quick" => extent = &QUICK,
            "--long" => long = true,
            "--seed" => match rest.next().and_then(|n| n.parse().ok()) {
                Some(given) => seed = given,
                None => return usage("--seed wants a whole number"),
            },
            other => return usage(&format!("unknown argument: {other}")),
        }
    }
    let done = if long { conservation(workspace) } else { kills(workspace, extent, seed) };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("soak failed: {error}");
            ExitCode::FAILURE
        }
    }
}

fn usage(fault: &str) -> ExitCode {
    eprintln!("{fault}\n\n{}", crate::help::HELP);
    ExitCode::from(2)
}

/// Random kills in chains over the variants, then runs with too small a disk.
fn kills(workspace: &Workspace, extent: &Extent, seed: u64) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let mut rig = Rig::new(workspace.binary(), seed)?;
    let mut sum = Tally::default();
    let mut chains = 0;
    println!(
        "seed {seed}; kills are SIGKILL at random times; threads change from 1 to 4 at random"
    );
    let first = Plan {
        name: "the long chain: velocity Verlet",
        overrides: &[],
        steps: extent.steps[1],
        kills: extent.chain,
    };
    let mut next = Some(first);
    let mut turn = 0;
    while let Some(plan) = next.take() {
        let tally = plan.carry_out(&mut rig)?;
        println!(
            "{:<42} {:>3} kills, {} stops by signal, {} began anew: every byte the same",
            plan.name, tally.kills, tally.stops, tally.begun_anew
        );
        sum += tally;
        chains += 1;
        if sum.kills < extent.kills {
            let (name, overrides) = VARIANTS[turn % VARIANTS.len()];
            turn += 1;
            let kills = extent.short_chain.min(extent.kills - sum.kills);
            next = Some(Plan { name, overrides, steps: extent.steps[0], kills });
        }
    }
    for turn in 0..extent.starved {
        let (name, overrides) = VARIANTS[turn as usize % VARIANTS.len()];
        let faults = rig.starve(overrides, extent.steps[0])?;
        println!("{name:<42} {faults} failed writes: every byte the same");
        sum.faults += faults;
    }
    println!(
        "{} kills in {chains} chains (the longest of {}), {} stops by signal, {} runs begun anew since no checkpoint \
         was there yet, {} failed writes in {} runs: no run lost, no byte different, {:.0} s",
        sum.kills,
        extent.chain,
        sum.stops,
        sum.begun_anew,
        sum.faults,
        extent.starved,
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// One chain: a run that is killed so often before it comes to its end.
struct Plan {
    name: &'static str,
    overrides: &'static [&'static str],
    steps: u64,
    kills: u32,
}

impl Plan {
    fn carry_out(&self, rig: &mut Rig) -> Result<Tally, Box<dyn Error>> {
        let named = |e: Box<dyn Error>| format!("{}: {e}", self.name);
        let undisturbed = rig.undisturbed(self.overrides, self.steps).map_err(named)?;
        // A chain that comes to its end before it was killed often enough has been killed too late: again, faster.
        let mut share = 1.0;
        for _ in 0..10 {
            let longest: Duration = undisturbed.wall.mul_f64(share / f64::from(self.kills));
            let tally =
                rig.chain(self.overrides, self.steps, self.kills, longest).map_err(named)?;
            rig.compare(&undisturbed).map_err(named)?;
            if tally.kills == self.kills {
                return Ok(tally);
            }
            share *= 0.6;
        }
        Err(named("it ends before it can be killed".into()).into())
    }
}

/// Ten million steps of 108 particles.
fn conservation(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    /// Rounding alone: each step adds some 1e-16 of random sign to a velocity of order 1, √(10⁷)·1e-16 ≈ 3e-13
    /// a particle; a margin of 300.
    const LARGEST_MOMENTUM: f64 = 1e-10;
    /// A smooth force and dt = 0.004: far below what ten million steps would turn into a change of 0.01 ε.
    const LARGEST_DRIFT: f64 = 2.5e-7;
    let start = Instant::now();
    let mut rig = Rig::new(workspace.binary(), 1)?;
    let record = rig.conservation(LONG_STEPS)?;
    let number = |name: &str| {
        record["conservation"][name].as_f64().ok_or_else(|| format!("the run record has no {name}"))
    };
    let (drift, error) =
        (number("energy_drift_per_atom_per_tau")?, number("energy_drift_standard_error")?);
    let (rms, momentum) = (number("energy_rms_per_atom")?, number("momentum_per_atom")?);
    let of_lists = |name: &str| {
        record["neighbor"][name].as_f64().ok_or_else(|| format!("the run record has no {name}"))
    };
    let (checked, deviation) = (of_lists("checked_forces")?, of_lists("largest_deviation")?);
    println!(
        "{LONG_STEPS} steps of 108 particles: energy drift {drift:+.2e} ± {error:.1e} ε per particle per τ, \
         fluctuation {rms:.2e} ε (RMS), largest momentum {momentum:.1e} σ/τ per particle, {checked} forces checked, off by {deviation:.4} of the tolerance, {:.0} s",
        start.elapsed().as_secs_f64()
    );
    if drift.abs() > LARGEST_DRIFT || momentum > LARGEST_MOMENTUM || deviation > 1.0 {
        return Err(format!(
            "allowed are a drift of {LARGEST_DRIFT:e}, a momentum of {LARGEST_MOMENTUM:e} and no force beyond its tolerance"
        )
        .into());
    }
    Ok(())
}
