//! Private copies of the positions, in the layout and the order that a loop reads them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use lennard_core::tasks::{for_each_task, map_tasks};
use lennard_neighbor::{MANY, Way};

use crate::simd::{By, ChunkTotals, Moved, Next, Scatter, Strayed, Wanted};
use crate::sums::Totals;

/// Whether a list may be used at some positions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fitness {
    /// It names every pair that counts.
    Fit,
    /// It lacks a few, of the particles at these places.
    Lacks(Vec<[u32; 2]>),
    /// It may miss one.
    Stale,
    /// A position is not a finite number.
    Broken,
}

/// Packing, by one thread or by all.
pub type Pack<'a, Row> = dyn Fn(By, &mut [Row], Option<&mut [Way]>) -> Moved + Sync + 'a;

/// A chunk, run.
pub type Run<'a, Row> = dyn Fn(&[Row], Option<&Next<'_, Row>>, usize) -> ChunkTotals + Sync + 'a;

/// What is known of the rows of some positions before they are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Nothing: they must be packed, and the list judged.
    Nothing,
    /// The chunks of the step before packed them; the list must be judged.
    Packed,
    /// They were packed and the list was judged just now, which names by now what it lacked.
    Judged,
}

/// One use of a list.
#[derive(Debug, Clone, Copy)]
pub struct Use {
    /// What is summed.
    pub wanted: Wanted,
    /// What is known of the rows.
    pub known: Known,
    /// Whether chunks pack the rows of the next step; not of few particles.
    pub packs_next: bool,
}

impl Use {
    /// One for these sums alone.
    pub fn of(wanted: Wanted) -> Self {
        Self {
            wanted,
            known: Known::Nothing,
            packs_next: false,
        }
    }
}

/// What a loop over a list does at some positions.
pub struct Work<'a, Row> {
    /// Particles.
    pub n: usize,
    /// Rows, ghosts included.
    pub rows: usize,
    /// Chunks of the list.
    pub chunks: usize,
    /// What it does.
    pub used: Use,
    /// Whether the list lasts until many have moved far, since it takes in the pairs that it lacks.
    pub lasts: bool,
    /// Writes all rows, and ways where they are wanted, and gives the displacements since the build.
    pub pack: &'a Pack<'a, Row>,
    /// Judges the list by displacements, and by ways where they were written: with or without them the same.
    pub judge: &'a (dyn Fn(&Moved, Option<&[Way]>) -> Fitness + Sync),
    /// Runs a chunk, which packs the next rows where they are wanted.
    pub run: &'a Run<'a, Row>,
}

/// Whether so many particles are so few that each thread packs them all for itself, before its first chunk, while others may
/// be at theirs.
pub fn are_few(n: usize) -> bool {
    n <= 2048
}

/// One copy that all threads read, and maybe another that they write for the next step; or, where particles are so few that
/// one thread packs them all, one for each.
///
/// Few particles are packed faster than their rows, ghosts among them, come from another processor's cache, and all
/// is done in one parallel section. Nothing but speed depends on it.
#[derive(Debug)]
pub struct Copies<Row>(Vec<Mutex<Packed<Row>>>);

/// What one thread packs.
#[derive(Debug, Default)]
struct Packed<Row> {
    rows: Vec<Row>,
    /// Rows of the next step, where chunks pack them.
    next: Vec<Row>,
    /// How far the particles of each chunk have moved, where chunks pack rows.
    strayed: Vec<Strayed>,
    /// How the particle at each place moved since the build, where that was wanted.
    ways: Vec<Way>,
    /// Whether it was, when rows were packed.
    has_ways: bool,
    /// How many had moved far at the last time.
    far: usize,
}

/// Ways of [`MANY`] particles are written, for a list that lasts, where one of so many had moved far at the last time: to look
/// ahead of fewer takes less time than to write all ways. Nothing but speed depends on it.
const WAYS_AMONG: usize = 256;

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
            .map(lock)
            .map(|packed| {
                (packed.rows.capacity() + packed.next.capacity()) * size_of::<Row>()
                    + packed.strayed.capacity() * size_of::<Strayed>()
                    + packed.ways.capacity() * size_of::<Way>()
            })
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
        let (mut packed, fitness) = match work.used.known {
            Known::Nothing => self.pack(0, By::All, work),
            Known::Packed => self.take_next(work),
            Known::Judged => (lock(&self.0[0]), Fitness::Fit),
        };
        if fitness != Fitness::Fit {
            return (fitness, Totals::NOTHING, false);
        }
        let (rows, next) = packed.for_chunks(work);
        let (totals, broken) = sum_chunks(work, &|(), c| (work.run)(rows, next.as_ref(), c));
        (Fitness::Fit, totals, broken)
    }

    /// Each thread packs a copy of its own before its first chunk, and all come to the same judgement.
    fn run_few<'a>(&'a self, work: &Work<'_, Row>) -> (Fitness, Totals, bool) {
        let fitness = OnceLock::new();
        let run = |mine: &mut Option<MutexGuard<'a, Packed<Row>>>, c: usize| {
            let packed = mine.get_or_insert_with(|| {
                let me = rayon::current_thread_index().unwrap_or(0);
                // Each thread judges by itself, alike: waiting for another may mean to sleep.
                let (packed, judged) = self.pack(me % self.0.len(), By::OneThread, work);
                let _ = fitness.set(judged);
                packed
            });
            match fitness.get() {
                Some(Fitness::Fit) => (work.run)(&packed.rows, None, c),
                _ => ChunkTotals::NOTHING,
            }
        };
        let (totals, broken) = sum_chunks(work, &run);
        // Without particles, nothing is missed.
        let fitness = fitness.into_inner().unwrap_or(Fitness::Fit);
        (fitness, totals, broken)
    }

    /// Packs a copy and judges the list.
    fn pack(
        &self,
        copy: usize,
        by: By,
        work: &Work<'_, Row>,
    ) -> (MutexGuard<'_, Packed<Row>>, Fitness) {
        let mut packed = lock(&self.0[copy]);
        packed.rows.resize(work.rows, Row::default());
        packed.strayed.clear();
        packed.begin_ways(work);
        let has_ways = packed.has_ways;
        let Packed { rows, ways, .. } = &mut *packed;
        let moved = (work.pack)(by, rows, has_ways.then_some(ways));
        let fitness = packed.judge(&moved, work);
        (packed, fitness)
    }

    /// Takes the rows that chunks packed, and judges the list.
    fn take_next(&self, work: &Work<'_, Row>) -> (MutexGuard<'_, Packed<Row>>, Fitness) {
        let mut packed = lock(&self.0[0]);
        let Packed { rows, next, .. } = &mut *packed;
        std::mem::swap(rows, next);
        let moved = Strayed::all(&packed.strayed);
        let fitness = packed.judge(&moved, work);
        (packed, fitness)
    }
}

impl<Row: Copy + Default + Send + Sync> Packed<Row> {
    /// Sees to it that ways can be written, where they are wanted.
    fn begin_ways(&mut self, work: &Work<'_, Row>) {
        self.has_ways = work.lasts && work.n >= MANY && self.far * WAYS_AMONG > work.n;
        if self.has_ways {
            self.ways.resize(work.n, Way::default());
        }
    }

    fn judge(&mut self, moved: &Moved, work: &Work<'_, Row>) -> Fitness {
        self.far = moved.far.len();
        (work.judge)(moved, self.has_ways.then_some(&self.ways))
    }

    /// The rows that chunks read, and what they write for the next step.
    fn for_chunks(&mut self, work: &Work<'_, Row>) -> (&[Row], Option<Next<'_, Row>>) {
        if work.used.packs_next {
            self.next.resize(work.rows, Row::default());
            self.strayed.resize(work.chunks, Strayed::UNKNOWN);
            self.begin_ways(work);
        }
        let next = work.used.packs_next.then(|| Next {
            rows: Scatter::new(&mut self.next),
            strayed: Scatter::new(&mut self.strayed),
            ways: self.has_ways.then(|| Scatter::new(&mut self.ways)),
        });
        (&self.rows, next)
    }
}

/// Nobody ever waits: each thread has a copy of its own, or one thread locks for all.
fn lock<Row>(packed: &Mutex<Packed<Row>>) -> MutexGuard<'_, Packed<Row>> {
    packed.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs all chunks and adds their totals in order; whether a force was not finite comes second. One
/// instance for all potentials: the loop over chunks is not worth another.
fn sum_chunks<Row, S: Default>(
    work: &Work<'_, Row>,
    run: &(dyn Fn(&mut S, usize) -> ChunkTotals + Sync),
) -> (Totals, bool) {
    if work.used.wanted == Wanted::Forces {
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
