//! The loop over tiles of four by four pairs, written once over the lanes.

use glam::DVec3;
use lennard_neighbor::{CLUSTER, ClusterRow, TileChunk, TileList, TileSearch};

use super::lanes::Lanes;
use super::pair_loop::{ChunkTotals, PerParticle, Wanted};
use super::pair_sums::PairSums;
use crate::reference::outer;
use crate::truncation::PairForm;

/// Forces on the four particles of a cluster, x of each, y of each, z of each, and padding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(64))]
pub struct ForceRow(pub [f32; 16]);

/// Registers of singles that a tile fills: each holds a few particles of one cluster, each against the four
/// of the other.
pub trait TileLanes: Lanes {
    /// Registers a tile: 16 pairs over the width.
    const REGISTERS: usize;
    /// Whether a loop of its own for cubic units is worth compiling.
    const CUBIC_LOOP: bool;

    /// Spreads the particles of a register, each over four lanes.
    ///
    /// # Safety
    /// The processor has the instruction set of the implementation.
    unsafe fn own(row: &ClusterRow, register: usize) -> Self::Own;

    /// Repeats the four particles of a row.
    ///
    /// # Safety
    /// As [`TileLanes::own`], and `row` is readable.
    unsafe fn others(row: *const ClusterRow) -> Self::Own;

    /// own − others along each axis, in units of the rows.
    ///
    /// # Safety
    /// As [`TileLanes::own`].
    unsafe fn apart(own: Self::Own, others: Self::Own) -> [Self; 3];

    /// The lanes of `mask` whose pair is set in `tile`: bit 4i + j for particle i of a cluster and j of its
    /// partner.
    fn among(mask: Self::Mask, tile: u16, register: usize) -> Self::Mask;

    /// Subtracts the sums over the particles of the register from the four of a partner.
    ///
    /// # Safety
    /// As [`TileLanes::own`], and `to` is readable and writable.
    unsafe fn take(force: [Self; 3], to: *mut ForceRow);

    /// Adds the sums over the partner's four to the particles of the register.
    ///
    /// # Safety
    /// As [`TileLanes::take`].
    unsafe fn give(force: [Self; 3], register: usize, to: *mut ForceRow);
}

/// One evaluation, as the tile loop sees it.
#[derive(Clone, Copy)]
pub struct TileJob<'a, F> {
    form: F,
    r_cut2: f64,
    /// Length of a unit along each axis, σ.
    scale: [f64; 3],
    rows: &'a [ClusterRow],
    list: &'a TileList,
}

impl<'a, F: PairForm> TileJob<'a, F> {
    /// Prepares an evaluation: `scale` is the length in σ of one unit of the rows along each axis.
    ///
    /// # Panics
    /// Where rows and list do not belong together: that is a bug of the caller.
    pub fn new(
        form: F,
        r_cut: f64,
        scale: [f64; 3],
        rows: &'a [ClusterRow],
        list: &'a TileList,
    ) -> Self {
        assert!(
            rows.len() >= list.rows(),
            "a row for each partner of the list"
        );
        Self {
            form,
            r_cut2: r_cut * r_cut,
            scale,
            rows,
            list,
        }
    }

    /// The pairs of a tile that count: of a cluster with itself each pair once, of a cluster that is not full
    /// its particles alone.
    fn pairs_of(&self, own: u32, partner: u32, same: bool) -> u16 {
        /// Pairs i < j.
        const UPPER: u16 = 0b1000_1100_1110;
        let table = self.list.table();
        let clusters = table.clusters() as u32;
        let there = |cluster: u32| {
            if cluster % clusters == clusters - 1 {
                (1_u16 << table.in_last()) - 1
            } else {
                0b1111
            }
        };
        let (mine, others) = (there(own), there(partner));
        (0..CLUSTER)
            .filter(|i| mine >> i & 1 == 1)
            .fold(0, |tile, i| tile | others << (4 * i))
            & if same { UPPER } else { u16::MAX }
    }
}

/// Runs one chunk: adds forces, in units of the rows along x times ε/σ², to `forces`, which has a row for
/// each cluster that the chunk meets.
///
/// # Safety
/// The processor has the instruction set of `L`.
#[inline(always)]
pub unsafe fn run<L: TileLanes, F: PairForm>(
    job: &TileJob<'_, F>,
    chunk: &TileChunk,
    wanted: Wanted,
    forces: &mut [ForceRow],
) -> ChunkTotals {
    assert!(
        forces.len() >= chunk.reach as usize,
        "a row for each partner"
    );
    let [sx, sy, sz] = job.scale;
    // SAFETY: the contract is passed on.
    unsafe {
        // Constants stand alone in their conditions: only so does the compiler leave out what they rule out.
        if F::RARE {
            return sweep::<L, F, true, false>(job, chunk, forces);
        }
        if L::CUBIC_LOOP && sx == sy && sy == sz {
            return match wanted {
                Wanted::Forces => sweep::<L, F, false, true>(job, chunk, forces),
                _ => sweep::<L, F, true, true>(job, chunk, forces),
            };
        }
        match wanted {
            Wanted::Forces => sweep::<L, F, false, false>(job, chunk, forces),
            _ => sweep::<L, F, true, false>(job, chunk, forces),
        }
    }
}

/// What all tiles have in common.
#[derive(Clone, Copy)]
struct Constants<L, F> {
    form: F,
    r_cut2: L,
    /// Length of a unit along y and z, in units along x.
    stretch: [L; 2],
    unit2: L,
}

/// Distances stay in units of the rows along x, and only their squares and the finished sums are scaled.
/// `CUBIC` leaves out a stretch by one. Forces are the same to the bit with and without `TOTALS`.
///
/// # Safety
/// As [`run`].
#[inline(always)]
unsafe fn sweep<L: TileLanes, F: PairForm, const TOTALS: bool, const CUBIC: bool>(
    job: &TileJob<'_, F>,
    chunk: &TileChunk,
    forces: &mut [ForceRow],
) -> ChunkTotals {
    let [sx, sy, sz] = job.scale;
    let constants = Constants {
        form: job.form,
        r_cut2: L::splat(job.r_cut2),
        stretch: [L::splat(sy / sx), L::splat(sz / sx)],
        unit2: L::splat(sx * sx),
    };
    let zero = L::splat(0.0);
    let mut totals = ChunkTotals::NOTHING;
    // SAFETY: `TileJob::new` checked that all partners of the list are rows; partners count from `first`.
    let rows = unsafe { job.rows.as_ptr().add(chunk.first as usize) };
    let to = forces.as_mut_ptr();
    for (k, span) in chunk.starts.windows(2).enumerate() {
        let partners = &chunk.partners[span[0] as usize..span[1] as usize];
        let (masked, plain) = partners.split_at(chunk.masked[k] as usize);
        let mut force = [[zero; 3]; 4];
        let mut sums = PairSums::nothing();
        // SAFETY: every partner is a row and has a row of forces (checked above), the cluster being the first
        // of them; the instruction set is there by contract.
        unsafe {
            let mut own = [L::own(&*rows.add(k), 0); 4];
            for (register, own) in own.iter_mut().enumerate().take(L::REGISTERS).skip(1) {
                *own = L::own(&*rows.add(k), register);
            }
            for partner in masked {
                let tile = job.pairs_of(
                    chunk.first + k as u32,
                    chunk.first + partner,
                    *partner as usize == k,
                );
                add::<L, F, TOTALS, CUBIC, true>(
                    &constants, &own, rows, to, *partner, tile, &mut force, &mut sums,
                );
            }
            for partner in plain {
                add::<L, F, TOTALS, CUBIC, false>(
                    &constants,
                    &own,
                    rows,
                    to,
                    *partner,
                    u16::MAX,
                    &mut force,
                    &mut sums,
                );
            }
            for (register, force) in force.iter().enumerate().take(L::REGISTERS) {
                L::give(*force, register, to.add(k));
            }
        }
        if TOTALS {
            let found = sums.totals();
            // Chunks count every pair from both of its ends.
            totals.energy += 2.0 * found.energy;
            totals.virial += 2.0 * (sx * sx) * found.virial;
            totals.laplacian += 2.0 * found.laplacian;
            totals.pairs += 2 * found.pairs;
        }
    }
    totals
}

/// Adds the pairs of one tile.
///
/// # Safety
/// As [`run`]; `partner` is a row of `rows` and of `to`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
unsafe fn add<
    L: TileLanes,
    F: PairForm,
    const TOTALS: bool,
    const CUBIC: bool,
    const MASKED: bool,
>(
    constants: &Constants<L, F>,
    own: &[L::Own; 4],
    rows: *const ClusterRow,
    to: *mut ForceRow,
    partner: u32,
    tile: u16,
    force: &mut [[L; 3]; 4],
    sums: &mut PairSums<L>,
) {
    let zero = L::splat(0.0);
    let mut back = [zero; 3];
    // SAFETY: the contract is passed on.
    unsafe {
        let others = L::others(rows.add(partner as usize));
        for register in 0..L::REGISTERS {
            let [dx, mut dy, mut dz] = L::apart(own[register], others);
            if !CUBIC {
                dy = dy * constants.stretch[0];
                dz = dz * constants.stretch[1];
            }
            let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx)) * constants.unit2;
            let mut inside = r2.at_most(constants.r_cut2);
            if MASKED {
                inside = L::among(inside, tile, register);
            }
            let pair = constants.form.eval(r2);
            let f = pair.force.keep(inside);
            let mine = &mut force[register];
            mine[0] = dx.mul_add(f, mine[0]);
            mine[1] = dy.mul_add(f, mine[1]);
            mine[2] = dz.mul_add(f, mine[2]);
            if register == 0 {
                back = [dx * f, dy * f, dz * f];
            } else {
                back[0] = dx.mul_add(f, back[0]);
                back[1] = dy.mul_add(f, back[1]);
                back[2] = dz.mul_add(f, back[2]);
            }
            if TOTALS {
                sums.add([dx, dy, dz], f, &pair, inside);
            }
        }
        L::take(back, to.add(partner as usize));
    }
}

/// Adds the entries of each particle, half of each pair to each of its ends, in double precision: asked for
/// so seldom that a plain loop does.
pub fn add_each<F: PairForm>(job: &TileJob<'_, F>, each: &mut [PerParticle]) {
    let table = job.list.table();
    let clusters = table.clusters();
    let [sx, sy, sz] = job.scale;
    for chunk in job.list.chunks() {
        for (k, span) in chunk.starts.windows(2).enumerate() {
            let own = chunk.first as usize + k;
            for partner in &chunk.partners[span[0] as usize..span[1] as usize] {
                let same = *partner as usize == k;
                let partner = chunk.first + partner;
                let tile = job.pairs_of(own as u32, partner, same);
                let (a, b) = (&job.rows[own].0, &job.rows[partner as usize].0);
                for pair in (0..CLUSTER * CLUSTER).filter(|pair| tile >> pair & 1 == 1) {
                    let (i, j) = (pair / CLUSTER, pair % CLUSTER);
                    let apart = |axis: usize| f64::from(a[axis][i].wrapping_sub(b[axis][j]));
                    let r_ij = DVec3::new(apart(0) * sx, apart(1) * sy, apart(2) * sz);
                    let r2 = r_ij.length_squared();
                    if r2 > job.r_cut2 {
                        continue;
                    }
                    let pair = job.form.eval(r2);
                    let half = 0.5 * outer(r_ij, pair.force * r_ij);
                    for place in [own * CLUSTER + i, partner as usize % clusters * CLUSTER + j] {
                        let (energy, virial) = &mut each[table.particle[place] as usize];
                        *energy += 0.5 * pair.energy;
                        *virial += half;
                    }
                }
            }
        }
    }
}

/// See [`lennard_neighbor::TileScanner::near`].
///
/// # Safety
/// The processor has the instruction set of `L`.
#[inline(always)]
pub unsafe fn near<L: TileLanes>(search: &TileSearch<'_>, candidates: &mut [u32]) -> usize {
    let [sx, sy, sz] = search.scale;
    let scale = [
        L::splat(sx.into()),
        L::splat(sy.into()),
        L::splat(sz.into()),
    ];
    let radius2 = L::splat(search.radius2.into());
    let row = &search.rows[search.own as usize];
    let mut count = 0;
    // SAFETY: the instruction set is there by contract.
    unsafe {
        let mut own = [L::own(row, 0); 4];
        for (register, own) in own.iter_mut().enumerate().take(L::REGISTERS).skip(1) {
            *own = L::own(row, register);
        }
        for k in 0..candidates.len() {
            let candidate = candidates[k];
            let others = L::others(&search.rows[candidate as usize]);
            let mut near = 0;
            for own in own.iter().take(L::REGISTERS) {
                let [dx, dy, dz] = L::apart(*own, others);
                let (dx, dy, dz) = (dx * scale[0], dy * scale[1], dz * scale[2]);
                let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                near += L::count(r2.at_most(radius2));
            }
            candidates[count] = candidate;
            count += usize::from(near > 0);
        }
    }
    count
}

/// Sums of the forces on some consecutive clusters over all chunks that meet them, in the order of chunks,
/// in units of the rows along x times ε/σ².
#[inline(always)]
pub fn collect(
    list: &TileList,
    forces: &[Vec<ForceRow>],
    clusters: std::ops::Range<usize>,
    sums: &mut [[f64; 12]],
) {
    let all = list.table().clusters();
    sums.fill([0.0; 12]);
    for (chunk, forces) in list.chunks().iter().zip(forces) {
        let (first, reach) = (chunk.first as usize, chunk.reach as usize);
        // What the chunk meets is one stretch, or two where it passes the end.
        for (begin, skipped) in [(first, 0), (0, all - first)] {
            let met = reach.saturating_sub(skipped).min(all - begin);
            let from = clusters.start.max(begin);
            let to = clusters.end.min(begin + met);
            if from >= to {
                continue;
            }
            let rows = &forces[from - begin + skipped..to - begin + skipped];
            for (sum, row) in sums[from - clusters.start..].iter_mut().zip(rows) {
                for (sum, f) in sum.iter_mut().zip(&row.0) {
                    *sum += f64::from(*f);
                }
            }
        }
    }
}

/// The functions of this module for one instruction set: `$lanes`, and the attributes that enable it.
macro_rules! tile_entries {
    ($lanes:ty $(, $enable:meta)*) => {
        /// The tile loop.
        $(#[$enable])*
        pub fn run_tiles<F: $crate::truncation::PairForm>(
            job: &$crate::simd::tile_loop::TileJob<'_, F>,
            chunk: &lennard_neighbor::TileChunk,
            wanted: $crate::simd::Wanted,
            forces: &mut [$crate::simd::ForceRow],
        ) -> $crate::simd::ChunkTotals {
            // SAFETY: this function enables the instruction set.
            unsafe { $crate::simd::tile_loop::run::<$lanes, F>(job, chunk, wanted, forces) }
        }

        /// Which clusters come near.
        $(#[$enable])*
        #[allow(dead_code, reason = "without an instruction set the neighbor crate's own does")]
        pub fn near_tiles(
            search: &lennard_neighbor::TileSearch<'_>,
            candidates: &mut [u32],
        ) -> usize {
            // SAFETY: as above.
            unsafe { $crate::simd::tile_loop::near::<$lanes>(search, candidates) }
        }

        /// Sums of the forces over chunks.
        $(#[$enable])*
        pub fn collect_tiles(
            list: &lennard_neighbor::TileList,
            forces: &[Vec<$crate::simd::ForceRow>],
            clusters: std::ops::Range<usize>,
            sums: &mut [[f64; 12]],
        ) {
            $crate::simd::tile_loop::collect(list, forces, clusters, sums);
        }
    };
}
pub(super) use tile_entries;
