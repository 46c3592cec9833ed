//! The force loop alone (the list is given) and whole steps, for each precision.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lennard_benches::CASES;
use lennard_core::Want;
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

fn force_loop(c: &mut Criterion) {
    for case in &CASES[..2] {
        let mut group = c.benchmark_group(format!("force loop {}", case.name));
        group.throughput(Throughput::Elements(case.n_atoms() as u64));
        for precision in [Precision::Double, Precision::Mixed] {
            let kernel = KernelOptions {
                precision,
                ..KernelOptions::default()
            };
            let mut run = case
                .start(kernel, None, TruncationKind::Cut)
                .expect("auto runs everywhere");
            run.steps(200, Want::NOTHING).expect("finite forces");
            for (name, want) in [("forces", Want::NOTHING), ("totals", Want::TOTALS)] {
                group.bench_function(format!("{precision:?} {name}"), |b| {
                    b.iter(|| run.evaluate(want).expect("finite forces"));
                });
            }
        }
    }
}

criterion_group!(benches, force_loop);
criterion_main!(benches);
