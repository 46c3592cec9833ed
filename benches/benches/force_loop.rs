//! The force loop alone (the list is given), the list build alone, and whole steps, for each precision.
#![allow(missing_docs)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use lennard_benches::{CASES, Case, Run};
use lennard_core::Want;
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

/// Steps after which the lattice has melted enough to be a liquid's neighborhood.
const WARM: usize = 200;
/// Whole steps in one measurement: several lives of a list.
const STEPS: usize = 20;

/// A case under way in each precision, with its name.
fn runs(case: &Case) -> Vec<(&'static str, Run)> {
    [("double", Precision::Double), ("mixed", Precision::Mixed)]
        .map(|(name, precision)| {
            let kernel = KernelOptions {
                precision,
                ..KernelOptions::default()
            };
            let run = case.start(kernel, None, TruncationKind::Cut);
            let mut run = run.expect("auto runs everywhere");
            run.steps(WARM, Want::NOTHING).expect("finite forces");
            (name, run)
        })
        .into()
}

fn force_loop(c: &mut Criterion) {
    for case in &CASES[..2] {
        let mut group = c.benchmark_group(format!("force loop {}", case.name));
        group.throughput(Throughput::Elements(case.n_atoms() as u64));
        for (precision, mut run) in runs(case) {
            for (name, want) in [("forces", Want::NOTHING), ("totals", Want::TOTALS)] {
                group.bench_function(format!("{precision} {name}"), |b| {
                    b.iter(|| run.evaluate(want).expect("finite forces"));
                });
            }
        }
    }
}

/// A provider that was never asked builds its list at its first evaluation: what that takes beyond the force loop above
/// is the build, with the first touch of its memory.
fn list_build(c: &mut Criterion) {
    for case in &CASES[..2] {
        let mut group = c.benchmark_group(format!("list build and one evaluation {}", case.name));
        group.throughput(Throughput::Elements(case.n_atoms() as u64));
        for (precision, mut run) in runs(case) {
            let fresh = run.fresh_providers();
            group.bench_function(precision, |b| {
                b.iter_batched(
                    || fresh().expect("it was built before"),
                    |mut provider| run.evaluate_with(&mut provider).expect("finite forces"),
                    BatchSize::LargeInput,
                );
            });
        }
    }
}

fn whole_steps(c: &mut Criterion) {
    for case in &CASES[..2] {
        let mut group = c.benchmark_group(format!("whole steps {}", case.name));
        group.throughput(Throughput::Elements((case.n_atoms() * STEPS) as u64));
        for (precision, mut run) in runs(case) {
            group.bench_function(precision, |b| {
                b.iter(|| run.steps(STEPS, Want::NOTHING).expect("finite forces"));
            });
        }
    }
}

criterion_group!(benches, force_loop, list_build, whole_steps);
criterion_main!(benches);
