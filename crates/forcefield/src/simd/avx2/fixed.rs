//! Eight singles that read rows in fixed point.

use std::arch::x86_64::*;

use glam::DVec3;

use super::{F32x8, F64x4, Fixed8};
use crate::simd::lanes::{BlockEntry, Entry, FixedLanes, Lanes, RowLanes};
use crate::simd::level::Avx2;
use crate::simd::row::FixedRow;

/// The members of a cluster relative to its center, and the center.
#[repr(C, align(32))]
struct Relative([[f32; 4]; 4], [i32; 4]);

impl FixedLanes for F32x8 {
    const FEW_REGISTERS: bool = true;

    #[inline(always)]
    unsafe fn gather(_isa: Avx2, rows: *const FixedRow, entries: *const BlockEntry) -> Fixed8 {
        // SAFETY: eight entries are readable, each numbers a readable row; a value or the token proves AVX2.
        unsafe {
            let row = |k: usize| _mm_loadu_si128((*entries.add(k)).row(rows).cast());
            let two =
                |k: usize| _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(row(k)), row(k + 4));
            let (a, b, c, d) = (two(0), two(1), two(2), two(3));
            let xy_ab = _mm256_unpacklo_epi32(a, b);
            let z_ab = _mm256_unpackhi_epi32(a, b);
            let xy_cd = _mm256_unpacklo_epi32(c, d);
            let z_cd = _mm256_unpackhi_epi32(c, d);
            Fixed8([
                _mm256_unpacklo_epi64(xy_ab, xy_cd),
                _mm256_unpackhi_epi64(xy_ab, xy_cd),
                _mm256_unpacklo_epi64(z_ab, z_cd),
                _mm256_unpackhi_epi64(z_ab, z_cd),
            ])
        }
    }

    #[inline(always)]
    fn species(rows: Fixed8) -> __m256i {
        rows.0[3]
    }

    #[inline(always)]
    fn apart(Fixed8(a): Fixed8, Fixed8(b): Fixed8) -> [Self; 3] {
        // SAFETY: a value of this type proves AVX2.
        unsafe {
            [
                Self(_mm256_cvtepi32_ps(_mm256_sub_epi32(a[0], b[0]))),
                Self(_mm256_cvtepi32_ps(_mm256_sub_epi32(a[1], b[1]))),
                Self(_mm256_cvtepi32_ps(_mm256_sub_epi32(a[2], b[2]))),
            ]
        }
    }

    #[inline(always)]
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask {
        // SAFETY: a value of this type proves AVX2.
        unsafe {
            let bits = _mm256_set1_epi32(bits as i32);
            let lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_cmpeq_epi32(_mm256_and_si256(bits, lane), lane);
            _mm256_and_ps(self.at_most(limit), _mm256_castsi256_ps(set))
        }
    }

    #[inline(always)]
    fn cluster_frame(
        _isa: Avx2,
        rows: [&FixedRow; 4],
        scale: [f64; 3],
    ) -> (Fixed8, [[Self; 3]; 4]) {
        // SAFETY: the token proves AVX2; a row has four numbers.
        unsafe {
            let row = |k: usize| _mm_loadu_si128(rows[k].as_ptr().cast());
            let half = _mm_srai_epi32::<1>(_mm_sub_epi32(row(2), row(1)));
            let center = _mm_add_epi32(row(1), half);
            let (x, y, z) = (scale[0] as f32, scale[1] as f32, scale[2] as f32);
            let scale = _mm_setr_ps(x, y, z, 0.0);
            let mut relative = Relative([[0.0; 4]; 4], [0; 4]);
            for k in 0..4 {
                let apart = _mm_cvtepi32_ps(_mm_sub_epi32(row(k), center));
                _mm_store_ps(relative.0[k].as_mut_ptr(), _mm_mul_ps(apart, scale));
            }
            _mm_store_si128(relative.1.as_mut_ptr().cast(), center);
            // Each value is broadcast as it is loaded. Without the black box, the compiler would use shuffles.
            let Relative(own, center) = std::hint::black_box(&relative);
            let spread = |k: usize| {
                let [x, y, z, _] = own[k];
                [Self(_mm256_set1_ps(x)), Self(_mm256_set1_ps(y)), Self(_mm256_set1_ps(z))]
            };
            (
                Fixed8([
                    _mm256_set1_epi32(center[0]),
                    _mm256_set1_epi32(center[1]),
                    _mm256_set1_epi32(center[2]),
                    _mm256_setzero_si256(),
                ]),
                [spread(0), spread(1), spread(2), spread(3)],
            )
        }
    }

    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; 4], unit: f64) -> [DVec3; 4] {
        [sum3(a, unit), sum3(b, unit), sum3(c, unit), sum3(d, unit)]
    }
}

/// The sums over all lanes of three values, times `unit`.
#[inline(always)]
fn sum3([x, y, z]: [F32x8; 3], unit: f64) -> DVec3 {
    F64x4::sum3(x.halves(), y.halves(), z.halves(), unit)
}
