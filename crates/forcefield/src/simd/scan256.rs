//! The search of list building with AVX2: eight candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{
    Around, Candidates, Center, ColumnTable, Found, Gathered, Names, Nearby, SHARERS,
};

use super::scan;

const WIDTH: usize = 8;

/// See [`lennard_neighbor::RowScanner::gather`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
pub fn gather(candidates: &Candidates, names: Names<'_>, runs: &[Range<u32>], nearby: &mut Nearby) {
    scan::gather::<WIDTH>(candidates, names, runs, nearby);
}

/// For each mask of eight lanes, the lanes that are set, packed together.
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
        pub fn $name(nearby: &Nearby, center: Center, radius2: f32, found: &mut [$entry]) -> usize {
            let blocks = nearby.len.div_ceil(WIDTH);
            nearby.check(blocks * WIDTH, found.len());
            let [x, y, z] = center.at;
            let (x, y, z) = (_mm256_set1_ps(x), _mm256_set1_ps(y), _mm256_set1_ps(z));
            let limit = _mm256_set1_ps(radius2);
            let me = _mm256_set1_epi32(center.name as i32);
            let mut count = 0_usize;
            for block in 0..blocks {
                let at = block * WIDTH;
                // SAFETY: all four arrays have whole blocks, by the check.
                let (xj, yj, zj, name) = unsafe {
                    (
                        _mm256_loadu_ps(nearby.x.as_ptr().add(at)),
                        _mm256_loadu_ps(nearby.y.as_ptr().add(at)),
                        _mm256_loadu_ps(nearby.z.as_ptr().add(at)),
                        _mm256_loadu_si256(nearby.name.as_ptr().add(at).cast()),
                    )
                };
                let (dx, dy, dz) = (
                    _mm256_sub_ps(x, xj),
                    _mm256_sub_ps(y, yj),
                    _mm256_sub_ps(z, zj),
                );
                let r2 = _mm256_fmadd_ps(dz, dz, _mm256_fmadd_ps(dy, dy, _mm256_mul_ps(dx, dx)));
                let near = _mm256_cmp_ps::<_CMP_LE_OQ>(r2, limit);
                let own = _mm256_castsi256_ps(_mm256_cmpeq_epi32(name, me));
                let near = _mm256_movemask_ps(_mm256_andnot_ps(own, near)) as usize;
                // SAFETY: a row of the table is one register; `count` is at most the candidates looked at so
                // far, which are fewer than all, and `found` is longer than all of them by a register.
                unsafe {
                    let lanes = _mm256_loadu_si256(PACKED[near].as_ptr().cast());
                    let packed = _mm256_permutevar8x32_epi32(name, lanes);
                    $store(found.as_mut_ptr().add(count).cast(), packed);
                }
                count += near.count_ones() as usize;
            }
            count
        }
    };
}

near!(near_narrow, u16, |to, names| {
    let halves = (
        _mm256_castsi256_si128(names),
        _mm256_extracti128_si256::<1>(names),
    );
    _mm_storeu_si128(to, _mm_packus_epi32(halves.0, halves.1));
});
near!(near_wide, u32, _mm256_storeu_si256);

/// See [`lennard_neighbor::SharedScanner::gather`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
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
    let limit = _mm256_set1_ps(around.radius2);
    let zero = _mm256_setzero_ps();
    let mut len = 0_usize;
    for run in runs {
        let mut place = run.start;
        while place < run.end {
            let mut at = [zero; 3];
            let (mut gap2, mut square) = (zero, zero);
            for axis in 0..3 {
                // SAFETY: `place` is one, and the arrays are padded by a register beyond, by `make_room`.
                let fixed = unsafe { _mm256_loadu_si256(from[axis].add(place as usize).cast()) };
                let fixed = _mm256_sub_epi32(fixed, _mm256_set1_epi32(around.middle[axis]));
                let scale = _mm256_set1_ps(around.scale[axis]);
                at[axis] = _mm256_mul_ps(_mm256_cvtepi32_ps(fixed), scale);
                let half = _mm256_set1_ps(around.half[axis]);
                let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), at[axis]);
                let gap = _mm256_max_ps(_mm256_sub_ps(size, half), zero);
                gap2 = _mm256_fmadd_ps(gap, gap, gap2);
                square = _mm256_fmadd_ps(at[axis], at[axis], square);
            }
            let valid = scan::among_first((run.end - place) as usize) as usize & 0xFF;
            let near =
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(gap2, limit)) as usize & valid;
            // SAFETY: a row of the table is one register; `len` is at most the places looked at so far, and there is
            // room for a register more than all.
            unsafe {
                let lanes = _mm256_loadu_si256(PACKED[near].as_ptr().cast());
                for axis in 0..3 {
                    let packed = _mm256_permutevar8x32_ps(at[axis], lanes);
                    _mm256_storeu_ps(to[axis].add(len), packed);
                }
                let packed = _mm256_permutevar8x32_ps(square, lanes);
                _mm256_storeu_ps(to_square.add(len), packed);
                let packed = _mm256_add_epi32(lanes, _mm256_set1_epi32(place as i32));
                _mm256_storeu_si256(to_place.add(len).cast(), packed);
            }
            len += near.count_ones() as usize;
            place += WIDTH as u32;
        }
    }
    gathered.len = len;
}

/// See [`lennard_neighbor::SharedScanner::near`]; distances are folded into a box of these sides, or not.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
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
    let first = _mm256_set1_epi32(first as i32);
    let last = _mm256_set1_epi32(SHARERS as i32 - 1);
    for at in (0..gathered.len).step_by(WIDTH) {
        // SAFETY: a register beyond the last element can be read, by the check.
        let (square, x, y, z, place) = unsafe {
            (
                _mm256_loadu_ps(from_square.add(at)),
                _mm256_loadu_ps(from[0].add(at)),
                _mm256_loadu_ps(from[1].add(at)),
                _mm256_loadu_ps(from[2].add(at)),
                _mm256_loadu_si256(from_place.add(at).cast()),
            )
        };
        let mut near = [0; SHARERS];
        for ((near, own), (t, limit)) in near.iter_mut().zip(own).zip(spheres) {
            let (mut squares, mut limit) = (square, limit);
            if FOLDED {
                (squares, limit) = (_mm256_setzero_ps(), around.radius2);
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
        // Sharers are those whose distance in number, without a sign, is at most `last`.
        let apart = _mm256_sub_epi32(place, first);
        let own = _mm256_cmpeq_epi32(_mm256_min_epu32(apart, last), apart);
        let own = _mm256_movemask_ps(_mm256_castsi256_ps(own)) as usize;
        let others = !own & 0xFF & scan::among_first(gathered.len - at) as usize;
        let (first_two, last_two) = (near[0] | near[1], near[2] | near[3]);
        let whom = [
            first_two & last_two & others,
            first_two & !last_two & others,
            last_two & !first_two & others,
        ];
        for ((to, len), whom) in to.iter().zip(&mut found.len).zip(whom) {
            // SAFETY: a row of the table is one register; `len` has grown by what was looked at so far at most, and
            // `found` has room for a register more than all of it.
            unsafe {
                let lanes = _mm256_loadu_si256(PACKED[whom].as_ptr().cast());
                let packed = _mm256_permutevar8x32_epi32(place, lanes);
                _mm256_storeu_si256(to.add(*len).cast(), packed);
            }
            *len += whom.count_ones() as usize;
        }
    }
}
