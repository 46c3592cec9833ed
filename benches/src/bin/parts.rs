//! The parts of a step on the cases A and B, measured on their own: list build, force loop, sweeps; nanoseconds an atom.
#![allow(clippy::print_stdout)]

use lennard_benches::CASES;
use lennard_core::Want;
use lennard_forcefield::measure::{arithmetic_limit, part_times, work};
use lennard_forcefield::{Isa, KernelOptions, Precision, TruncationKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for case in &CASES[..2] {
        let rounds = 600_000 / case.n_atoms() + 10;
        for precision in [Precision::Double, Precision::Mixed] {
            let kernel = KernelOptions {
                precision,
                ..KernelOptions::default()
            };
            let mut run = case.start(kernel, Some(0.3), TruncationKind::Cut)?;
            run.steps(300, Want::NOTHING)?;
            let positions = run.positions.clone();
            let times = part_times(&mut run.provider, &positions, rounds)?;
            let work = work(&mut run.provider, &positions)?;
            let ns = 1e9 / case.n_atoms() as f64;
            let limit = arithmetic_limit(Isa::Auto, precision).unwrap_or(f64::NAN);
            let ideal = 2.0 * work.pairs as f64 / limit;
            println!(
                "{} {precision:?}: forces {:.1}, with totals {:.1}, list build {:.1} ns an atom; {:.2} lanes a pair that counts (twice, in a full list); arithmetic limit {:.0} M pairs/s, {:.1} ns an atom, reached to {:.0} %",
                case.name,
                times.forces * ns,
                times.totals * ns,
                times.build * ns,
                work.lanes as f64 / (2 * work.pairs) as f64,
                limit / 1e6,
                ideal * ns,
                100.0 * ideal / times.forces,
            );
        }
    }
    Ok(())
}
