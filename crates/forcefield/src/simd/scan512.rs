//! The search of list building with AVX-512: sixteen candidates at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use lennard_neighbor::{Candidates, Center, Names, Nearby, TileSearch};

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

/// See [`lennard_neighbor::TileScanner::candidates`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn tile_candidates(search: &TileSearch<'_>, runs: &[Range<u32>], found: &mut [u32]) -> usize {
    search.check(runs, found.len());
    let own = search.own as usize;
    let center = search.bounds.center.each_ref().map(|axis| axis.as_ptr());
    let half = search.bounds.half.each_ref().map(|axis| axis.as_ptr());
    let mine = search.bounds.center.each_ref().map(|axis| axis[own]);
    let my_half = search.bounds.half.each_ref().map(|axis| axis[own]);
    let zero = _mm512_setzero_ps();
    let limit = _mm512_set1_ps(search.radius2);
    let ramp = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
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
                        _mm512_loadu_si512(center[axis].add(at).cast()),
                        _mm512_loadu_ps(half[axis].add(at)),
                    )
                };
                let apart = _mm512_sub_epi32(_mm512_set1_epi32(mine[axis]), theirs);
                // The one number without an absolute value is far enough as an unsigned one.
                let apart = _mm512_cvtepu32_ps(_mm512_abs_epi32(apart));
                let halves = _mm512_add_ps(_mm512_set1_ps(my_half[axis]), their_half);
                let scale = _mm512_set1_ps(search.scale[axis]);
                let gap = _mm512_max_ps(_mm512_fmsub_ps(apart, scale, halves), zero);
                gap2 = _mm512_fmadd_ps(gap, gap, gap2);
            }
            let left = run.end - partner;
            let valid = if left >= 16 {
                u16::MAX
            } else {
                (1 << left) - 1
            };
            let near = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(valid, gap2, limit);
            let number = _mm512_add_epi32(_mm512_set1_epi32(partner as i32), ramp);
            let packed = _mm512_maskz_compress_epi32(near, number);
            // SAFETY: `count` is at most the clusters looked at so far, and `found` is longer than all of
            // them by a register.
            unsafe { _mm512_storeu_si512(found.as_mut_ptr().add(count).cast(), packed) };
            count += near.count_ones() as usize;
            partner += WIDTH as u32;
        }
    }
    count
}
