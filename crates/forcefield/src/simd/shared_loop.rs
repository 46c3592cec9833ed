//! The loop over lists that four particles share, written once over the lanes.

use lennard_neighbor::{
    ATOMS_PER_CHUNK, BLOCK, Block, MANY, SHARERS, SharedChunk, SharedList, Span,
};

use super::FixedRow;
use super::lanes::FixedLanes;
use super::output::Output;
use super::pair_loop::{ChunkTotals, Wanted};
use super::pair_sums::{Besides, ForcesAlone, PairSums, Units};
use super::prefetch::{Parts, prefetch, prefetch_read};
use super::reader::Reader;
use super::view::{AsTheyAre, FromAmid, View};
use crate::truncation::PairForm;
use glam::DVec3;

/// What a view counts in, and what the loop needs to know for that.
#[derive(Clone, Copy)]
struct Measures {
    units: Units,
    /// The square of the cutoff, in units.
    r_cut2: f64,
    /// The square of a unit, σ².
    unit2: f64,
    /// Its inverse, σ⁻².
    inv_unit2: f64,
}

impl Measures {
    fn new<F: PairForm>(r_cut: f64, length: f64) -> Self {
        let unit2 = length * length;
        Self {
            units: Units {
                energy: F::UNIT,
                length,
            },
            r_cut2: r_cut * r_cut / unit2,
            unit2,
            inv_unit2: 1.0 / unit2,
        }
    }
}

/// One evaluation, as the loop sees it.
pub struct SharedJob<'a, F> {
    form: F,
    /// Length of a unit along each axis, σ.
    scale: [f64; 3],
    in_sigma: Measures,
    /// Where units are as long along all axes.
    in_units: Option<Measures>,
    list: &'a SharedList,
    /// How many places after its own a list reaches, more or less, where what comes is asked for ahead.
    ahead: Option<usize>,
}

impl<'a, F: PairForm> SharedJob<'a, F> {
    /// Prepares an evaluation: `scale` is the length in σ of one unit of the rows along each axis.
    pub fn new(form: F, r_cut: f64, scale: [f64; 3], list: &'a SharedList) -> Self {
        let cubic = scale[0] == scale[1] && scale[1] == scale[2];
        Self {
            form,
            scale,
            in_sigma: Measures::new::<F>(r_cut, 1.0),
            in_units: cubic.then(|| Measures::new::<F>(r_cut, scale[0])),
            list,
            // For fewer, asking costs 1 % of a step.
            ahead: (list.table().particle.len() >= MANY).then(|| list.reaches_ahead()),
        }
    }
}

/// Runs one chunk over rows, one a particle.
///
/// # Panics
/// Where the list has no such rows, or the output no such places: that is a bug of the caller.
///
/// # Safety
/// The processor has the instruction set of `L`, and no other thread runs the same chunk.
#[inline(always)]
pub unsafe fn run<L: FixedLanes, F: PairForm>(
    job: &SharedJob<'_, F>,
    rows: &[FixedRow],
    chunk: usize,
    wanted: Wanted,
    output: &Output<'_>,
) -> ChunkTotals {
    assert_eq!(
        rows.len(),
        job.list.table().particle.len(),
        "a row for each particle"
    );
    let chunks = job.list.chunks();
    if let Some(next) = chunks.get(chunk + 1) {
        prefetch(&next.spans);
    }
    let later = match (job.ahead, chunks.get(chunk + 2)) {
        (Some(_), Some(later)) => &later.blocks[..],
        _ => &[],
    };
    let chunk = &chunks[chunk];
    // SAFETY: the contract is passed on.
    unsafe {
        // Constants stand alone in their conditions: only so does the compiler leave out what they rule out.
        if F::RARE {
            return sweep::<L, F, PairSums<L>, ForcesAlone>(job, rows, chunk, later, output);
        }
        // A list of fewer than four repeats its last one, which must not count twice.
        let full = chunk.first_place as usize + SHARERS * chunk.spans.len() <= rows.len();
        match wanted {
            Wanted::Forces => {
                sweep::<L, F, ForcesAlone, ForcesAlone>(job, rows, chunk, later, output)
            }
            Wanted::Totals if L::SPECIAL_LOOPS && full => {
                sweep::<L, F, ForcesAlone, PairSums<L>>(job, rows, chunk, later, output)
            }
            _ => sweep::<L, F, PairSums<L>, ForcesAlone>(job, rows, chunk, later, output),
        }
    }
}

/// Sums `B` for each particle, and `C` for four of them together, which takes a fourth of the registers. Forces are the
/// same to the bit whatever else is summed. The blocks of a `later` chunk are asked for, some with each list.
///
/// # Safety
/// As [`run`].
#[inline(always)]
unsafe fn sweep<L: FixedLanes, F: PairForm, B: Besides<L>, C: Besides<L>>(
    job: &SharedJob<'_, F>,
    rows: &[FixedRow],
    chunk: &SharedChunk,
    later: &[Block],
    output: &Output<'_>,
) -> ChunkTotals {
    let n = rows.len();
    let later = Parts::of(later, chunk.spans.len());
    let mut totals = ChunkTotals::NOTHING;
    let mut sum = DVec3::ZERO;
    // SAFETY: the instruction set is there by contract; entries of the list name places, and `run` checked
    // that each has a row. Each particle stands at one place, each place in one list, and each list in one chunk.
    unsafe {
        let mut reader = Reader::new(rows, chunk);
        let mut first = chunk.first_place as usize;
        let mut begin = 0;
        for (list, span) in chunk.spans.iter().enumerate() {
            later.ask(list);
            if let Some(ahead) = job.ahead {
                // Rows of four fill a line.
                prefetch_read(rows.as_ptr().wrapping_add(first + ATOMS_PER_CHUNK + ahead));
            }
            let counts = Counts::of(span, begin);
            if L::SPECIAL_LOOPS {
                output.prefetch(first + SHARERS, SHARERS);
                output.ask_for_later(first, SHARERS);
            }
            let own = if first + SHARERS <= n {
                [
                    &rows[first],
                    &rows[first + 1],
                    &rows[first + 2],
                    &rows[first + 3],
                ]
            } else {
                // A list of fewer particles repeats its last one.
                let row = |sharer: usize| &rows[(first + sharer).min(n - 1)];
                [row(0), row(1), row(2), row(3)]
            };
            let mut common = C::nothing();
            let (sums, units): ([Sums<L, B>; SHARERS], Units) = 'met: {
                if const { L::SPECIAL_LOOPS && !F::RARE } {
                    if let (true, Some(in_units)) = (span.together, &job.in_units) {
                        let view = FromAmid::<L, true>::new(own, job.scale);
                        let meeting = Meeting::new(job.form, in_units, view);
                        break 'met meeting.all(counts, &mut reader, &mut common);
                    }
                    if span.together {
                        let view = FromAmid::<L, false>::new(own, job.scale);
                        let meeting = Meeting::new(job.form, &job.in_sigma, view);
                        break 'met meeting.all(counts, &mut reader, &mut common);
                    }
                }
                let view = AsTheyAre::new(own, job.scale);
                let meeting = Meeting::new(job.form, &job.in_sigma, view);
                meeting.all(counts, &mut reader, &mut common)
            };
            let forces = [sums[0].force, sums[1].force, sums[2].force, sums[3].force];
            let end = (first + SHARERS).min(n);
            let forces = L::sum_four(forces, units.force());
            for ((place, sums), force) in (first..end).zip(&sums).zip(forces) {
                sum += force;
                output.write(place, force, &sums.besides, units, &mut totals);
            }
            if C::ANYTHING {
                totals.add(&common.totals(units));
            }
            (first, begin) = (end, span.end);
        }
    }
    // What is not finite never becomes finite again.
    totals.broken = !sum.is_finite();
    totals
}

/// How many blocks of each kind a list has.
#[derive(Clone, Copy)]
struct Counts {
    first_two: u32,
    last_two: u32,
    masked: u32,
    plain: u32,
}

impl Counts {
    #[inline(always)]
    fn of(span: &Span, begin: u32) -> Self {
        Self {
            first_two: span.first_two - begin,
            last_two: span.last_two - span.first_two,
            masked: span.masked - span.last_two,
            plain: span.end - span.masked,
        }
    }
}

/// Sums of one of the sharers.
#[derive(Clone, Copy)]
struct Sums<L, B> {
    /// In units of the form and of the view.
    force: [L; 3],
    besides: B,
}

/// The sharers of a list and those whom it names.
struct Meeting<L, F, V> {
    form: F,
    /// The square of the cutoff, in units of the view.
    r_cut2: L,
    /// The square of a unit, σ².
    unit2: L,
    /// Its inverse, σ⁻².
    inv_unit2: L,
    units: Units,
    view: V,
}

impl<L: FixedLanes, F: PairForm, V: View<L>> Meeting<L, F, V> {
    #[inline(always)]
    fn new(form: F, measures: &Measures, view: V) -> Self {
        Self {
            form,
            r_cut2: L::splat(measures.r_cut2),
            unit2: L::splat(measures.unit2),
            inv_unit2: L::splat(measures.inv_unit2),
            units: measures.units,
            view,
        }
    }

    /// The sums over the list that comes next, which has so many blocks of each kind, and what they count in.
    ///
    /// # Safety
    /// As [`run`]; the list is that of the sharers in view.
    #[inline(always)]
    unsafe fn all<B: Besides<L>, C: Besides<L>>(
        &self,
        counts: Counts,
        reader: &mut Reader<L>,
        common: &mut C,
    ) -> ([Sums<L, B>; SHARERS], Units) {
        let all = [u16::MAX; SHARERS];
        // SAFETY: the contract is passed on.
        unsafe {
            let own = self.view.own();
            let [a, b] = self.two(own[0], own[1], counts.first_two, reader, common);
            let [c, d] = self.two(own[2], own[3], counts.last_two, reader, common);
            let mut sums = [a, b, c, d];
            // The sharers themselves are the first entries of the first that is masked.
            let mut but = [0b0001, 0b0010, 0b0100, 0b1000];
            for _ in 0..counts.masked {
                let valid = reader.valid();
                let valid = [
                    valid & !but[0],
                    valid & !but[1],
                    valid & !but[2],
                    valid & !but[3],
                ];
                but = [0; SHARERS];
                sums = self.add::<B, C, true>(own, reader, valid, sums, common);
            }
            for _ in 0..counts.plain {
                sums = self.add::<B, C, false>(own, reader, all, sums, common);
            }
            (sums, self.units)
        }
    }

    /// The sums of two sharers over so many blocks for them alone.
    ///
    /// # Safety
    /// As [`Meeting::all`].
    #[inline(always)]
    unsafe fn two<B: Besides<L>, C: Besides<L>>(
        &self,
        first: V::Own,
        second: V::Own,
        blocks: u32,
        reader: &mut Reader<L>,
        common: &mut C,
    ) -> [Sums<L, B>; 2] {
        let nothing = Sums {
            force: [L::splat(0.0); 3],
            besides: B::nothing(),
        };
        let (mut of_first, mut of_second) = (nothing, nothing);
        for _ in 0..blocks {
            // SAFETY: the contract is passed on.
            unsafe {
                let valid = u32::from(reader.valid());
                for part in 0..BLOCK / L::WIDTH {
                    let others = self.view.others(reader.next(part));
                    let bits = valid >> (part * L::WIDTH);
                    of_first = self.meet::<B, C, true>(first, others, bits, of_first, common);
                    of_second = self.meet::<B, C, true>(second, others, bits, of_second, common);
                }
            }
        }
        [of_first, of_second]
    }

    /// Adds the pairs of one block with all sharers; where it is `MASKED`, those of its entries that are `valid` for each.
    ///
    /// # Safety
    /// As [`Meeting::all`].
    #[inline(always)]
    unsafe fn add<B: Besides<L>, C: Besides<L>, const MASKED: bool>(
        &self,
        own: [V::Own; SHARERS],
        reader: &mut Reader<L>,
        valid: [u16; SHARERS],
        sums: [Sums<L, B>; SHARERS],
        common: &mut C,
    ) -> [Sums<L, B>; SHARERS] {
        // By value and by constants: sums behind a reference would not stay in registers.
        let [mut a, mut b, mut c, mut d] = sums;
        // SAFETY: the contract is passed on.
        unsafe {
            for part in 0..BLOCK / L::WIDTH {
                let others = self.view.others(reader.next(part));
                let bits = |valid: u16| u32::from(valid) >> (part * L::WIDTH);
                a = self.meet::<B, C, MASKED>(own[0], others, bits(valid[0]), a, common);
                b = self.meet::<B, C, MASKED>(own[1], others, bits(valid[1]), b, common);
                c = self.meet::<B, C, MASKED>(own[2], others, bits(valid[2]), c, common);
                d = self.meet::<B, C, MASKED>(own[3], others, bits(valid[3]), d, common);
            }
        }
        [a, b, c, d]
    }

    /// Adds the pairs of one particle with a register of others, those set in `bits` where they are `MASKED`.
    ///
    /// # Safety
    /// As [`Meeting::all`].
    #[inline(always)]
    unsafe fn meet<B: Besides<L>, C: Besides<L>, const MASKED: bool>(
        &self,
        own: V::Own,
        others: V::Others,
        bits: u32,
        mut sums: Sums<L, B>,
        common: &mut C,
    ) -> Sums<L, B> {
        // SAFETY: the contract is passed on.
        let [dx, dy, dz] = unsafe { self.view.apart(own, others) };
        let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
        let inside = if MASKED {
            r2.at_most_among(self.r_cut2, bits)
        } else {
            r2.at_most(self.r_cut2)
        };
        let pair = if V::IN_SIGMA {
            self.form.eval(r2, r2.recip())
        } else {
            self.form.eval(r2 * self.unit2, self.inv_unit2 / r2)
        };
        let f = pair.force.keep(inside);
        let [x, y, z] = sums.force;
        sums.force = [dx.mul_add(f, x), dy.mul_add(f, y), dz.mul_add(f, z)];
        sums.besides.add([dx, dy, dz], f, &pair, inside);
        common.add([dx, dy, dz], f, &pair, inside);
        sums
    }
}
