//! Measurements of the force field for benchmarks: parts of a step on their own, and the speed limit of the processor.
//!
//! Nothing here decides anything about a run.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use lennard_core::{Configuration, ForceError, ForceTerm, Part, Want};

use crate::options::Precision;
use crate::pair::TruncationOptions;
use crate::provider::PairForces;
use crate::simd::{Isa, Level, limit};

/// Best times of the parts of a step, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartTimes {
    /// One evaluation of forces with a valid list: packing, check and pair loop.
    pub forces: f64,
    /// The same with energy, virial and Laplacian.
    pub totals: f64,
    /// One build of the list; 0 where there is none.
    pub build: f64,
}

/// The number of pairs that a loop computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Lanes computed in one evaluation, padding included; a full list contains each pair twice.
    pub lanes: u64,
    /// Pairs with r ≤ r_cut, each counted once.
    pub pairs: u64,
}

/// Times the parts of a step at these positions: the best of `rounds`.
///
/// # Errors
/// [`ForceError`] where a position or a force is not finite.
pub fn part_times(
    forces: &mut PairForces,
    at: Configuration<'_>,
    rounds: usize,
) -> Result<PartTimes, ForceError> {
    let mut out = vec![DVec3::ZERO; at.positions.len()];
    forces.rebuild(at)?;
    let mut best = PartTimes { forces: f64::INFINITY, totals: f64::INFINITY, build: f64::INFINITY };
    for _ in 0..rounds.max(1) {
        let mut evaluation = |want| -> Result<f64, ForceError> {
            let clock = Instant::now();
            black_box(forces.evaluate(at, Part::All, want, &mut out)?);
            Ok(clock.elapsed().as_secs_f64())
        };
        best.forces = best.forces.min(evaluation(Want::NOTHING)?);
        best.totals = best.totals.min(evaluation(Want::TOTALS)?);
        let clock = Instant::now();
        let is_built = forces.rebuild(at)?;
        let seconds = clock.elapsed().as_secs_f64();
        best.build = best.build.min(if is_built { seconds } else { 0.0 });
    }
    Ok(best)
}

/// Counts the pairs computed and the pairs that count at these positions.
///
/// # Errors
/// [`ForceError`] where a position or a force is not finite.
pub fn work(forces: &mut PairForces, at: Configuration<'_>) -> Result<Work, ForceError> {
    let mut out = vec![DVec3::ZERO; at.positions.len()];
    let totals = forces.evaluate(at, Part::All, Want::ENERGY, &mut out)?;
    Ok(Work { lanes: forces.lanes(), pairs: totals.pairs.unwrap_or_default() })
}

/// The pairs per second that one thread computes with everything in registers, without a list and without memory.
///
/// The force is Lennard-Jones, with the instructions of the pair loop. The result is the best of a few short runs.
/// `None` where this processor lacks the instruction set.
#[must_use]
pub fn arithmetic_limit(isa: Isa, precision: Precision) -> Option<f64> {
    /// Rounds of one run, a few milliseconds.
    const ROUNDS: u64 = 100_000;
    /// Runs.
    const RUNS: usize = 9;
    let level = Level::choose(isa)?;
    let r_cut = TruncationOptions::default().r_cut;
    let best = (0..RUNS)
        .map(|_| {
            let clock = Instant::now();
            let (pairs, sum) = limit(level, precision, r_cut, ROUNDS);
            let seconds = clock.elapsed().as_secs_f64();
            black_box(sum);
            pairs as f64 / seconds
        })
        .fold(0.0, f64::max);
    Some(best)
}
