//! The loop over row lists, written once for all lanes.

use glam::DVec3;
use lennard_neighbor::{Entries, ListChunk, NeighborList};

use super::accumulate::{self, CommonSums, PairSums, Units};
use super::lanes::Lanes;
use super::output::Output;
use super::prefetch::prefetch;
use super::row::DoubleRow;
use crate::interaction::Interaction;
use crate::sums::{Detail, Totals};

/// One evaluation.
pub struct RowJob<'a, I: Interaction> {
    interaction: I,
    numbers: I::Numbers<f64>,
    list: &'a NeighborList,
}

impl<'a, I: Interaction> RowJob<'a, I> {
    /// Prepares an evaluation with a cutoff, σ.
    pub fn new(interaction: I, r_cut: f64, list: &'a NeighborList) -> Self {
        Self { interaction, numbers: interaction.numbers(r_cut, 1.0), list }
    }
}

/// Runs one chunk.
///
/// # Panics
/// Where `rows` is shorter than the list needs, or `output` lacks a slot of the chunk: that is a bug of the caller.
///
/// # Safety
/// No other thread runs the same chunk at the same time.
#[inline(always)]
pub unsafe fn run<L: Lanes<Row = DoubleRow, Number = f64>, I: Interaction>(
    isa: L::Isa,
    job: &RowJob<'_, I>,
    rows: &[L::Row],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> Totals {
    assert!(rows.len() >= job.list.targets(), "a row for each target of the list");
    let chunks = job.list.chunks();
    if let Some(next) = chunks.get(chunk + 1) {
        prefetch(&next.counts);
        match &next.entries {
            Entries::Narrow(e) => prefetch(e),
            Entries::Wide(e) => prefetch(e),
        }
    }
    let chunk = &chunks[chunk];
    assert_eq!(job.list.lanes() % L::WIDTH, 0, "entries fill whole registers");
    // SAFETY: the contract is passed on.
    unsafe {
        let e = match &chunk.entries {
            // Entries are wide above a million particles in a cube. One instance then serves every detail, with the same bits.
            Entries::Wide(e) => {
                return sweep::<L, I, u32, 1, 1>(isa, job, rows, chunk, e, output);
            }
            Entries::Narrow(e) => e,
        };
        match detail {
            Detail::Forces => sweep::<L, I, u16, 0, 0>(isa, job, rows, chunk, e, output),
            Detail::Totals => sweep::<L, I, u16, 0, 1>(isa, job, rows, chunk, e, output),
            Detail::Everything => sweep::<L, I, u16, 1, 1>(isa, job, rows, chunk, e, output),
        }
    }
}

/// Computes the particles of a chunk one after another, with sums for `EACH` and sums in `COMMON`.
///
/// Totals come from the sums for all wherever there are some, so that they have the same bits with and without the others.
///
/// # Safety As [`run`]; `entries` belong to `chunk`, and the list of `job` built them.
#[inline(always)]
unsafe fn sweep<
    L: Lanes<Row = DoubleRow, Number = f64>,
    I: Interaction,
    E: Copy + Into<u32>,
    const EACH: usize,
    const COMMON: usize,
>(
    isa: L::Isa,
    job: &RowJob<'_, I>,
    rows: &[L::Row],
    chunk: &ListChunk,
    entries: &[E],
    output: &Output<'_>,
) -> Totals {
    let units = Units { energy: I::UNIT, length: 1.0 };
    // There is no `array::map` over lanes here: it is a call, and a call leaves the instruction set.
    let zero = L::constant(isa, 0.0);
    let mut common = [CommonSums::<L>::nothing(isa); COMMON];
    let mut totals = Totals::NOTHING;
    let mut sum = DVec3::ZERO;
    let mut start = 0;
    // SAFETY: `run` checked that every target of the list is a row; base plus entry is a target.
    let from_base = unsafe { rows.as_ptr().add(chunk.base as usize) };
    let padding = job.list.lanes();
    for (offset, count) in chunk.counts.iter().enumerate() {
        let count = *count as usize;
        let slot = chunk.first_slot as usize + offset;
        output.prefetch_next_chunk(slot, 1);
        let row = &rows[job.list.target_of(slot) as usize];
        let own =
            Particle { at: L::spread(isa, row), numbers: I::own::<L>(isa, &job.numbers, row) };
        let end = start + count.next_multiple_of(padding);
        let mine = &entries[start..end];
        start = end;

        let mut force = [zero; 3];
        let mut sums = [PairSums::<L>::nothing(isa); EACH];
        let full = count / L::WIDTH;
        for register in 0..full {
            // SAFETY: `WIDTH` entries lie at this offset of `mine`, and each numbers a row (see above).
            unsafe {
                let at = mine.as_ptr().add(register * L::WIDTH);
                let (all, sums) = (L::WIDTH, (&mut sums, &mut common));
                add((isa, job), own, from_base, at, all, &mut force, sums);
            }
        }
        let rest = count % L::WIDTH;
        if rest > 0 {
            // SAFETY: entries are padded to whole registers with a row that exists.
            unsafe {
                let at = mine.as_ptr().add(full * L::WIDTH);
                let sums = (&mut sums, &mut common);
                add((isa, job), own, from_base, at, rest, &mut force, sums);
            }
        }

        let [fx, fy, fz] = force;
        let force = L::sum3(fx, fy, fz, units.force());
        sum += force;
        // SAFETY: each slot belongs to one chunk, and no other thread runs this one.
        unsafe { output.write(slot, force, (sums.first(), COMMON > 0), units, &mut totals) };
    }
    for common in &common {
        totals.add(&common.totals(&job.interaction, units));
    }
    // A sum with a non-finite force in it never becomes finite again.
    totals.broken = !sum.is_finite();
    totals
}

/// A particle in registers.
struct Particle<L: Lanes<Row = DoubleRow, Number = f64>, I: Interaction> {
    at: [L; 3],
    numbers: I::Own<L>,
}

impl<L: Lanes<Row = DoubleRow, Number = f64>, I: Interaction> Clone for Particle<L, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L: Lanes<Row = DoubleRow, Number = f64>, I: Interaction> Copy for Particle<L, I> {}

/// Adds the pairs of one register; the first `valid` lanes are pairs, the rest is padding.
///
/// # Safety
/// As [`Lanes::gather`].
#[inline(always)]
unsafe fn add<
    L: Lanes<Row = DoubleRow, Number = f64>,
    I: Interaction,
    E: Copy + Into<u32>,
    const EACH: usize,
    const COMMON: usize,
>(
    (isa, job): (L::Isa, &RowJob<'_, I>),
    own: Particle<L, I>,
    rows: *const L::Row,
    entries: *const E,
    valid: usize,
    force: &mut [L; 3],
    (sums, common): (&mut [PairSums<L>; EACH], &mut [CommonSums<L>; COMMON]),
) {
    // SAFETY: the contract is passed on.
    let ([x, y, z], species) = unsafe { L::gather(isa, rows, entries) };
    let [dx, dy, dz] = [own.at[0] - x, own.at[1] - y, own.at[2] - z];
    let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
    let r_cut2 = I::r_cut2::<L>(&own.numbers, species);
    let inside = if valid < L::WIDTH {
        r2.at_most_among(r_cut2, (1 << valid) - 1)
    } else {
        r2.at_most(r_cut2)
    };
    let (interaction, numbers) = (&job.interaction, &own.numbers);
    let at = (r2, inside);
    let f = accumulate::force::<L, I, true, COMMON>(interaction, numbers, species, at, common);
    force[0] = dx.mul_add(f, force[0]);
    force[1] = dy.mul_add(f, force[1]);
    force[2] = dz.mul_add(f, force[2]);
    if EACH > 0 {
        let pair = interaction.eval::<L, true>(numbers, species, r2);
        let at_cutoff = I::at_cutoff::<L>(numbers, species);
        sums[0].add([dx, dy, dz], f, &pair, at_cutoff, inside);
    }
}
