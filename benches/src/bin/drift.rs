//! Energy drift of a case: `drift CASE STEPS [precision=double,mixed] [truncation=shift]`, in ε an atom and τ, from
//! a straight line through the conserved energy without the first fifth, with the standard error of ten block slopes.
#![allow(clippy::print_stdout)]

use lennard_benches::CASES;
use lennard_core::{DVec3, ForceProvider, Want};
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

/// Steps between two energies.
const EVERY: usize = 10;
/// Blocks for the standard error.
const BLOCKS: usize = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |key: &str, default: &str| -> String {
        arguments
            .iter()
            .find_map(|a| a.strip_prefix(key)?.strip_prefix('='))
            .unwrap_or(default)
            .to_owned()
    };
    let case = *CASES
        .iter()
        .find(|c| Some(c.name) == arguments.first().map(String::as_str))
        .ok_or("the cases are A, B and C")?;
    let steps: usize = arguments.get(1).ok_or("how many steps?")?.parse()?;
    let truncation = match value("truncation", "shift").as_str() {
        "cut" => TruncationKind::Cut,
        "shift" => TruncationKind::Shift,
        "force-shift" => TruncationKind::ForceShift,
        "switch" => TruncationKind::Switch,
        other => return Err(format!("no truncation `{other}`").into()),
    };
    for precision in value("precision", "double,mixed").split(',') {
        let kernel = KernelOptions {
            precision: match precision {
                "mixed" => Precision::Mixed,
                _ => Precision::Double,
            },
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
        // The slope of a whole line is known BLOCKS times better than the mean of the slopes of its blocks.
        let error =
            (spread / (blocks.len() - 1) as f64 / blocks.len() as f64).sqrt() / BLOCKS as f64;
        let momentum = run.velocities.iter().sum::<DVec3>().length() / n;
        let s = run.provider.statistics();
        println!(
            "{} {precision} {truncation:?}, {steps} steps: drift {drift:+.2e} ± {error:.1e} ε/atom/τ, RMS {rms:.1e}, momentum {momentum:.1e} an atom, {} builds, {} late",
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
