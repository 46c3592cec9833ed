//! Whole steps of the cases A, B and C without the engine, for the comparison with other engines:
//! `steps CASE [STEPS] [key=value ...]` with keys `threads`, `beside`, `precision`, `isa`, `skin`, `energies`,
//! `repeats` and `warm`.
//!
//! With `beside`, blocks on two numbers of threads take turns. The median of their ratios tells more than two runs on a
//! machine whose clock drifts. `skin` replaces the skin that the case would choose. U and W are measured after every
//! `energies` steps, or never. `lennard study bench` times kernels and lists by themselves.

use std::io::{Write, stdout};
use std::process::ExitCode;

use lennard_benches::Run;
use lennard_benches::arguments::{Arguments, exit_code};
use lennard_core::parallel::awake;
use lennard_core::{Energetics, ForceError, ForceTerm, Want};
use lennard_engine::stopwatch::{in_turn, timed};
use lennard_forcefield::{Isa, KernelOptions, Precision, TruncationKind};

const KEYS: [&str; 8] =
    ["threads", "beside", "precision", "isa", "skin", "energies", "repeats", "warm"];

fn main() -> ExitCode {
    exit_code(measure())
}

fn measure() -> Result<(), Box<dyn std::error::Error>> {
    let given = Arguments::read(std::env::args().skip(1), &KEYS)?;
    let case = given.case()?;
    let name = case.name;
    let steps = given.steps(200, 1)?;
    let precisions = [("double", Precision::Double), ("mixed", Precision::Mixed)];
    let isas = [
        ("auto", Isa::Auto),
        ("avx512", Isa::Avx512),
        ("avx2", Isa::Avx2),
        ("portable", Isa::Portable),
    ];
    let kernel = KernelOptions {
        precision: given.one_of("precision", &precisions)?,
        isa: given.one_of("isa", &isas)?,
        ..KernelOptions::default()
    };
    let threads = given.number("threads", 1)?.unwrap_or(1);
    let beside = given.number("beside", 1)?;
    let repeats = given.number("repeats", 1)?.unwrap_or(5);
    let warm = given.number("warm", 0)?.unwrap_or(200);
    let skin = given.length("skin")?;
    let energies = given.number("energies", 1)?;
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let counts: Vec<usize> = [threads].into_iter().chain(beside).collect();
    let pools = counts.iter().map(|n| pool(*n)).collect::<Result<Vec<_>, _>>()?;
    let mut run = pools[0].install(|| case.start(kernel, skin, TruncationKind::Cut))?;
    pools[0].install(|| run.steps(warm, Want::NOTHING))?;
    let mut seconds = vec![Vec::new(); pools.len()];
    in_turn(pools.len(), repeats, case.seed, |turn| {
        pools[turn.item].install(|| {
            let mut block = |steps| awake(|| measured_steps(&mut run, steps, energies));
            if pools.len() > 1 {
                // The caches hold what the other threads left: these steps replace it.
                block(steps.div_ceil(8))?;
            }
            let (time, taken) = timed(|| block(steps));
            seconds[turn.item].push(time);
            taken.map(drop)
        })
    })?;
    let s = run.provider.statistics();
    let speed = |seconds: f64| (case.n_atoms() * steps) as f64 / seconds / 1e6;
    for (seconds, threads) in seconds.iter().zip(&counts) {
        writeln!(
            stdout(),
            "{name}: best {:.2} M/s, median {:.2} M/s; {threads} threads, skin {:.3}, {:.1} steps a build, T {:.3}",
            speed(quantile(seconds, 0.0)),
            speed(quantile(seconds, 0.5)),
            s.skin,
            s.evaluations as f64 / s.builds as f64,
            run.temperature(),
        )?;
    }
    if let [these, those] = &seconds[..] {
        let ratios: Vec<f64> = those.iter().zip(these).map(|(b, a)| b / a).collect();
        writeln!(
            stdout(),
            "{} threads over {}: median {:.2}, quartiles {:.2} and {:.2}",
            counts[0],
            counts[1],
            quantile(&ratios, 0.5),
            quantile(&ratios, 0.25),
            quantile(&ratios, 0.75),
        )?;
    }
    Ok(())
}

/// Takes steps, and measures U and W after each `every`.
fn measured_steps(
    run: &mut Run,
    steps: usize,
    every: Option<usize>,
) -> Result<Energetics, ForceError> {
    let Some(every) = every else {
        return run.steps(steps, Want::NOTHING);
    };
    let mut last = Energetics::default();
    for begun in (0..steps).step_by(every) {
        last = run.steps(every.min(steps - begun), Want::ENERGY_AND_VIRIAL)?;
    }
    Ok(last)
}

/// The value below which a share of all lie.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}
