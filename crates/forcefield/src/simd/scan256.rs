//! The search of list building with AVX2: eight candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{
    CLUSTER, Candidates, Center, ClusterNeighbors, ColumnTable, GroupBounds, GroupCandidates,
    Numbering, RowCoordinates,
};

use super::scan;

const WIDTH: usize = 8;

/// See [`lennard_neighbor::RowScanner::gather`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather(
    coordinates: &RowCoordinates,
    numbering: Numbering<'_>,
    runs: &[Range<u32>],
    candidates: &mut Candidates,
) {
    scan::gather::<WIDTH>(coordinates, numbering, runs, candidates);
}

/// For each mask of eight lanes, the numbers of the lanes that are set, packed together.
static PACKED: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

macro_rules! near {
    ($name:ident, $entry:ty, $store:expr) => {
        /// See [`lennard_neighbor::RowScanner::near_narrow`].
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
        pub fn $name(
            candidates: &Candidates,
            center: Center,
            radius2: f32,
            found: &mut [$entry],
        ) -> usize {
            let blocks = candidates.len.div_ceil(WIDTH);
            candidates.check(blocks * WIDTH, found.len());
            let [x, y, z] = center.at;
            let (x, y, z) = (_mm256_set1_ps(x), _mm256_set1_ps(y), _mm256_set1_ps(z));
            let limit = _mm256_set1_ps(radius2);
            let own_number = _mm256_set1_epi32(center.number as i32);
            let mut count = 0_usize;
            for block in 0..blocks {
                let at = block * WIDTH;
                // SAFETY: all four arrays have whole registers, as the check found.
                let (xj, yj, zj, number) = unsafe {
                    (
                        _mm256_loadu_ps(candidates.x.as_ptr().add(at)),
                        _mm256_loadu_ps(candidates.y.as_ptr().add(at)),
                        _mm256_loadu_ps(candidates.z.as_ptr().add(at)),
                        _mm256_loadu_si256(candidates.number.as_ptr().add(at).cast()),
                    )
                };
                let (dx, dy, dz) =
                    (_mm256_sub_ps(x, xj), _mm256_sub_ps(y, yj), _mm256_sub_ps(z, zj));
                let r2 = _mm256_fmadd_ps(dz, dz, _mm256_fmadd_ps(dy, dy, _mm256_mul_ps(dx, dx)));
                let near = _mm256_cmp_ps::<_CMP_LE_OQ>(r2, limit);
                let own = _mm256_castsi256_ps(_mm256_cmpeq_epi32(number, own_number));
                let near = _mm256_movemask_ps(_mm256_andnot_ps(own, near)) as usize;
                // SAFETY: a row of the table is one register; `count` is at most the number of
                // candidates read so far, and `found` has room for all of them and a register more.
                unsafe {
                    let lanes = _mm256_loadu_si256(PACKED[near].as_ptr().cast());
                    let packed = _mm256_permutevar8x32_epi32(number, lanes);
                    $store(found.as_mut_ptr().add(count).cast(), packed);
                }
                count += near.count_ones() as usize;
            }
            count
        }
    };
}

near!(near_narrow, u16, |to, numbers| {
    let halves = (_mm256_castsi256_si128(numbers), _mm256_extracti128_si256::<1>(numbers));
    _mm_storeu_si128(to, _mm_packus_epi32(halves.0, halves.1));
});
near!(near_wide, u32, _mm256_storeu_si256);

/// See [`lennard_neighbor::ClusterScanner::gather`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather_cluster(
    table: &ColumnTable,
    bounds: &GroupBounds,
    runs: &[Range<u32>],
    candidates: &mut GroupCandidates,
) {
    candidates.make_room(table, runs);
    let from = table.at().map(<[i32]>::as_ptr);
    let to = candidates.at.each_mut().map(|axis| axis.as_mut_ptr());
    let to_square = candidates.square.as_mut_ptr();
    let to_slot = candidates.slot.as_mut_ptr();
    let limit = _mm256_set1_ps(bounds.radius2);
    let zero = _mm256_setzero_ps();
    let mut len = 0_usize;
    for run in runs {
        let mut slot = run.start;
        while slot < run.end {
            let mut at = [zero; 3];
            let (mut gap2, mut square) = (zero, zero);
            for axis in 0..3 {
                // SAFETY: `slot` is a slot, and the arrays have a register of padding, as `make_room` checked.
                let fixed = unsafe { _mm256_loadu_si256(from[axis].add(slot as usize).cast()) };
                let fixed = _mm256_sub_epi32(fixed, _mm256_set1_epi32(bounds.middle[axis]));
                let scale = _mm256_set1_ps(bounds.scale[axis]);
                at[axis] = _mm256_mul_ps(_mm256_cvtepi32_ps(fixed), scale);
                let half = _mm256_set1_ps(bounds.half[axis]);
                let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), at[axis]);
                let gap = _mm256_max_ps(_mm256_sub_ps(size, half), zero);
                gap2 = _mm256_fmadd_ps(gap, gap, gap2);
                square = _mm256_fmadd_ps(at[axis], at[axis], square);
            }
            let valid = scan::first_bits((run.end - slot) as usize) as usize & 0xFF;
            let near =
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(gap2, limit)) as usize & valid;
            // SAFETY: a row of the table is one register; `len` is at most the number of slots read so far,
            // and there is room for all of them and a register more.
            unsafe {
                let lanes = _mm256_loadu_si256(PACKED[near].as_ptr().cast());
                for axis in 0..3 {
                    let packed = _mm256_permutevar8x32_ps(at[axis], lanes);
                    _mm256_storeu_ps(to[axis].add(len), packed);
                }
                let packed = _mm256_permutevar8x32_ps(square, lanes);
                _mm256_storeu_ps(to_square.add(len), packed);
                let packed = _mm256_add_epi32(lanes, _mm256_set1_epi32(slot as i32));
                _mm256_storeu_si256(to_slot.add(len).cast(), packed);
            }
            len += near.count_ones() as usize;
            slot += WIDTH as u32;
        }
    }
    candidates.len = len;
}

/// See [`lennard_neighbor::ClusterScanner::near`]; distances are folded into a box of these sides where `FOLDED`.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
pub fn near_cluster<const FOLDED: bool>(
    candidates: &GroupCandidates,
    bounds: &GroupBounds,
    own: [[f32; 3]; CLUSTER],
    sides: [f32; 3],
    first: u32,
    found: &mut ClusterNeighbors,
) {
    found.check(candidates);
    let to = found.slots.each_mut().map(|slots| slots.as_mut_ptr());
    let from = candidates.at.each_ref().map(|axis| axis.as_ptr());
    let from_slot = candidates.slot.as_ptr();
    let from_square = candidates.square.as_ptr();
    let spheres = own.map(|own| bounds.sphere(own));
    let first = _mm256_set1_epi32(first as i32);
    let last = _mm256_set1_epi32(CLUSTER as i32 - 1);
    for at in (0..candidates.len).step_by(WIDTH) {
        // SAFETY: a register behind the last candidate is readable, as the check found.
        let (square, x, y, z, slot) = unsafe {
            (
                _mm256_loadu_ps(from_square.add(at)),
                _mm256_loadu_ps(from[0].add(at)),
                _mm256_loadu_ps(from[1].add(at)),
                _mm256_loadu_ps(from[2].add(at)),
                _mm256_loadu_si256(from_slot.add(at).cast()),
            )
        };
        let mut near = [0; CLUSTER];
        for ((near, own), (t, limit)) in near.iter_mut().zip(own).zip(spheres) {
            let (mut squares, mut limit) = (square, limit);
            if FOLDED {
                (squares, limit) = (_mm256_setzero_ps(), bounds.radius2);
                for ((c, own), length) in [x, y, z].into_iter().zip(own).zip(sides) {
                    let d = _mm256_sub_ps(c, _mm256_set1_ps(own));
                    let boxes = _mm256_mul_ps(d, _mm256_set1_ps(1.0 / length));
                    let boxes =
                        _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(boxes);
                    let d = _mm256_fnmadd_ps(boxes, _mm256_set1_ps(length), d);
                    squares = _mm256_fmadd_ps(d, d, squares);
                }
            } else {
                for (c, t) in [x, y, z].into_iter().zip(t) {
                    squares = _mm256_fnmadd_ps(c, _mm256_set1_ps(t), squares);
                }
            }
            let near_by = _mm256_cmp_ps::<_CMP_LE_OQ>(squares, _mm256_set1_ps(limit));
            *near = _mm256_movemask_ps(near_by) as usize;
        }
        // The members are the slots whose unsigned distance from `first` is at most `last`.
        let apart = _mm256_sub_epi32(slot, first);
        let own = _mm256_cmpeq_epi32(_mm256_min_epu32(apart, last), apart);
        let own = _mm256_movemask_ps(_mm256_castsi256_ps(own)) as usize;
        let others = !own & 0xFF & scan::first_bits(candidates.len - at) as usize;
        let (first_half, second_half) = (near[0] | near[1], near[2] | near[3]);
        let kinds = [
            first_half & second_half & others,
            first_half & !second_half & others,
            second_half & !first_half & others,
        ];
        for ((to, len), mask) in to.iter().zip(&mut found.len).zip(kinds) {
            // SAFETY: a row of the table is one register. `len` has grown by at most the number of candidates read so
            // far, and `found` has room for all of them and a register more.
            unsafe {
                let lanes = _mm256_loadu_si256(PACKED[mask].as_ptr().cast());
                let packed = _mm256_permutevar8x32_epi32(slot, lanes);
                _mm256_storeu_si256(to.add(*len).cast(), packed);
            }
            *len += mask.count_ones() as usize;
        }
    }
}
