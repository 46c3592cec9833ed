//! The loop over cluster lists, written once for all lanes.

use glam::DVec3;
use lennard_neighbor::{
    ATOMS_PER_CHUNK, Block, CLUSTER, ClusterChunk, ClusterList, ExcludedEntries, LARGE_SYSTEM, Span,
};

use super::accumulate::{CommonSums, Units};
use super::block_stream::BlockStream;
use super::cluster_kernel::{BlockCounts, ClusterKernel, FrameUnits, MemberSums};
use super::frames::Frame;
use super::lanes::FixedLanes;
use super::output::Output;
use super::prefetch::{Parts, prefetch, prefetch_read};
use super::row::FixedRow;
use crate::interaction::Interaction;
use crate::sums::{Detail, Totals};

/// One evaluation.
pub struct ClusterJob<'a, I: Interaction> {
    interaction: I,
    /// Length of a fixed-point unit along each axis, σ.
    scale: [f64; 3],
    in_sigma: FrameUnits<I>,
    /// Set where the fixed-point units are equal along all axes.
    in_units: Option<FrameUnits<I>>,
    list: &'a ClusterList,
    /// Where rows are prefetched: the approximate distance in slots from a cluster to its last neighbor.
    slots_ahead: Option<usize>,
}

impl<'a, I: Interaction> ClusterJob<'a, I> {
    /// Prepares an evaluation; `scale` is the length in σ of a fixed-point unit along each axis.
    pub fn new(interaction: I, r_cut: f64, scale: [f64; 3], list: &'a ClusterList) -> Self {
        let cubic = scale[0] == scale[1] && scale[1] == scale[2];
        Self {
            interaction,
            scale,
            in_sigma: FrameUnits::new(&interaction, r_cut, 1.0),
            in_units: cubic.then(|| FrameUnits::new(&interaction, r_cut, scale[0])),
            list,
            // In smaller systems, prefetching costs 1 % of a step.
            slots_ahead: (list.table().particle.len() >= LARGE_SYSTEM).then(|| list.slots_ahead()),
        }
    }

    /// The sums of the next cluster of the stream, in the cheapest frame that suits it.
    ///
    /// # Safety
    /// As [`ClusterKernel::run`]; `rows` are the rows of the members, the first `count` of which are particles.
    #[inline(always)]
    unsafe fn cluster<L: FixedLanes, const EACH: usize, const COMMON: usize>(
        &self,
        isa: L::Isa,
        (rows, count): ([&FixedRow; CLUSTER], usize),
        (span, counts, excluded): (&Span, BlockCounts, &[ExcludedEntries]),
        stream: &mut BlockStream<L>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> ([MemberSums<L, EACH>; CLUSTER], Units) {
        let interaction = self.interaction;
        // Forces alone need no place for members that are lacking: no test for them slows this loop.
        let count = if COMMON == 0 { CLUSTER } else { count };
        // SAFETY: the contract is passed on, here and below.
        unsafe {
            if let (true, Some(in_units)) = (span.compact, &self.in_units) {
                let frame = Frame::<L, true, true>::new(isa, (rows, count), self.scale);
                let kernel = ClusterKernel::new(isa, interaction, in_units, rows, frame);
                return kernel.run((in_units, rows), counts, excluded, stream, common);
            }
            if span.compact {
                let frame = Frame::<L, true, false>::new(isa, (rows, count), self.scale);
                let kernel = ClusterKernel::new(isa, interaction, &self.in_sigma, rows, frame);
                return kernel.run((&self.in_sigma, rows), counts, excluded, stream, common);
            }
            let frame = Frame::<L, false, false>::new(isa, (rows, count), self.scale);
            let kernel = ClusterKernel::new(isa, interaction, &self.in_sigma, rows, frame);
            kernel.run((&self.in_sigma, rows), counts, excluded, stream, common)
        }
    }
}

/// Runs one chunk over rows, one per slot.
///
/// # Panics
/// Where `rows` is shorter than the list needs, or `output` lacks a slot of the chunk: that is a bug of the caller.
///
/// # Safety
/// No other thread runs the same chunk at the same time.
#[inline(always)]
pub unsafe fn run<L: FixedLanes, I: Interaction>(
    isa: L::Isa,
    job: &ClusterJob<'_, I>,
    rows: &[FixedRow],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> Totals {
    assert_eq!(rows.len(), job.list.table().particle.len(), "a row for each slot");
    let chunks = job.list.chunks();
    if let Some(next) = chunks.get(chunk + 1) {
        prefetch(&next.spans);
        // The blocks of a chunk lie anywhere in memory: the processor foresees no more than the ones behind the first.
        prefetch(&next.blocks[..next.blocks.len().min(CLUSTER)]);
    }
    let later = match (job.slots_ahead, chunks.get(chunk + 2)) {
        (Some(_), Some(later)) => &later.blocks[..],
        _ => &[],
    };
    let chunk = &chunks[chunk];
    // SAFETY: the contract is passed on.
    unsafe {
        if detail == Detail::Forces {
            return sweep::<L, I, 0, 0>(isa, job, rows, chunk, later, output);
        }
        if detail == Detail::Totals && chunk.sums_in_common {
            sweep::<L, I, 0, 1>(isa, job, rows, chunk, later, output)
        } else {
            sweep::<L, I, 1, 1>(isa, job, rows, chunk, later, output)
        }
    }
}

/// Computes the clusters of a chunk one after another, with sums for `EACH` member and sums in `COMMON` for a cluster.
///
/// Forces have the same bits with any other sums, and so have totals: they come from sums per cluster wherever a chunk allows it.
/// The blocks of a `later` chunk are prefetched, some with each cluster.
///
/// # Safety
/// As [`run`].
#[inline(always)]
unsafe fn sweep<L: FixedLanes, I: Interaction, const EACH: usize, const COMMON: usize>(
    isa: L::Isa,
    job: &ClusterJob<'_, I>,
    rows: &[FixedRow],
    chunk: &ClusterChunk,
    later: &[Block],
    output: &Output<'_>,
) -> Totals {
    let of_slots = &rows[..chunk.end_slot as usize];
    let n = of_slots.len();
    let later = Parts::of(later, chunk.spans.len());
    let in_common = COMMON > 0 && chunk.sums_in_common;
    let mut totals = Totals::NOTHING;
    let mut sum = DVec3::ZERO;
    // SAFETY: entries of the list number slots, and `run` checked that each slot has a row. Each particle has one slot,
    // each slot belongs to one cluster, each cluster belongs to one chunk, and no other thread runs this chunk.
    unsafe {
        let mut stream = BlockStream::new(isa, rows, chunk);
        let mut first = chunk.first_slot as usize;
        let mut begin = 0;
        let mut excluded = &chunk.excluded[..];
        let mut before: Option<Computed<L, EACH, COMMON>> = None;
        for (cluster, span) in chunk.spans.iter().enumerate() {
            later.prefetch(cluster);
            if let Some(ahead) = job.slots_ahead {
                // The rows of four slots fill one cache line.
                prefetch_read(rows.as_ptr().wrapping_add(first + ATOMS_PER_CHUNK + ahead));
            }
            let counts = BlockCounts::of(span, begin);
            output.prefetch(first + CLUSTER, CLUSTER);
            output.prefetch_next_chunk(first, CLUSTER);
            let own = if first + CLUSTER <= n {
                [&of_slots[first], &of_slots[first + 1], &of_slots[first + 2], &of_slots[first + 3]]
            } else {
                // A cluster of fewer particles repeats its last one.
                let row = |member: usize| &of_slots[(first + member).min(n - 1)];
                [row(0), row(1), row(2), row(3)]
            };
            let mut common = [CommonSums::nothing(isa); COMMON];
            let masked = span.masked_blocks().min(excluded.len());
            let (of_cluster, rest) = excluded.split_at(masked);
            excluded = rest;
            let cluster = (span, counts, of_cluster);
            let (sums, units) = job.cluster::<L, EACH, COMMON>(
                isa,
                (own, n - first),
                cluster,
                &mut stream,
                &mut common,
            );
            let end = (first + CLUSTER).min(n);
            let computed = Computed { slots: [first, end], sums, units, common };
            // The reduction of sums waits for the last pairs. A processor that waits with it computes the next cluster meanwhile.
            let computed = if L::FEW_REGISTERS { before.replace(computed) } else { Some(computed) };
            if let Some(computed) = computed {
                computed.finish(job, in_common, output, &mut sum, &mut totals);
            }
            (first, begin) = (end, span.end);
        }
        if let Some(last) = before {
            last.finish(job, in_common, output, &mut sum, &mut totals);
        }
    }
    // A sum with a non-finite force in it never becomes finite again.
    totals.broken = !sum.is_finite();
    totals
}

/// A cluster whose sums are still by lanes.
#[derive(Clone, Copy)]
struct Computed<L: FixedLanes, const EACH: usize, const COMMON: usize> {
    /// The first slot, and the end of the slots.
    slots: [usize; 2],
    sums: [MemberSums<L, EACH>; CLUSTER],
    units: Units,
    common: [CommonSums<L>; COMMON],
}

impl<L: FixedLanes, const EACH: usize, const COMMON: usize> Computed<L, EACH, COMMON> {
    /// Writes the forces and adds to their sum and to the totals.
    ///
    /// # Safety
    /// As [`run`].
    #[inline(always)]
    unsafe fn finish<I: Interaction>(
        self,
        job: &ClusterJob<'_, I>,
        in_common: bool,
        output: &Output<'_>,
        sum: &mut DVec3,
        totals: &mut Totals,
    ) {
        let Self { slots: [first, end], sums, units, common } = self;
        let forces = [sums[0].force, sums[1].force, sums[2].force, sums[3].force];
        let forces = L::sum_four(forces, units.force());
        for ((slot, sums), force) in (first..end).zip(&sums).zip(forces) {
            *sum += force;
            // SAFETY: the contract is passed on.
            unsafe { output.write(slot, force, (sums.others.first(), in_common), units, totals) };
        }
        for common in common.iter().filter(|_| in_common) {
            totals.add(&common.totals(&job.interaction, units));
        }
    }
}
