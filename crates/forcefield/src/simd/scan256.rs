//! The search of list building with AVX2: eight candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{Candidates, Center, Names, Nearby, TileSearch};

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

/// See [`lennard_neighbor::TileScanner::candidates`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
pub fn tile_candidates(search: &TileSearch<'_>, runs: &[Range<u32>], found: &mut [u32]) -> usize {
    search.check(runs, found.len());
    let own = search.own as usize;
    let center = search.bounds.center.each_ref().map(|axis| axis.as_ptr());
    let half = search.bounds.half.each_ref().map(|axis| axis.as_ptr());
    let mine = search.bounds.center.each_ref().map(|axis| axis[own]);
    let my_half = search.bounds.half.each_ref().map(|axis| axis[own]);
    let zero = _mm256_setzero_ps();
    let limit = _mm256_set1_ps(search.radius2);
    let mut count = 0_usize;
    for run in runs {
        let mut partner = run.start;
        while partner < run.end {
            let at = partner as usize;
            let mut gap2 = zero;
            for axis in 0..3 {
                // SAFETY: `at` is a cluster, and the arrays are padded by a register beyond, by the check.
                let (theirs, their_half) = unsafe {
                    (
                        _mm256_loadu_si256(center[axis].add(at).cast()),
                        _mm256_loadu_ps(half[axis].add(at)),
                    )
                };
                let apart = _mm256_sub_epi32(_mm256_set1_epi32(mine[axis]), theirs);
                // The one number without an absolute value is as far in floating point with its sign taken off.
                let apart = _mm256_cvtepi32_ps(_mm256_abs_epi32(apart));
                let apart = _mm256_andnot_ps(_mm256_set1_ps(-0.0), apart);
                let halves = _mm256_add_ps(_mm256_set1_ps(my_half[axis]), their_half);
                let scale = _mm256_set1_ps(search.scale[axis]);
                let gap = _mm256_max_ps(_mm256_fmsub_ps(apart, scale, halves), zero);
                gap2 = _mm256_fmadd_ps(gap, gap, gap2);
            }
            let left = run.end - partner;
            let valid = if left >= 8 {
                0xFF
            } else {
                (1_usize << left) - 1
            };
            let near =
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(gap2, limit)) as usize & valid;
            // SAFETY: a row of the table is one register; `count` is at most the clusters looked at so far,
            // and `found` is longer than all of them by more than a register.
            unsafe {
                let lanes = _mm256_loadu_si256(PACKED[near].as_ptr().cast());
                let packed = _mm256_add_epi32(lanes, _mm256_set1_epi32(partner as i32));
                _mm256_storeu_si256(found.as_mut_ptr().add(count).cast(), packed);
            }
            count += near.count_ones() as usize;
            partner += WIDTH as u32;
        }
    }
    count
}
