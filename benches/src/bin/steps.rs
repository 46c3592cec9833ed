//! Whole steps of the cases A, B and C: `steps CASE [STEPS] [key=value ...]` with keys `threads`, `precision`,
//! `isa`, `skin` (several values with commas are measured in alternation), `repeats` and `warm`.
#![allow(clippy::print_stdout)]

use std::time::Instant;

use lennard_benches::{CASES, Run};
use lennard_core::{ForceProvider, Want};
use lennard_forcefield::{Isa, Kernel, KernelOptions, Precision, TruncationKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |key: &str, default: &str| -> String {
        arguments
            .iter()
            .find_map(|a| a.strip_prefix(key)?.strip_prefix('='))
            .unwrap_or(default)
            .to_owned()
    };
    let name = arguments.first().map_or("A", String::as_str);
    let case = *CASES
        .iter()
        .find(|c| c.name == name)
        .ok_or("the cases are A, B and C")?;
    let steps: usize = arguments
        .get(1)
        .map_or(Ok(200), |s| s.parse())
        .unwrap_or(200);
    let repeats: usize = value("repeats", "5").parse()?;
    let warm: usize = value("warm", "200").parse()?;

    struct Variant {
        label: String,
        pool: rayon::ThreadPool,
        run: Run,
        seconds: Vec<f64>,
        neighbor: f64,
        cpu: f64,
        force: f64,
    }
    let mut variants = Vec::new();
    for threads in value("threads", "1").split(',') {
        for precision in value("precision", "double,mixed").split(',') {
            for isa in value("isa", "auto").split(',') {
                for skin in value("skin", "auto").split(',') {
                    let kernel = KernelOptions {
                        precision: match precision {
                            "mixed" => Precision::Mixed,
                            _ => Precision::Double,
                        },
                        isa: match isa {
                            "avx512" => Isa::Avx512,
                            "avx2" => Isa::Avx2,
                            "portable" => Isa::Portable,
                            _ => Isa::Auto,
                        },
                        kernel: match value("kernel", "auto").as_str() {
                            "rows" => Kernel::Rows,
                            "tiles" => Kernel::Tiles,
                            _ => Kernel::Auto,
                        },
                    };
                    let pool = rayon::ThreadPoolBuilder::new()
                        .num_threads(threads.parse()?)
                        .build()?;
                    let mut run = pool
                        .install(|| case.start(kernel, skin.parse().ok(), TruncationKind::Cut))?;
                    pool.install(|| run.steps(warm, Want::NOTHING))?;
                    variants.push(Variant {
                        label: format!("{threads} threads, {precision}, {isa}, skin {skin}"),
                        pool,
                        run,
                        seconds: Vec::new(),
                        neighbor: 0.0,
                        cpu: f64::INFINITY,
                        force: 0.0,
                    });
                }
            }
        }
    }
    for _ in 0..repeats {
        for v in &mut variants {
            let before = v.run.provider.statistics();
            let start = Instant::now();
            let cpu = v.pool.install(|| {
                let before = seconds_on_cpu();
                lennard_core::parallel::awake(|| v.run.steps(steps, Want::NOTHING))?;
                Ok::<f64, lennard_core::ForceError>(seconds_on_cpu() - before)
            })?;
            let seconds = start.elapsed().as_secs_f64();
            v.cpu = v.cpu.min(cpu);
            let after = v.run.provider.statistics();
            if v.seconds.iter().all(|s| seconds < *s) {
                v.neighbor = after.neighbor_seconds - before.neighbor_seconds;
                v.force = after.force_seconds - before.force_seconds;
            }
            v.seconds.push(seconds);
        }
    }
    for v in &mut variants {
        v.seconds.sort_by(f64::total_cmp);
        let atom_steps = (case.n_atoms() * steps) as f64;
        let best = v.seconds[0];
        let median = v.seconds[v.seconds.len() / 2];
        let s = v.run.provider.statistics();
        println!(
            "{name} {}: best {:.2} M/s ({:.1} ns: force {:.1}, list {:.1}), cpu of one thread {:.1} ns, median {:.2} M/s; skin {:.3}, {:.1} steps a build, {:.1} pairs listed and {:.0} bytes an atom, T {:.3}",
            v.label,
            atom_steps / best / 1e6,
            best / atom_steps * 1e9,
            v.force / atom_steps * 1e9,
            v.neighbor / atom_steps * 1e9,
            v.cpu / atom_steps * 1e9,
            atom_steps / median / 1e6,
            s.skin,
            s.evaluations as f64 / s.builds as f64,
            s.listed_pairs as f64 / case.n_atoms() as f64,
            s.bytes as f64 / case.n_atoms() as f64,
            v.run.temperature(),
        );
    }
    Ok(())
}

/// Seconds that the calling thread has been on a processor, where the system says so: on a shared machine
/// a steadier measure than the clock.
fn seconds_on_cpu() -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|s| s.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(f64::NAN, |ns| ns * 1e-9)
}
