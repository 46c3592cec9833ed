//! Whole steps of the cases A, B and C without the engine, for the comparison with other engines:
//! `steps CASE [STEPS] [key=value ...]` with keys `threads`, `precision`, `repeats` and `warm`. Kernels, lists and skins
//! are what `lennard bench` is for.
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
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(value("threads", "1").parse()?)
        .build()?;
    let repeats: usize = value("repeats", "5").parse()?;
    let warm: usize = value("warm", "200").parse()?;
    let mut run = pool.install(|| case.start(kernel, None, TruncationKind::Cut))?;
    pool.install(|| run.steps(warm, Want::NOTHING))?;
    let mut seconds = Vec::new();
    for _ in 0..repeats.max(1) {
        let start = Instant::now();
        pool.install(|| awake(|| run.steps(steps, Want::NOTHING)))?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let speed = |seconds: f64| (case.n_atoms() * steps) as f64 / seconds / 1e6;
    let s = run.provider.statistics();
    println!(
        "{name}: best {:.2} M/s, median {:.2} M/s; skin {:.3}, {:.1} steps a build, T {:.3}",
        speed(seconds[0]),
        speed(seconds[seconds.len() / 2]),
        s.skin,
        s.evaluations as f64 / s.builds as f64,
        run.temperature(),
    );
    Ok(())
}
