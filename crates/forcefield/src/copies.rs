//! Private copies of the positions, in the layout and the order that a loop reads them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use lennard_core::tasks::{for_each_task, map_tasks};

use crate::simd::{By, ChunkTotals, Moved, Wanted};
use crate::sums::Totals;

/// Whether a list may be used at some positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fitness {
    /// It names every pair that counts.
    Fit,
    /// It may miss one.
    Stale,
    /// A position is not a finite number.
    Broken,
}

/// What a loop over a list does at some positions.
pub struct Work<'a, Row> {
    /// Particles.
    pub n: usize,
    /// Rows, ghosts included.
    pub rows: usize,
    /// Chunks of the list.
    pub chunks: usize,
    /// What is summed.
    pub wanted: Wanted,
    /// Writes all rows and gives the displacements since the build.
    pub pack: &'a (dyn Fn(By, &mut [Row]) -> Moved + Sync),
    /// Judges the list by them: a pure function.
    pub judge: &'a (dyn Fn(&Moved) -> Fitness + Sync),
    /// Runs a chunk.
    pub run: &'a (dyn Fn(&[Row], usize) -> ChunkTotals + Sync),
}

/// Whether so many particles are so few that each thread packs them all for itself, before its first chunk, while others may
/// be at theirs.
pub fn are_few(n: usize) -> bool {
    n <= 2048
}

/// One copy that all threads read; or, where particles are so few that one thread packs them all, one for each.
///
/// Few particles are packed faster than their rows, ghosts among them, come from another processor's cache, and all
/// is done in one parallel section. Nothing but speed depends on it.
#[derive(Debug)]
pub struct Copies<Row>(Vec<Mutex<Vec<Row>>>);

impl<Row> Default for Copies<Row> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<Row: Copy + Default + Send + Sync> Copies<Row> {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.0
            .iter()
            .map(|rows| lock(rows).capacity() * size_of::<Row>())
            .sum()
    }

    /// Packs, judges, and runs all chunks where the list is fit. Gives the totals, and whether a force was not finite.
    pub fn run(&mut self, work: &Work<'_, Row>) -> (Fitness, Totals, bool) {
        let few = are_few(work.n);
        let copies = if few { rayon::current_num_threads() } else { 1 };
        self.0.resize_with(copies, Mutex::default);
        if few {
            return self.run_few(work);
        }
        let rows = self.pack(0, By::All, work);
        let (rows, moved) = (&*rows.0, rows.1);
        match (work.judge)(&moved) {
            Fitness::Fit => {
                let (totals, broken) = sum_chunks(work, &|(), c| (work.run)(rows, c));
                (Fitness::Fit, totals, broken)
            }
            unfit => (unfit, Totals::NOTHING, false),
        }
    }

    /// Each thread packs a copy of its own before its first chunk, and all come to the same judgement.
    fn run_few<'a>(&'a self, work: &Work<'_, Row>) -> (Fitness, Totals, bool) {
        let fitness = OnceLock::new();
        let run = |mine: &mut Option<MutexGuard<'a, Vec<Row>>>, c: usize| {
            let rows = mine.get_or_insert_with(|| {
                let me = rayon::current_thread_index().unwrap_or(0);
                let (rows, moved) = self.pack(me % self.0.len(), By::OneThread, work);
                // Each thread judges by itself, alike: waiting for another may mean to sleep.
                let _ = fitness.set((work.judge)(&moved));
                rows
            });
            match fitness.get() {
                Some(Fitness::Fit) => (work.run)(rows, c),
                _ => ChunkTotals::NOTHING,
            }
        };
        let (totals, broken) = sum_chunks(work, &run);
        // Without particles, nothing is missed.
        let fitness = fitness.into_inner().unwrap_or(Fitness::Fit);
        (fitness, totals, broken)
    }

    fn pack(&self, copy: usize, by: By, work: &Work<'_, Row>) -> (MutexGuard<'_, Vec<Row>>, Moved) {
        let mut rows = lock(&self.0[copy]);
        rows.resize(work.rows, Row::default());
        let moved = (work.pack)(by, &mut rows);
        (rows, moved)
    }
}

/// Nobody ever waits: each thread has a copy of its own, or one thread locks for all.
fn lock<Row>(rows: &Mutex<Vec<Row>>) -> MutexGuard<'_, Vec<Row>> {
    rows.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs all chunks and adds their totals in order; whether a force was not finite comes second. One
/// instance for all potentials: the loop over chunks is not worth another.
fn sum_chunks<Row, S: Default>(
    work: &Work<'_, Row>,
    run: &(dyn Fn(&mut S, usize) -> ChunkTotals + Sync),
) -> (Totals, bool) {
    if work.wanted == Wanted::Forces {
        let broken = AtomicBool::new(false);
        for_each_task(work.chunks, |scratch, c| {
            if run(scratch, c).broken {
                broken.store(true, Ordering::Relaxed);
            }
        });
        return (Totals::NOTHING, broken.into_inner());
    }
    let totals = map_tasks(work.chunks, run);
    (Totals::of_chunks(&totals), totals.iter().any(|c| c.broken))
}
