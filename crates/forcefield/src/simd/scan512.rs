//! The search of list building with AVX-512: sixteen candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{
    Around, Candidates, Center, ColumnTable, Found, Gathered, Names, Nearby, SHARERS,
};

use super::scan;

const WIDTH: usize = 16;

/// See [`lennard_neighbor::RowScanner::gather`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather(candidates: &Candidates, names: Names<'_>, runs: &[Range<u32>], nearby: &mut Nearby) {
    scan::gather::<WIDTH>(candidates, names, runs, nearby);
}

macro_rules! near {
    ($name:ident, $entry:ty, $pack:expr, $store:expr) => {
        /// See [`lennard_neighbor::RowScanner::near_narrow`].
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
        pub fn $name(nearby: &Nearby, center: Center, radius2: f32, found: &mut [$entry]) -> usize {
            let blocks = nearby.len.div_ceil(WIDTH);
            nearby.check(blocks * WIDTH, found.len());
            let [x, y, z] = center.at;
            let (x, y, z) = (_mm512_set1_ps(x), _mm512_set1_ps(y), _mm512_set1_ps(z));
            let limit = _mm512_set1_ps(radius2);
            let me = _mm512_set1_epi32(center.name as i32);
            let mut count = 0_usize;
            for block in 0..blocks {
                let at = block * WIDTH;
                // SAFETY: all four arrays have whole blocks, by the check.
                let (xj, yj, zj, name) = unsafe {
                    (
                        _mm512_loadu_ps(nearby.x.as_ptr().add(at)),
                        _mm512_loadu_ps(nearby.y.as_ptr().add(at)),
                        _mm512_loadu_ps(nearby.z.as_ptr().add(at)),
                        _mm512_loadu_si512(nearby.name.as_ptr().add(at).cast()),
                    )
                };
                let (dx, dy, dz) = (
                    _mm512_sub_ps(x, xj),
                    _mm512_sub_ps(y, yj),
                    _mm512_sub_ps(z, zj),
                );
                let r2 = _mm512_fmadd_ps(dz, dz, _mm512_fmadd_ps(dy, dy, _mm512_mul_ps(dx, dx)));
                let other = _mm512_cmpneq_epi32_mask(name, me);
                let near = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(other, r2, limit);
                let packed = $pack(_mm512_maskz_compress_epi32(near, name));
                // SAFETY: `count` is at most the candidates looked at so far, which are fewer than all, and
                // `found` is longer than all of them by a register.
                unsafe { $store(found.as_mut_ptr().add(count).cast(), packed) };
                count += near.count_ones() as usize;
            }
            count
        }
    };
}

near!(near_narrow, u16, _mm512_cvtepi32_epi16, _mm256_storeu_si256);
near!(near_wide, u32, std::convert::identity, _mm512_storeu_si512);

/// See [`lennard_neighbor::SharedScanner::gather`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather_shared(
    table: &ColumnTable,
    around: &Around,
    runs: &[Range<u32>],
    gathered: &mut Gathered,
) {
    gathered.make_room(table, runs);
    let from = table.at.each_ref().map(|axis| axis.as_ptr());
    let to = gathered.at.each_mut().map(|axis| axis.as_mut_ptr());
    let to_square = gathered.square.as_mut_ptr();
    let to_place = gathered.place.as_mut_ptr();
    let limit = _mm512_set1_ps(around.radius2);
    let zero = _mm512_setzero_ps();
    let ramp = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let mut len = 0_usize;
    for run in runs {
        let mut place = run.start;
        while place < run.end {
            let mut at = [zero; 3];
            let (mut gap2, mut square) = (zero, zero);
            for axis in 0..3 {
                // SAFETY: `place` is one, and the arrays are padded by a register beyond, by `make_room`.
                let fixed = unsafe { _mm512_loadu_si512(from[axis].add(place as usize).cast()) };
                let fixed = _mm512_sub_epi32(fixed, _mm512_set1_epi32(around.middle[axis]));
                let scale = _mm512_set1_ps(around.scale[axis]);
                at[axis] = _mm512_mul_ps(_mm512_cvtepi32_ps(fixed), scale);
                let half = _mm512_set1_ps(around.half[axis]);
                let gap = _mm512_max_ps(_mm512_sub_ps(_mm512_abs_ps(at[axis]), half), zero);
                gap2 = _mm512_fmadd_ps(gap, gap, gap2);
                square = _mm512_fmadd_ps(at[axis], at[axis], square);
            }
            let valid = scan::among_first((run.end - place) as usize) as u16;
            let near = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(valid, gap2, limit);
            let number = _mm512_add_epi32(_mm512_set1_epi32(place as i32), ramp);
            // SAFETY: `len` is at most the places looked at so far, and there is room for a register more than all.
            unsafe {
                for axis in 0..3 {
                    let packed = _mm512_maskz_compress_ps(near, at[axis]);
                    _mm512_storeu_ps(to[axis].add(len), packed);
                }
                let packed = _mm512_maskz_compress_ps(near, square);
                _mm512_storeu_ps(to_square.add(len), packed);
                let packed = _mm512_maskz_compress_epi32(near, number);
                _mm512_storeu_si512(to_place.add(len).cast(), packed);
            }
            len += near.count_ones() as usize;
            place += WIDTH as u32;
        }
    }
    gathered.len = len;
}

/// See [`lennard_neighbor::SharedScanner::near`]; distances are folded into a box of these sides, or not.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn near_shared<const FOLDED: bool>(
    gathered: &Gathered,
    around: &Around,
    own: [[f32; 3]; SHARERS],
    sides: [f32; 3],
    first: u32,
    found: &mut Found,
) {
    gathered.check(found);
    let to = found.places.each_mut().map(|places| places.as_mut_ptr());
    let from = gathered.at.each_ref().map(|axis| axis.as_ptr());
    let from_place = gathered.place.as_ptr();
    let from_square = gathered.square.as_ptr();
    let spheres = own.map(|own| around.sphere(own));
    let first = _mm512_set1_epi32(first as i32);
    let sharers = _mm512_set1_epi32(SHARERS as i32);
    // In registers: from memory, each would wait for what was written there last.
    let [mut for_all, mut for_first_two, mut for_last_two] = found.len;
    for at in (0..gathered.len).step_by(WIDTH) {
        // SAFETY: a register beyond the last element can be read, by the check.
        let (square, x, y, z, place) = unsafe {
            (
                _mm512_loadu_ps(from_square.add(at)),
                _mm512_loadu_ps(from[0].add(at)),
                _mm512_loadu_ps(from[1].add(at)),
                _mm512_loadu_ps(from[2].add(at)),
                _mm512_loadu_si512(from_place.add(at).cast()),
            )
        };
        let mut near = [0; SHARERS];
        for ((near, own), (t, limit)) in near.iter_mut().zip(own).zip(spheres) {
            let (mut squares, mut limit) = (square, limit);
            if FOLDED {
                (squares, limit) = (_mm512_setzero_ps(), around.radius2);
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
        let others = _mm512_cmpge_epu32_mask(_mm512_sub_epi32(place, first), sharers);
        let others = others & scan::among_first(gathered.len - at) as u16;
        let (first_two, last_two) = (near[0] | near[1], near[2] | near[3]);
        let write = |to: *mut u32, len: &mut usize, whom: u16| {
            let packed = _mm512_maskz_compress_epi32(whom, place);
            // SAFETY: `len` has grown by what was looked at so far at most, and `found` has room for a register more
            // than all of it.
            unsafe { _mm512_storeu_si512(to.add(*len).cast(), packed) };
            *len += whom.count_ones() as usize;
        };
        write(to[0], &mut for_all, first_two & last_two & others);
        write(to[1], &mut for_first_two, first_two & !last_two & others);
        write(to[2], &mut for_last_two, last_two & !first_two & others);
    }
    found.len = [for_all, for_first_two, for_last_two];
}
