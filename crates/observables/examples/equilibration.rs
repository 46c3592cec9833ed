//! How often the search for equilibrium fails on series whose answer is known: the table of validation/results/equilibration.md.
//!
//!     cargo run --release -p lennard-observables --example equilibration
#![allow(clippy::print_stdout)] // printing is what it is for

use lennard_core::random::Streams;
use lennard_observables::statistics::{equilibration, estimate_after};
use rand_distr::{Distribution, StandardNormal};

/// Samples of a series.
const SAMPLES: usize = 2000;
/// Series of each kind.
const SERIES: u64 = 400;

/// A process x_{i+1} = φx_i + √(1 − φ²)ξ worth `independent` samples, with `height`·e^{−t/(decay·T)} added.
fn series(independent: f64, height: f64, decay: f64, seed: u64) -> Vec<f64> {
    let noise = Streams::new(seed).noise("equilibration");
    let normal = |i: u64| -> f64 { StandardNormal.sample(&mut noise.at(i, 0)) };
    let phi = (-2.0 * independent / SAMPLES as f64).exp();
    let mut x = normal(u64::MAX);
    (0..SAMPLES as u64)
        .map(|i| {
            x = phi * x + (1.0 - phi * phi).sqrt() * normal(i);
            x + height * (-(i as f64) / (decay * SAMPLES as f64)).exp()
        })
        .collect()
}

fn main() {
    println!(
        "| independent samples | height / σ | decay time / run | not in equilibrium | discarded | rest within 2 errors |"
    );
    println!("|---|---|---|---|---|---|");
    for independent in [50.0, 100.0, 500.0] {
        for (height, decay) in
            [(0.0, 1.0)].into_iter().chain([5.0, 10.0].into_iter().flat_map(|height| {
                [0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0].map(|decay| (height, decay))
            }))
        {
            let (mut complaints, mut cut, mut kept, mut within) = (0, 0.0, 0, 0);
            for seed in 0..SERIES {
                let x = series(independent, height, decay, seed);
                let found = equilibration(&x);
                if found.trend.is_some() {
                    complaints += 1;
                    continue;
                }
                kept += 1;
                cut += found.cut as f64 / SAMPLES as f64;
                let rest = estimate_after(&x, found.cut);
                within += u64::from(rest.mean.abs() < 2.0 * rest.standard_error);
            }
            let percent = |n: u64| format!("{:.1} %", 100.0 * n as f64 / SERIES as f64);
            let (part, share) = if kept == 0 {
                ("–".into(), "–".into())
            } else {
                (format!("{:.0} %", 100.0 * cut / kept as f64), format!("{within} of {kept}"))
            };
            let decay = if height == 0.0 { "–".into() } else { decay.to_string() };
            println!(
                "| {independent} | {height} | {decay} | {} | {part} | {share} |",
                percent(complaints)
            );
        }
    }
}
