//! The search of list building with AVX-512: sixteen candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{
    CLUSTER, Candidates, Center, ClusterNeighbors, ColumnTable, GroupBounds, GroupCandidates,
    Numbering, RowCoordinates,
};

use super::scan;

const WIDTH: usize = 16;

/// See [`lennard_neighbor::RowScanner::gather`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather(
    coordinates: &RowCoordinates,
    numbering: Numbering<'_>,
    runs: &[Range<u32>],
    candidates: &mut Candidates,
) {
    scan::gather::<WIDTH>(coordinates, numbering, runs, candidates);
}

macro_rules! near {
    ($name:ident, $entry:ty, $pack:expr, $store:expr) => {
        /// See [`lennard_neighbor::RowScanner::near_narrow`].
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
        pub fn $name(
            candidates: &Candidates,
            center: Center,
            radius2: f32,
            found: &mut [$entry],
        ) -> usize {
            let blocks = candidates.len.div_ceil(WIDTH);
            candidates.check(blocks * WIDTH, found.len());
            let [x, y, z] = center.at;
            let (x, y, z) = (_mm512_set1_ps(x), _mm512_set1_ps(y), _mm512_set1_ps(z));
            let limit = _mm512_set1_ps(radius2);
            let own_number = _mm512_set1_epi32(center.number as i32);
            let mut count = 0_usize;
            for block in 0..blocks {
                let at = block * WIDTH;
                // SAFETY: all four arrays have whole registers, as the check found.
                let (xj, yj, zj, number) = unsafe {
                    (
                        _mm512_loadu_ps(candidates.x.as_ptr().add(at)),
                        _mm512_loadu_ps(candidates.y.as_ptr().add(at)),
                        _mm512_loadu_ps(candidates.z.as_ptr().add(at)),
                        _mm512_loadu_si512(candidates.number.as_ptr().add(at).cast()),
                    )
                };
                let (dx, dy, dz) =
                    (_mm512_sub_ps(x, xj), _mm512_sub_ps(y, yj), _mm512_sub_ps(z, zj));
                let r2 = _mm512_fmadd_ps(dz, dz, _mm512_fmadd_ps(dy, dy, _mm512_mul_ps(dx, dx)));
                let other = _mm512_cmpneq_epi32_mask(number, own_number);
                let near = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(other, r2, limit);
                let packed = $pack(_mm512_maskz_compress_epi32(near, number));
                // SAFETY: `count` is at most the number of candidates read so far, and `found` has room for all of
                // them and a register more.
                unsafe { $store(found.as_mut_ptr().add(count).cast(), packed) };
                count += near.count_ones() as usize;
            }
            count
        }
    };
}

near!(near_narrow, u16, _mm512_cvtepi32_epi16, _mm256_storeu_si256);
near!(near_wide, u32, std::convert::identity, _mm512_storeu_si512);

/// See [`lennard_neighbor::ClusterScanner::gather`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
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
    let limit = _mm512_set1_ps(bounds.radius2);
    let zero = _mm512_setzero_ps();
    let ramp = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let mut len = 0_usize;
    for run in runs {
        let mut slot = run.start;
        while slot < run.end {
            let mut at = [zero; 3];
            let (mut gap2, mut square) = (zero, zero);
            for axis in 0..3 {
                // SAFETY: `slot` is a slot, and the arrays have a register of padding, as `make_room` checked.
                let fixed = unsafe { _mm512_loadu_si512(from[axis].add(slot as usize).cast()) };
                let fixed = _mm512_sub_epi32(fixed, _mm512_set1_epi32(bounds.middle[axis]));
                let scale = _mm512_set1_ps(bounds.scale[axis]);
                at[axis] = _mm512_mul_ps(_mm512_cvtepi32_ps(fixed), scale);
                let half = _mm512_set1_ps(bounds.half[axis]);
                let gap = _mm512_max_ps(_mm512_sub_ps(_mm512_abs_ps(at[axis]), half), zero);
                gap2 = _mm512_fmadd_ps(gap, gap, gap2);
                square = _mm512_fmadd_ps(at[axis], at[axis], square);
            }
            let valid = scan::first_bits((run.end - slot) as usize) as u16;
            let near = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(valid, gap2, limit);
            let number = _mm512_add_epi32(_mm512_set1_epi32(slot as i32), ramp);
            // SAFETY: `len` is at most the number of slots read so far, and there is room for all of them and a register
            // more.
            unsafe {
                for axis in 0..3 {
                    let packed = _mm512_maskz_compress_ps(near, at[axis]);
                    _mm512_storeu_ps(to[axis].add(len), packed);
                }
                let packed = _mm512_maskz_compress_ps(near, square);
                _mm512_storeu_ps(to_square.add(len), packed);
                let packed = _mm512_maskz_compress_epi32(near, number);
                _mm512_storeu_si512(to_slot.add(len).cast(), packed);
            }
            len += near.count_ones() as usize;
            slot += WIDTH as u32;
        }
    }
    candidates.len = len;
}

/// See [`lennard_neighbor::ClusterScanner::near`]; distances are folded into a box of these sides where `FOLDED`.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
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
    let first = _mm512_set1_epi32(first as i32);
    let members = _mm512_set1_epi32(CLUSTER as i32);
    // Counts stay in registers: from memory, each would wait for its last store.
    let [mut for_all, mut for_first_half, mut for_second_half] = found.len;
    for at in (0..candidates.len).step_by(WIDTH) {
        // SAFETY: a register behind the last candidate is readable, as the check found.
        let (square, x, y, z, slot) = unsafe {
            (
                _mm512_loadu_ps(from_square.add(at)),
                _mm512_loadu_ps(from[0].add(at)),
                _mm512_loadu_ps(from[1].add(at)),
                _mm512_loadu_ps(from[2].add(at)),
                _mm512_loadu_si512(from_slot.add(at).cast()),
            )
        };
        let mut near = [0; CLUSTER];
        for ((near, own), (t, limit)) in near.iter_mut().zip(own).zip(spheres) {
            let (mut squares, mut limit) = (square, limit);
            if FOLDED {
                (squares, limit) = (_mm512_setzero_ps(), bounds.radius2);
                for ((c, own), length) in [x, y, z].into_iter().zip(own).zip(sides) {
                    let d = _mm512_sub_ps(c, _mm512_set1_ps(own));
                    let boxes = _mm512_mul_ps(d, _mm512_set1_ps(1.0 / length));
                    let boxes = _mm512_roundscale_ps::<_MM_FROUND_TO_NEAREST_INT>(boxes);
                    let d = _mm512_fnmadd_ps(boxes, _mm512_set1_ps(length), d);
                    squares = _mm512_fmadd_ps(d, d, squares);
                }
            } else {
                for (c, t) in [x, y, z].into_iter().zip(t) {
                    squares = _mm512_fnmadd_ps(c, _mm512_set1_ps(t), squares);
                }
            }
            *near = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(squares, _mm512_set1_ps(limit));
        }
        let others = _mm512_cmpge_epu32_mask(_mm512_sub_epi32(slot, first), members);
        let others = others & scan::first_bits(candidates.len - at) as u16;
        let (first_half, second_half) = (near[0] | near[1], near[2] | near[3]);
        let write = |to: *mut u32, len: &mut usize, mask: u16| {
            let packed = _mm512_maskz_compress_epi32(mask, slot);
            // SAFETY: `len` has grown by at most the number of candidates read so far, and `found` has room for all of
            // them and a register more.
            unsafe { _mm512_storeu_si512(to.add(*len).cast(), packed) };
            *len += mask.count_ones() as usize;
        };
        write(to[0], &mut for_all, first_half & second_half & others);
        write(to[1], &mut for_first_half, first_half & !second_half & others);
        write(to[2], &mut for_second_half, second_half & !first_half & others);
    }
    found.len = [for_all, for_first_half, for_second_half];
}
