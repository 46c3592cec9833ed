//! Whole steps of the cases A, B and C without the engine, for the comparison with other engines:
//! `steps CASE [STEPS] [key=value ...]` with keys `threads`, `beside`, `precision`, `repeats` and `warm`. With `beside`, blocks on
//! so many threads are taken in turn with those on `threads`, and the median of the ratios of neighboring blocks tells
//! more than two runs on a machine whose clock drifts. Kernels, lists and skins are what `lennard bench` is for.
#![allow(clippy::print_stdout)]

use std::time::Instant;

use lennard_benches::CASES;
use lennard_core::parallel::awake;
use lennard_core::{ForceProvider, Want};
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |key: &str, default: &str| -> String {
        let found = arguments
            .iter()
            .find_map(|a| a.strip_prefix(key)?.strip_prefix('='));
        found.unwrap_or(default).to_owned()
    };
    let name = arguments.first().map_or("A", String::as_str);
    let case = *CASES
        .iter()
        .find(|c| c.name == name)
        .ok_or("the cases are A, B and C")?;
    let steps: usize = arguments.get(1).map_or(Ok(200), |s| s.parse())?;
    let kernel = KernelOptions {
        precision: match value("precision", "double").as_str() {
            "double" => Precision::Double,
            "mixed" => Precision::Mixed,
            _ => return Err("precision is double or mixed".into()),
        },
        ..KernelOptions::default()
    };
    let pool = |threads: &str| -> Result<rayon::ThreadPool, Box<dyn std::error::Error>> {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?);
        Ok(builder.build()?)
    };
    let (threads, beside) = (value("threads", "1"), value("beside", ""));
    let mut pools = vec![pool(&threads)?];
    if !beside.is_empty() {
        pools.push(pool(&beside)?);
    }
    let repeats: usize = value("repeats", "5").parse()?;
    let warm: usize = value("warm", "200").parse()?;
    let mut run = pools[0].install(|| case.start(kernel, None, TruncationKind::Cut))?;
    pools[0].install(|| run.steps(warm, Want::NOTHING))?;
    let mut seconds = vec![Vec::new(); pools.len()];
    for round in 0..repeats.max(1) {
        for k in 0..pools.len() {
            // Neither always comes first.
            let k = (k + round) % pools.len();
            pools[k]
                .install(|| -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
                    let mut block = |steps| awake(|| run.steps(steps, Want::NOTHING));
                    if pools.len() > 1 {
                        // What the other threads left in their caches is not this block's affair.
                        block(steps.div_ceil(8))?;
                    }
                    let start = Instant::now();
                    block(steps)?;
                    seconds[k].push(start.elapsed().as_secs_f64());
                    Ok(())
                })
                .map_err(|e| e.to_string())?;
        }
    }
    let s = run.provider.statistics();
    for (seconds, threads) in seconds.iter().zip([&threads, &beside]) {
        println!(
            "{name}: best {:.2} M/s, median {:.2} M/s; {threads} threads, skin {:.3}, {:.1} steps a build, T {:.3}",
            case.n_atoms() as f64 * steps as f64 / quantile(seconds, 0.0) / 1e6,
            case.n_atoms() as f64 * steps as f64 / quantile(seconds, 0.5) / 1e6,
            s.skin,
            s.evaluations as f64 / s.builds as f64,
            run.temperature(),
        );
    }
    if let [these, those] = &seconds[..] {
        let ratios: Vec<f64> = those.iter().zip(these).map(|(b, a)| b / a).collect();
        println!(
            "{threads} threads over {beside}: median {:.2}, quartiles {:.2} and {:.2}",
            quantile(&ratios, 0.5),
            quantile(&ratios, 0.25),
            quantile(&ratios, 0.75),
        );
    }
    Ok(())
}

/// The value below which a share of all lie.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}
