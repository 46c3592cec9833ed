//! The pair loop, written once over the lanes.

use glam::{DMat3, DVec3};
use lennard_neighbor::{Entries, ListChunk, NeighborList};

use super::lanes::{Entry, Lanes, RowLanes};
use super::output::Output;
use super::pair_sums::{Besides, ForcesAlone, PairSums, Units};
use super::prefetch::prefetch;
use crate::truncation::PairForm;

/// Energy (half of each pair), ε, and virial tensor (half of each pair), ε, of one particle.
pub type PerParticle = (f64, DMat3);

/// Which instance of the loop is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// Forces alone.
    Forces,
    /// Forces and the totals of the chunk.
    Totals,
    /// Forces, totals and the entries of each particle.
    Each,
}

/// Sums over one chunk; every pair is met from both of its ends, so each of these is twice its share.
#[derive(Debug, Clone, Copy)]
pub struct ChunkTotals {
    /// Σ U, ε.
    pub energy: f64,
    /// Σ r_ij ⊗ F_ij, ε.
    pub virial: DMat3,
    /// Σ (U″ + 2U′/r), ε/σ².
    pub laplacian: f64,
    /// Pairs with r ≤ r_cut.
    pub pairs: u64,
    /// Whether a force that is not finite was met.
    pub broken: bool,
}

impl ChunkTotals {
    /// No pair yet. (The default of a matrix is the identity, so there is no derived default.)
    pub const NOTHING: Self = Self {
        energy: 0.0,
        virial: DMat3::ZERO,
        laplacian: 0.0,
        pairs: 0,
        broken: false,
    };

    /// Adds the sums over other pairs.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.energy += other.energy;
        self.virial += other.virial;
        self.laplacian += other.laplacian;
        self.pairs += other.pairs;
    }
}

/// One evaluation, as the pair loop sees it.
pub struct PairJob<'a, F> {
    form: F,
    r_cut2: f64,
    list: &'a NeighborList,
}

impl<'a, F: PairForm> PairJob<'a, F> {
    /// Prepares an evaluation.
    pub fn new(form: F, r_cut: f64, list: &'a NeighborList) -> Self {
        Self {
            form,
            r_cut2: r_cut * r_cut,
            list,
        }
    }
}

/// Runs one chunk over rows.
///
/// # Panics
/// Where the list has no such rows, or the output no such places: that is a bug of the caller.
///
/// # Safety
/// The processor has the instruction set of `L`, and no other thread runs the same chunk.
#[inline(always)]
pub unsafe fn run<L: RowLanes, F: PairForm>(
    job: &PairJob<'_, F>,
    rows: &[L::Row],
    chunk: usize,
    wanted: Wanted,
    output: &Output<'_>,
) -> ChunkTotals {
    assert!(
        rows.len() >= job.list.targets(),
        "a row for each target of the list"
    );
    let chunks = job.list.chunks();
    if let Some(next) = chunks.get(chunk + 1) {
        prefetch(&next.counts);
        match &next.entries {
            Entries::Narrow(e) => prefetch(e),
            Entries::Wide(e) => prefetch(e),
        }
    }
    let chunk = &chunks[chunk];
    assert_eq!(
        job.list.lanes() % L::WIDTH,
        0,
        "entries fill whole registers"
    );
    // SAFETY: the contract is passed on.
    unsafe {
        let e = match &chunk.entries {
            // Above a million particles in a cube: one instance does for all that may be wanted.
            Entries::Wide(e) => {
                return sweep::<L, F, u32, PairSums<L>>(job, rows, chunk, e, output);
            }
            Entries::Narrow(e) => e,
        };
        // A constant alone in its condition: only so does the compiler leave out what it rules out.
        if F::RARE {
            return sweep::<L, F, u16, PairSums<L>>(job, rows, chunk, e, output);
        }
        match wanted {
            Wanted::Forces => sweep::<L, F, u16, ForcesAlone>(job, rows, chunk, e, output),
            _ => sweep::<L, F, u16, PairSums<L>>(job, rows, chunk, e, output),
        }
    }
}

/// # Safety
/// As [`run`]; `entries` are those of `chunk`, built by the list of `job`.
#[inline(always)]
unsafe fn sweep<L: RowLanes, F: PairForm, E: Entry, B: Besides<L>>(
    job: &PairJob<'_, F>,
    rows: &[L::Row],
    chunk: &ListChunk,
    entries: &[E],
    output: &Output<'_>,
) -> ChunkTotals {
    let r_cut2 = L::splat(job.r_cut2);
    let units = Units {
        energy: F::UNIT,
        length: 1.0,
    };
    // No `array::map` over lanes anywhere here: it is a call, and a call leaves the instruction set behind.
    let zero = L::splat(0.0);
    let mut totals = ChunkTotals::NOTHING;
    let mut sum = DVec3::ZERO;
    let mut start = 0;
    // SAFETY: `run` checked that every target of the list is a row; base plus entry is one.
    let from_base = unsafe { rows.as_ptr().add(chunk.base as usize) };
    let padding = job.list.lanes();
    for (offset, count) in chunk.counts.iter().enumerate() {
        let count = *count as usize;
        let place = chunk.first_place as usize + offset;
        output.ask_for_later(place, 1);
        let own = &rows[job.list.target_of(place) as usize];
        // SAFETY: the instruction set is there by contract.
        let own = unsafe { L::spread(own) };
        let end = start + count.next_multiple_of(padding);
        let mine = &entries[start..end];
        start = end;

        let mut force = [zero; 3];
        let mut sums = B::nothing();
        let full = count / L::WIDTH;
        for block in 0..full {
            // SAFETY: `WIDTH` entries lie at this place of `mine`, and each names a row (see above).
            unsafe {
                let at = mine.as_ptr().add(block * L::WIDTH);
                add::<L, F, E, B>(
                    &job.form,
                    own,
                    from_base,
                    at,
                    r_cut2,
                    L::WIDTH,
                    &mut force,
                    &mut sums,
                );
            }
        }
        let rest = count % L::WIDTH;
        if rest > 0 {
            // SAFETY: entries are padded to whole registers with a row that exists.
            unsafe {
                let at = mine.as_ptr().add(full * L::WIDTH);
                add::<L, F, E, B>(
                    &job.form, own, from_base, at, r_cut2, rest, &mut force, &mut sums,
                );
            }
        }

        let [fx, fy, fz] = force;
        let force = L::sum3(fx, fy, fz, units.force());
        sum += force;
        // SAFETY: each particle stands at one place, and each place in one chunk.
        unsafe { output.write(place, force, &sums, units, &mut totals) };
    }
    // What is not finite never becomes finite again.
    totals.broken = !sum.is_finite();
    totals
}

/// Adds the pairs of one register; the first `valid` lanes are pairs, the rest padding.
///
/// # Safety
/// As [`RowLanes::differences`].
#[inline(always)]
#[allow(clippy::too_many_arguments)]
unsafe fn add<L: RowLanes, F: PairForm, E: Entry, B: Besides<L>>(
    form: &F,
    own: L::Own,
    rows: *const L::Row,
    entries: *const E,
    r_cut2: L,
    valid: usize,
    force: &mut [L; 3],
    sums: &mut B,
) {
    // SAFETY: the contract is passed on.
    let [dx, dy, dz] = unsafe { L::differences(own, rows, entries) };
    let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
    let mut inside = r2.at_most(r_cut2);
    if valid < L::WIDTH {
        inside = L::first(inside, valid);
    }
    let pair = form.eval(r2, r2.recip());
    let f = pair.force.keep(inside);
    force[0] = dx.mul_add(f, force[0]);
    force[1] = dy.mul_add(f, force[1]);
    force[2] = dz.mul_add(f, force[2]);
    sums.add([dx, dy, dz], f, &pair, inside);
}

/// Registers' worth of independent pairs that [`arithmetic`] keeps in flight.
const IN_FLIGHT: usize = 4;

/// The arithmetic of `rounds·IN_FLIGHT` registers of pairs with everything in registers: differences,
/// formula, comparison and three sums, no list and no memory. Returns the pairs computed and a number
/// that keeps the work from being optimised away.
///
/// # Safety
/// The processor has the instruction set of `L`.
#[inline(always)]
pub unsafe fn arithmetic<L: Lanes, F: PairForm>(form: &F, r_cut: f64, rounds: u64) -> (u64, f64) {
    let r_cut2 = L::splat(r_cut * r_cut);
    let zero = L::splat(0.0);
    let mut force = [[zero; 3]; IN_FLIGHT];
    // A distance that creeps, so that no round can be taken for another.
    let mut at = [1.1, 1.3, 1.7, 2.1].map(|x| x * 0.577);
    for _ in 0..rounds {
        for k in 0..IN_FLIGHT {
            at[k] += 1e-12;
            let x = L::splat(at[k]);
            let (dx, dy, dz) = (x - zero, x - force[k][0] * zero, x - force[k][1] * zero);
            let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
            let f = form.eval(r2, r2.recip()).force.keep(r2.at_most(r_cut2));
            force[k][0] = dx.mul_add(f, force[k][0]);
            force[k][1] = dy.mul_add(f, force[k][1]);
            force[k][2] = dz.mul_add(f, force[k][2]);
        }
    }
    let mut sum = 0.0;
    for [x, y, z] in force {
        sum += x.sum() + y.sum() + z.sum();
    }
    (rounds * (IN_FLIGHT * L::WIDTH) as u64, sum)
}
