//! Energy drift of a case: `drift CASE [STEPS] [precision=double,mixed] [truncation=shift]`, in ε an atom and τ, from
//! a straight line through the conserved energy without the first fifth, with the standard error of ten block slopes.
#![allow(clippy::print_stdout)]

use std::process::ExitCode;

use lennard_benches::arguments::{Arguments, exit_code};
use lennard_core::{DVec3, ForceProvider, Want};
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

/// Steps between two energies.
const EVERY: usize = 10;
/// Blocks for the standard error.
const BLOCKS: usize = 10;
/// With fewer, a block of what is kept would be a single point.
const FEWEST_STEPS: usize = EVERY * BLOCKS * 2 * 5 / 4;

const TRUNCATIONS: [(&str, TruncationKind); 4] = [
    ("shift", TruncationKind::Shift),
    ("cut", TruncationKind::Cut),
    ("force-shift", TruncationKind::ForceShift),
    ("switch", TruncationKind::Switch),
];

fn main() -> ExitCode {
    exit_code(measure())
}

fn measure() -> Result<(), Box<dyn std::error::Error>> {
    let given = Arguments::read(std::env::args().skip(1), &["precision", "truncation"])?;
    let case = given.case()?;
    let steps = given.steps(3000, FEWEST_STEPS)?;
    let truncation = given.one_of("truncation", &TRUNCATIONS)?;
    let both = [("double", Precision::Double), ("mixed", Precision::Mixed)];
    let choices = [
        ("double,mixed", &both[..]),
        ("double", &both[..1]),
        ("mixed", &both[1..]),
    ];
    for (name, precision) in given.one_of("precision", &choices)? {
        let kernel = KernelOptions {
            precision: *precision,
            ..KernelOptions::default()
        };
        let mut run = case.start(kernel, None, truncation)?;
        let n = case.n_atoms() as f64;
        let mut energies = Vec::with_capacity(steps / EVERY);
        for _ in 0..steps / EVERY {
            let u = run.steps(EVERY, Want::ENERGY)?.conserved_potential;
            energies.push((u.ok_or("no energy")? + run.kinetic_energy()) / n);
        }
        let kept = &energies[energies.len() / 5..];
        let interval = EVERY as f64 * case.dt;
        let (drift, rms) = line(kept, interval);
        let blocks: Vec<f64> = kept
            .chunks_exact(kept.len() / BLOCKS)
            .map(|b| line(b, interval).0)
            .collect();
        let mean = blocks.iter().sum::<f64>() / blocks.len() as f64;
        let spread = blocks.iter().map(|b| (b - mean).powi(2)).sum::<f64>();
        // Energy walks: what one block gains the next one keeps, so that the slope of the whole is known no better than
        // the mean of the slopes of its blocks.
        let error = (spread / (blocks.len() - 1) as f64 / blocks.len() as f64).sqrt();
        let momentum = run.velocities.iter().sum::<DVec3>().length() / n;
        let s = run.provider.statistics();
        println!(
            "{} {name} {truncation:?}, {steps} steps: drift {drift:+.2e} ± {error:.1e} ε/atom/τ, RMS {rms:.1e}, momentum {momentum:.1e} an atom, {} builds, {} late",
            case.name, s.builds, s.late_builds
        );
    }
    Ok(())
}

/// Slope of a straight line through values at equal intervals, and the RMS about it.
fn line(values: &[f64], interval: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = values.iter().sum::<f64>() / n;
    let (mut xy, mut xx) = (0.0, 0.0);
    for (k, v) in values.iter().enumerate() {
        let x = k as f64 - middle;
        xy += x * (v - mean);
        xx += x * x;
    }
    let slope = xy / xx;
    let rest = values
        .iter()
        .enumerate()
        .map(|(k, v)| (v - mean - slope * (k as f64 - middle)).powi(2))
        .sum::<f64>();
    (slope / interval, (rest / n).sqrt())
}
