//! Copies of the positions, packed into rows in the order of a list, and the loop over all chunks.
//!
//! ```text
//!   many particles:  pack (all threads) -> judge the list -> run chunks (all threads)
//!   few particles:   each thread: pack its own copy -> judge -> run chunks
//! ```

use std::slice;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use lennard_core::Team;
use lennard_core::tasks::{for_each_task, map_tasks};
use lennard_neighbor::{LARGE_SYSTEM, PackedDisplacement};

use super::disjoint::Disjoint;
use super::fused::{ChunkDisplacement, NextRows};
use super::list_in_use::{ListInUse, ListStatus, Ordered};
use super::motion::{MotionSummary, SomeRows};
use super::pack::Threads;
use super::packed_list::PackedList;
use super::row::Row;
use crate::part::Part;
use crate::sums::{Detail, Totals};

/// The state of the rows before an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prepared {
    /// Rows must be packed, and the list must be judged.
    Nothing,
    /// The chunks of the step before packed the rows. The list must be judged.
    Packed,
    /// Rows are packed and the list was judged. The pairs that it lacked have been inserted.
    Judged,
}

/// What an evaluation is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// The quantities to sum.
    pub detail: Detail,
    /// The state of the rows.
    pub prepared: Prepared,
    /// Whether chunks pack the rows of the next step; few particles never do.
    pub packs_next: bool,
}

impl Request {
    /// A request for sums at new positions.
    pub fn of(detail: Detail) -> Self {
        Self { detail, prepared: Prepared::Nothing, packs_next: false }
    }
}

/// The result of an evaluation.
pub struct Outcome {
    /// Whether the list could be used. If not, there are no sums.
    pub status: ListStatus,
    /// The totals of all chunks of this rank: every pair from both of its ends. Empty where only forces are summed.
    pub totals: Vec<Totals>,
    /// Whether a force is not finite.
    pub broken: bool,
}

impl Outcome {
    /// No sums.
    fn without_sums(status: ListStatus) -> Self {
        Self { status, totals: Vec::new(), broken: false }
    }

    /// The status, and the totals over all pairs that `detail` asks for. Each rank of a team has some chunks.
    pub fn summed(self, detail: Detail, team: Option<&Team>) -> (ListStatus, Totals) {
        let has_totals = detail != Detail::Forces && self.status == ListStatus::Complete;
        let totals =
            if has_totals { Totals::of_chunks(&self.totals, team) } else { Totals::NOTHING };
        (self.status, Totals { broken: self.broken, ..totals })
    }
}

/// Runs one chunk over rows, and packs its rows of the next step where asked.
pub type RunChunk<'a, Row> =
    dyn Fn(&[Row], Option<&NextRows<'_, Row>>, usize) -> Totals + Sync + 'a;

/// One pass over the chunks of a list.
pub struct Pass<'a, 'p, P: PackedList> {
    /// The list.
    pub used: &'a ListInUse<'a, P>,
    /// What the pass is asked for.
    pub request: Request,
    /// Gives the positions. It is called while rows are packed and while the list is judged.
    pub at: &'a (dyn Fn() -> Ordered<'p> + Sync),
    /// Runs a chunk.
    pub run: &'a RunChunk<'a, P::Row>,
}

impl<P: PackedList> Pass<'_, '_, P> {
    /// Number of particles of all ranks.
    fn whole(&self) -> usize {
        self.used.list.whole()
    }

    /// Packs some rows, and packed displacements where given.
    fn pack(
        &self,
        by: Threads,
        which: SomeRows<'_>,
        rows: &mut [P::Row],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary {
        let motion = self.used.motion((self.at)());
        self.used.list.pack(self.used.level, by, motion, which, rows, packed)
    }
}

/// Whether particles are so few that each thread packs all of them for itself.
///
/// It packs before its first chunk, while other threads may already run chunks.
pub fn are_few(n: usize) -> bool {
    n <= 2048
}

/// Packed copies of the positions.
///
/// Many particles have one copy that all threads read, and a second one where chunks pack the rows of the next step.
/// Few particles have one copy per thread. A thread packs them faster than their rows come from the cache of another
/// processor, and one parallel section does everything. Only speed depends on it.
#[derive(Debug)]
pub struct PackedCopies<Row>(Vec<Mutex<PackedCopy<Row>>>);

/// One copy.
#[derive(Debug, Default)]
struct PackedCopy<Row> {
    rows: Vec<Row>,
    /// Rows of the next step, where chunks pack ahead.
    next: Vec<Row>,
    /// The displacements of each chunk, where chunks pack ahead.
    displacements: Vec<ChunkDisplacement>,
    /// The packed displacement of each slot, where `has_packed`.
    packed: Vec<PackedDisplacement>,
    /// Whether packed displacements were written with the rows.
    has_packed: bool,
    /// Number of far movers at the last judgment.
    far: usize,
}

/// Displacements are packed in large systems once one particle in this many had moved far at the last judgment.
///
/// Below it, the look ahead takes less time than packing all displacements. Nothing but speed depends on it.
const PACKED_AMONG: usize = 256;

/// Inner chunks between two calls that move messages on: a call takes less than a chunk.
const CHUNKS_A_CALL: usize = 8;

impl<Row> Default for PackedCopies<Row> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<R: Row> PackedCopies<R> {
    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        self.0
            .iter()
            .map(lock)
            .map(|copy| {
                (copy.rows.capacity() + copy.next.capacity()) * size_of::<R>()
                    + copy.displacements.capacity() * size_of::<ChunkDisplacement>()
                    + copy.packed.capacity() * size_of::<PackedDisplacement>()
            })
            .sum()
    }

    /// The room of the rows of one copy.
    pub fn rows(&mut self) -> &mut Vec<R> {
        if self.0.is_empty() {
            self.0.push(Mutex::default());
        }
        let copy = self.0[0].get_mut();
        &mut copy.unwrap_or_else(PoisonError::into_inner).rows
    }

    /// Packs, judges, and runs each chunk exactly once where the list is complete.
    pub fn run<P: PackedList<Row = R>>(&mut self, pass: &Pass<'_, '_, P>) -> Outcome {
        let few = are_few(pass.whole());
        let copies = if few { rayon::current_num_threads() } else { 1 };
        self.0.resize_with(copies, Mutex::default);
        if few {
            return self.run_few(pass);
        }
        let (mut copy, status) = match pass.request.prepared {
            Prepared::Nothing => self.pack(0, Threads::All, pass),
            Prepared::Packed => self.take_next(pass),
            Prepared::Judged => (lock(&self.0[0]), ListStatus::Complete),
        };
        if status != ListStatus::Complete {
            return Outcome::without_sums(status);
        }
        match pass.used.part {
            None => copy.run(pass, pass.used.list.chunk_slots().count(), |c| c),
            Some(part) => copy.run_part(pass, part),
        }
    }

    /// Each thread packs a copy of its own before its first chunk, and all threads come to the same judgment.
    fn run_few<'a, P: PackedList<Row = R>>(&'a self, pass: &Pass<'_, '_, P>) -> Outcome {
        let status = OnceLock::new();
        let run = |mine: &mut Option<MutexGuard<'a, PackedCopy<R>>>, c: usize| {
            let copy = mine.get_or_insert_with(|| {
                let me = rayon::current_thread_index().unwrap_or(0);
                // Each thread judges for itself: waiting for another thread may put it to sleep.
                let (copy, judged) = self.pack(me % self.0.len(), Threads::One, pass);
                let _ = status.set(judged);
                copy
            });
            match status.get() {
                Some(ListStatus::Complete) => (pass.run)(&copy.rows, None, c),
                _ => Totals::NOTHING,
            }
        };
        let mut outcome =
            run_chunks(pass.request.detail, pass.used.list.chunk_slots().count(), &run);
        // Without particles no thread judges, and no pair is missing.
        if let Some(judged) = status.into_inner() {
            outcome.status = judged;
        }
        outcome
    }

    /// Packs a copy and judges the list.
    fn pack<P: PackedList<Row = R>>(
        &self,
        copy: usize,
        by: Threads,
        pass: &Pass<'_, '_, P>,
    ) -> (MutexGuard<'_, PackedCopy<R>>, ListStatus) {
        let mut copy = lock(&self.0[copy]);
        let list = pass.used.list;
        copy.rows.resize(list.rows(), R::default());
        copy.displacements.clear();
        copy.begin_packed(pass);
        let has_packed = copy.has_packed;
        let PackedCopy { rows, packed, .. } = &mut *copy;
        let all = [0..list.own(), 0..list.slots_of_ghosts().len()];
        let [slots, ghosts] = all.each_ref().map(slice::from_ref);
        let own = pass.used.part.map_or(SomeRows { slots, ghosts }, |part| part.rows(0));
        let summary = pass.pack(by, own, rows, has_packed.then_some(packed));
        let status = copy.judge(&summary, pass);
        (copy, status)
    }

    /// Takes the rows that chunks packed ahead, and judges the list.
    fn take_next<P: PackedList<Row = R>>(
        &self,
        pass: &Pass<'_, '_, P>,
    ) -> (MutexGuard<'_, PackedCopy<R>>, ListStatus) {
        let mut copy = lock(&self.0[0]);
        let PackedCopy { rows, next, .. } = &mut *copy;
        std::mem::swap(rows, next);
        let slots = pass.used.list.chunk_slots();
        let summary = ChunkDisplacement::summary(&copy.displacements, |c| slots.of(c..c + 1).start);
        let status = copy.judge(&summary, pass);
        (copy, status)
    }
}

impl<R: Row> PackedCopy<R> {
    /// Decides whether displacements are packed, and makes room for them.
    fn begin_packed<P: PackedList<Row = R>>(&mut self, pass: &Pass<'_, '_, P>) {
        let n = pass.whole();
        self.has_packed = P::INSERTS
            && pass.used.part.is_none()
            && n >= LARGE_SYSTEM
            && self.far * PACKED_AMONG > n;
        if self.has_packed {
            self.packed.resize(n, PackedDisplacement::default());
        }
    }

    fn judge<P: PackedList<Row = R>>(
        &mut self,
        summary: &MotionSummary,
        pass: &Pass<'_, '_, P>,
    ) -> ListStatus {
        self.far = summary.far.len();
        let packed = self.has_packed.then_some(&self.packed[..]);
        pass.used.judge(summary, packed, pass.at)
    }

    /// Runs so many chunks over the rows, where `chunk` gives the number of each.
    fn run<P: PackedList<Row = R>>(
        &mut self,
        pass: &Pass<'_, '_, P>,
        chunks: usize,
        chunk: impl Fn(usize) -> usize + Sync,
    ) -> Outcome {
        let packs_next = pass.request.packs_next;
        if packs_next {
            self.next.resize(pass.used.list.rows(), R::default());
            let all = pass.used.list.chunk_slots().count();
            self.displacements.resize(all, ChunkDisplacement::UNKNOWN);
            self.begin_packed(pass);
        }
        let next = packs_next.then(|| NextRows {
            rows: Disjoint::new(&mut self.next),
            displacements: Disjoint::new(&mut self.displacements),
            packed: self.has_packed.then(|| Disjoint::new(&mut self.packed)),
        });
        let rows = &self.rows;
        run_chunks(pass.request.detail, chunks, &|(), k| (pass.run)(rows, next.as_ref(), chunk(k)))
    }

    /// Runs the chunks of this rank: the inner ones while the rows of the halo come, and then the outer ones.
    fn run_part<P: PackedList<Row = R>>(&mut self, pass: &Pass<'_, '_, P>, part: &Part) -> Outcome {
        let [inner, outer] = part.inner_and_outer();
        let mut first = Outcome::without_sums(ListStatus::Complete);
        let inner_chunk = |k: usize| {
            if k.is_multiple_of(CHUNKS_A_CALL) {
                part.team().progress();
            }
            inner[k] as usize
        };
        let list = pass.used.list;
        let mut mail = part.mail(R::WORDS);
        mail.send(|slot, to| self.rows[list.row_of(slot)].send(to));
        mail.exchange(&mut || first = self.run(pass, inner.len(), inner_chunk));
        let motion = pass.used.motion((pass.at)());
        let rows = Disjoint::new(&mut self.rows);
        mail.receive(|slot, from| {
            // SAFETY: each slot comes once, and slots have distinct rows.
            unsafe { rows.write(list.row_of(slot), R::receive(from, &motion, slot)) };
        });
        drop(mail);
        pass.pack(Threads::All, part.rows(1), &mut self.rows, None);
        let mut both = self.run(pass, outer.len(), |k| outer[k] as usize);
        both.totals.append(&mut first.totals);
        both.broken |= first.broken;
        both
    }
}

/// Locks a copy. No thread ever waits: each thread has a copy of its own, or one thread locks for all.
fn lock<Row>(copy: &Mutex<PackedCopy<Row>>) -> MutexGuard<'_, PackedCopy<Row>> {
    copy.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs so many chunks once each. One instance serves all potentials, since the loop over chunks is short.
fn run_chunks<S: Default>(
    detail: Detail,
    chunks: usize,
    run: &(dyn Fn(&mut S, usize) -> Totals + Sync),
) -> Outcome {
    if detail == Detail::Forces {
        let broken = AtomicBool::new(false);
        for_each_task(chunks, |scratch, c| {
            if run(scratch, c).broken {
                broken.store(true, Ordering::Relaxed);
            }
        });
        return Outcome {
            broken: broken.into_inner(),
            ..Outcome::without_sums(ListStatus::Complete)
        };
    }
    let totals = map_tasks(chunks, run);
    let broken = totals.iter().any(|c| c.broken);
    Outcome { status: ListStatus::Complete, totals, broken }
}
