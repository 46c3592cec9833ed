//! Packing by all threads or by one: the loops of [`super::packing`] for the instruction set of a level.

use std::ops::Range;

use glam::DVec3;
use lennard_core::parallel::map_ranges;
use lennard_neighbor::{ColumnTable, PackedDisplacement, RowTable};

use super::disjoint::Disjoint;
use super::level::Level;
use super::motion::{BATCH, Motion, MotionSummary, SomeRows};
use super::packing;
#[cfg(target_arch = "x86_64")]
use super::packing256;
use super::row::{DoubleRow, FixedRow};

/// The threads that pack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// The calling thread.
    One,
    /// All threads of the pool.
    All,
}

/// Shorter runs than this, among others, are packed by one thread.
const SHORT_RUN: usize = 1024;

/// Writes some rows in double precision, first slots and then ghosts, and packed displacements where given; summarizes the
/// motion of the slots.
pub fn pack_double(
    level: Level,
    by: Threads,
    table: &RowTable,
    (motion, which): (Motion<'_>, SomeRows<'_>),
    rows: &mut [DoubleRow],
    packed: Option<&mut [PackedDisplacement]>,
) -> MotionSummary {
    let rows = Disjoint::new(rows);
    // SAFETY: tasks have disjoint slots, slots have distinct rows, and ghosts are written afterwards.
    let pack = |motion: Motion<'_>, first, squares: &mut [f64]| unsafe {
        match level.avx2() {
            // SAFETY: as above; the token proves AVX2.
            #[cfg(target_arch = "x86_64")]
            Some(_) => packing256::pack_double(table, motion, first, squares, &rows),
            _ => packing::pack_double(table, motion, first, squares, &rows),
        }
    };
    let summary = pack_slots(level, by, (motion, which.slots), packed, pack);
    // SAFETY: tasks have disjoint ghosts, and all other rows are at rest.
    in_tasks(by, which.ghosts, |ghosts| unsafe {
        pack_ghosts(level, table, motion.lengths, ghosts, &rows);
        MotionSummary::NOTHING
    });
    summary
}

/// Writes some ghosts; see [`packing::pack_ghosts`].
///
/// # Safety
/// As [`packing::pack_ghosts`].
unsafe fn pack_ghosts(
    level: Level,
    table: &RowTable,
    lengths: DVec3,
    ghosts: Range<usize>,
    rows: &Disjoint<'_, DoubleRow>,
) {
    // SAFETY: the contract is passed on; the token proves AVX2.
    unsafe {
        match level.avx2() {
            #[cfg(target_arch = "x86_64")]
            Some(_) => packing256::pack_ghosts(table, lengths, ghosts, rows),
            _ => packing::pack_ghosts(table, lengths, ghosts, rows),
        }
    }
}

/// Writes the rows of some slots in fixed point; as [`pack_double`].
pub fn pack_fixed(
    level: Level,
    by: Threads,
    table: &ColumnTable,
    (motion, which): (Motion<'_>, SomeRows<'_>),
    rows: &mut [FixedRow],
    packed: Option<&mut [PackedDisplacement]>,
) -> MotionSummary {
    let rows = Disjoint::new(rows);
    // SAFETY: tasks have disjoint slots.
    let pack = |motion: Motion<'_>, first, squares: &mut [f64]| unsafe {
        pack_fixed_part(level, table, motion, first, Some(squares), &rows);
    };
    pack_slots(level, by, (motion, which.slots), packed, pack)
}

/// Writes the rows of some slots in fixed point; see [`packing::pack_fixed`].
///
/// # Safety
/// As [`packing::pack_fixed`].
pub unsafe fn pack_fixed_part(
    level: Level,
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    squares: Option<&mut [f64]>,
    rows: &Disjoint<'_, FixedRow>,
) {
    // SAFETY: the contract is passed on; the token proves AVX2.
    unsafe {
        match level.avx2() {
            #[cfg(target_arch = "x86_64")]
            Some(_) => packing256::pack_fixed(table, motion, first, squares, rows),
            _ => packing::pack_fixed(table, motion, first, squares, rows),
        }
    }
}

/// Writes packed displacements; see [`packing::pack_displacements`].
pub fn pack_displacements(
    level: Level,
    motion: Motion<'_>,
    squares: &[f64],
    to: &mut [PackedDisplacement],
) {
    match level.avx2() {
        // SAFETY: the token proves AVX2.
        #[cfg(target_arch = "x86_64")]
        Some(_) => unsafe { packing256::pack_displacements(motion, squares, to) },
        _ => packing::pack_displacements(motion, squares, to),
    }
}

/// Packs runs of slots in batches by `pack(motion, first, squares)`, which writes |d|² of each slot from `first` on.
fn pack_slots(
    level: Level,
    by: Threads,
    (motion, runs): (Motion<'_>, &[Range<usize>]),
    packed: Option<&mut [PackedDisplacement]>,
    pack: impl Fn(Motion<'_>, usize, &mut [f64]) + Sync,
) -> MotionSummary {
    let packed = packed.map(Disjoint::new);
    in_tasks(by, runs, |slots| {
        let mut summary = MotionSummary::NOTHING;
        let mut squares = [0.0; BATCH];
        for first in slots.clone().step_by(BATCH) {
            let batch = first..slots.end.min(first + BATCH);
            let squares = &mut squares[..batch.len()];
            let motion = motion.part(batch.clone());
            pack(motion, first, squares);
            summary.include(first, squares, motion.far2);
            if let Some(packed) = &packed {
                // SAFETY: tasks have disjoint slots.
                pack_displacements(level, motion, squares, unsafe { packed.part(batch) });
            }
        }
        summary
    })
}

/// Does tasks over runs of numbers, and takes their summaries together in the order of the runs.
fn in_tasks(
    by: Threads,
    runs: &[Range<usize>],
    task: impl Fn(Range<usize>) -> MotionSummary + Sync,
) -> MotionSummary {
    let mut all = MotionSummary::NOTHING;
    for run in runs {
        // Short runs are not worth waking another thread.
        if by == Threads::One || run.len() < SHORT_RUN && runs.len() > 1 {
            all = all.and(task(run.clone()));
            continue;
        }
        let offset = |part: Range<usize>| run.start + part.start..run.start + part.end;
        let parts = map_ranges(run.len(), |part| task(offset(part)));
        all = parts.into_iter().fold(all, MotionSummary::and);
    }
    all
}
