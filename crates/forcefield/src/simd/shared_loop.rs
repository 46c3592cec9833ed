//! The loop over lists that four particles share, written once over the lanes.

use lennard_neighbor::{BLOCK, Block, SHARERS, SharedChunk, SharedList};

use super::FixedRow;
use super::lanes::{Lanes, Scaled};
use super::output::Output;
use super::pair_loop::{ChunkTotals, PerParticle, Wanted};
use super::pair_sums::{Besides, ForcesAlone, PairSums};
use crate::truncation::PairForm;
use glam::DVec3;

/// Registers of singles that read rows in fixed point.
pub trait FixedLanes: Lanes<Row = FixedRow> {
    /// Whether a loop of its own for cubic units is worth compiling.
    const CUBIC_LOOP: bool;

    /// The rows that `WIDTH` entries name, along x, y and z.
    ///
    /// # Safety
    /// Each of the `WIDTH` readable entries at `entries` names a readable row, and the processor has the instruction set
    /// of the implementation.
    unsafe fn gather(rows: *const FixedRow, entries: *const Scaled) -> Self::Own;

    /// a − b along each axis, in units of the rows.
    ///
    /// # Safety
    /// The processor has the instruction set of the implementation.
    unsafe fn apart(a: Self::Own, b: Self::Own) -> [Self; 3];

    /// The lanes of `mask` that are set in the lowest bits of `bits`.
    fn among(mask: Self::Mask, bits: u32) -> Self::Mask;

    /// The sums over all lanes of four vectors at once, which may cost less than twelve sums.
    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; SHARERS]) -> [DVec3; SHARERS] {
        [
            DVec3::new(a[0].sum(), a[1].sum(), a[2].sum()),
            DVec3::new(b[0].sum(), b[1].sum(), b[2].sum()),
            DVec3::new(c[0].sum(), c[1].sum(), c[2].sum()),
            DVec3::new(d[0].sum(), d[1].sum(), d[2].sum()),
        ]
    }
}

const _: () = assert!(SHARERS == 4, "the loop names each of the sharers");

/// One evaluation, as the loop sees it.
pub struct SharedJob<'a, F> {
    form: F,
    r_cut2: f64,
    /// Length of a unit along each axis, σ.
    scale: [f64; 3],
    rows: &'a [FixedRow],
    list: &'a SharedList,
    output: Output<'a>,
}

impl<'a, F: PairForm> SharedJob<'a, F> {
    /// Prepares an evaluation: `scale` is the length in σ of one unit of the rows along each axis, and rows, forces
    /// and `each` have one element a particle.
    ///
    /// # Panics
    /// Where rows, list and arrays do not belong together: that is a bug of the caller.
    pub fn new(
        form: F,
        r_cut: f64,
        scale: [f64; 3],
        rows: &'a [FixedRow],
        list: &'a SharedList,
        forces: &'a mut [DVec3],
        each: Option<&'a mut [PerParticle]>,
    ) -> Self {
        let n = list.table().particle.len();
        assert_eq!(rows.len(), n, "a row for each particle");
        Self {
            form,
            r_cut2: r_cut * r_cut,
            scale,
            rows,
            list,
            output: Output::new(n, forces, each),
        }
    }
}

/// Runs one chunk.
///
/// # Safety
/// The processor has the instruction set of `L`, and no other thread runs the same chunk.
#[inline(always)]
pub unsafe fn run<L: FixedLanes, F: PairForm>(
    job: &SharedJob<'_, F>,
    chunk: usize,
    wanted: Wanted,
) -> ChunkTotals {
    let chunk = &job.list.chunks()[chunk];
    let [sx, sy, sz] = job.scale;
    // SAFETY: the contract is passed on.
    unsafe {
        // Constants stand alone in their conditions: only so does the compiler leave out what they rule out.
        if F::RARE {
            return sweep::<L, F, PairSums<L>, false>(job, chunk);
        }
        if L::CUBIC_LOOP && sx == sy && sy == sz {
            return match wanted {
                Wanted::Forces => sweep::<L, F, ForcesAlone, true>(job, chunk),
                _ => sweep::<L, F, PairSums<L>, true>(job, chunk),
            };
        }
        match wanted {
            Wanted::Forces => sweep::<L, F, ForcesAlone, false>(job, chunk),
            _ => sweep::<L, F, PairSums<L>, false>(job, chunk),
        }
    }
}

/// What all blocks have in common.
struct Constants<L, F> {
    form: F,
    r_cut2: L,
    /// Length of a unit along y and z, in units along x.
    stretch: [L; 2],
    unit2: L,
}

/// Sums of one of the sharers.
#[derive(Clone, Copy)]
struct Sums<L, B> {
    /// Minus the force, in units of the rows along x times ε/σ².
    pull: [L; 3],
    besides: B,
}

/// Distances stay in units of the rows along x, and only their squares and the finished sums are scaled.
/// `CUBIC` leaves out a stretch by one. Forces are the same to the bit whatever else is summed.
///
/// # Safety
/// As [`run`].
#[inline(always)]
unsafe fn sweep<L: FixedLanes, F: PairForm, B: Besides<L>, const CUBIC: bool>(
    job: &SharedJob<'_, F>,
    chunk: &SharedChunk,
) -> ChunkTotals {
    let [sx, sy, sz] = job.scale;
    let constants = Constants {
        form: job.form,
        r_cut2: L::splat(job.r_cut2),
        stretch: [L::splat(sy / sx), L::splat(sz / sx)],
        unit2: L::splat(sx * sx),
    };
    let particle = &job.list.table().particle;
    let nothing = Sums {
        pull: [L::splat(0.0); 3],
        besides: B::nothing(),
    };
    let mut totals = ChunkTotals::NOTHING;
    for (k, span) in chunk.starts.windows(2).enumerate() {
        let first = chunk.first_place as usize + k * SHARERS;
        let blocks = &chunk.blocks[span[0] as usize..span[1] as usize];
        let (masked, plain) = blocks.split_at(chunk.masked[k] as usize);
        let mut sums = [nothing; SHARERS];
        // SAFETY: the instruction set is there by contract; entries of the list name places, and `SharedJob::new`
        // checked that each has a row.
        unsafe {
            // A list of fewer particles repeats its last one.
            let row = |sharer: usize| &job.rows[(first + sharer).min(job.rows.len() - 1)];
            let own = [
                L::spread(row(0)),
                L::spread(row(1)),
                L::spread(row(2)),
                L::spread(row(3)),
            ];
            if let [lead, rest @ ..] = masked {
                // The sharers themselves are its first entries.
                let but = [0b0001, 0b0010, 0b0100, 0b1000];
                sums = add::<L, F, B, CUBIC, true>(&constants, own, job.rows, lead, but, sums);
                for block in rest {
                    let but = [0; SHARERS];
                    sums = add::<L, F, B, CUBIC, true>(&constants, own, job.rows, block, but, sums);
                }
            }
            for block in plain {
                let but = [0; SHARERS];
                sums = add::<L, F, B, CUBIC, false>(&constants, own, job.rows, block, but, sums);
            }
        }
        let pulls = L::sum_four([sums[0].pull, sums[1].pull, sums[2].pull, sums[3].pull]);
        for ((place, sums), pull) in (first..particle.len()).zip(&sums).zip(pulls) {
            let particle = particle[place] as usize;
            // SAFETY: each particle stands at one place, each place in one list, and each list in one chunk.
            unsafe {
                let (force, besides) = (pull * -sx, &sums.besides);
                job.output
                    .write(particle, force, besides, sx * sx, &mut totals);
            }
        }
    }
    totals
}

/// Adds the pairs of one block; where it is `MASKED`, those of its entries that count, `but` some for each sharer.
///
/// # Safety
/// As [`run`]; the block is one of the list of the rows.
#[inline(always)]
unsafe fn add<L: FixedLanes, F: PairForm, B: Besides<L>, const CUBIC: bool, const MASKED: bool>(
    constants: &Constants<L, F>,
    own: [L::Own; SHARERS],
    rows: &[FixedRow],
    block: &Block,
    but: [u16; SHARERS],
    mut sums: [Sums<L, B>; SHARERS],
) -> [Sums<L, B>; SHARERS] {
    // SAFETY: the contract is passed on; base plus entry names a row.
    unsafe {
        let rows = rows.as_ptr().add(block.base as usize);
        let entries = block.entries.as_ptr().cast::<Scaled>();
        for part in 0..BLOCK / L::WIDTH {
            let others = L::gather(rows, entries.add(part * L::WIDTH));
            // By value and by constants: sums behind a reference would not stay in registers.
            let bits = |but: u16| u32::from(block.valid & !but) >> (part * L::WIDTH);
            sums = [
                meet::<L, F, B, CUBIC, MASKED>(constants, own[0], others, bits(but[0]), sums[0]),
                meet::<L, F, B, CUBIC, MASKED>(constants, own[1], others, bits(but[1]), sums[1]),
                meet::<L, F, B, CUBIC, MASKED>(constants, own[2], others, bits(but[2]), sums[2]),
                meet::<L, F, B, CUBIC, MASKED>(constants, own[3], others, bits(but[3]), sums[3]),
            ];
        }
    }
    sums
}

/// Adds the pairs of one particle with a register of others, those set in `bits` where they are `MASKED`.
///
/// # Safety
/// As [`run`].
#[inline(always)]
unsafe fn meet<L: FixedLanes, F: PairForm, B: Besides<L>, const CUBIC: bool, const MASKED: bool>(
    constants: &Constants<L, F>,
    own: L::Own,
    others: L::Own,
    bits: u32,
    mut sums: Sums<L, B>,
) -> Sums<L, B> {
    // SAFETY: the contract is passed on.
    let [dx, mut dy, mut dz] = unsafe { L::apart(others, own) };
    if !CUBIC {
        dy = dy * constants.stretch[0];
        dz = dz * constants.stretch[1];
    }
    let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx)) * constants.unit2;
    let mut inside = r2.at_most(constants.r_cut2);
    if MASKED {
        inside = L::among(inside, bits);
    }
    let pair = constants.form.eval(r2);
    let f = pair.force.keep(inside);
    let [x, y, z] = sums.pull;
    sums.pull = [dx.mul_add(f, x), dy.mul_add(f, y), dz.mul_add(f, z)];
    sums.besides.add([dx, dy, dz], f, &pair, inside);
    sums
}
