//! Sixteen singles that read rows in fixed point.

use std::arch::x86_64::*;

use glam::DVec3;

use super::{F32x16, Fixed16};
use crate::simd::lanes::{BlockEntry, Entry, FixedLanes};
use crate::simd::level::Avx512;
use crate::simd::row::FixedRow;

/// The members of a cluster relative to its center, and the center.
#[repr(C, align(64))]
struct Relative([f32; 16], [i32; 4]);

impl FixedLanes for F32x16 {
    #[inline(always)]
    unsafe fn gather(_isa: Avx512, rows: *const FixedRow, entries: *const BlockEntry) -> Fixed16 {
        // SAFETY: sixteen entries are readable, each numbers a readable row; a value or the token proves AVX-512.
        unsafe {
            let row = |k: usize| _mm_loadu_si128((*entries.add(k)).row(rows).cast());
            let four = |k: usize| {
                let v = _mm512_castsi128_si512(row(k));
                let v = _mm512_inserti32x4::<1>(v, row(k + 4));
                let v = _mm512_inserti32x4::<2>(v, row(k + 8));
                _mm512_inserti32x4::<3>(v, row(k + 12))
            };
            // Rows are loaded in fours and transposed within each quarter: lanes end in the order of the entries.
            let (a, b, c, d) = (four(0), four(1), four(2), four(3));
            let xy_ab = _mm512_unpacklo_epi32(a, b);
            let z_ab = _mm512_unpackhi_epi32(a, b);
            let xy_cd = _mm512_unpacklo_epi32(c, d);
            let z_cd = _mm512_unpackhi_epi32(c, d);
            Fixed16([
                _mm512_unpacklo_epi64(xy_ab, xy_cd),
                _mm512_unpackhi_epi64(xy_ab, xy_cd),
                _mm512_unpacklo_epi64(z_ab, z_cd),
                _mm512_unpackhi_epi64(z_ab, z_cd),
            ])
        }
    }

    #[inline(always)]
    fn species(rows: Fixed16) -> __m512i {
        rows.0[3]
    }

    #[inline(always)]
    fn apart(Fixed16(a): Fixed16, Fixed16(b): Fixed16) -> [Self; 3] {
        // SAFETY: a value of this type proves AVX-512.
        unsafe {
            [
                Self(_mm512_cvtepi32_ps(_mm512_sub_epi32(a[0], b[0]))),
                Self(_mm512_cvtepi32_ps(_mm512_sub_epi32(a[1], b[1]))),
                Self(_mm512_cvtepi32_ps(_mm512_sub_epi32(a[2], b[2]))),
            ]
        }
    }

    #[inline(always)]
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask {
        // SAFETY: a value of this type proves AVX-512.
        unsafe { _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(bits as u16, self.0, limit.0) }
    }

    #[inline(always)]
    fn cluster_frame(
        _isa: Avx512,
        rows: [&FixedRow; 4],
        scale: [f64; 3],
    ) -> (Fixed16, [[Self; 3]; 4]) {
        // SAFETY: the token proves AVX-512.
        unsafe {
            let row = |k: usize| _mm_loadu_si128(rows[k].as_ptr().cast());
            let half = _mm_srai_epi32::<1>(_mm_sub_epi32(row(2), row(1)));
            let center = _mm_add_epi32(row(1), half);
            let four = _mm512_castsi128_si512(row(0));
            let four = _mm512_inserti32x4::<1>(four, row(1));
            let four = _mm512_inserti32x4::<2>(four, row(2));
            let four = _mm512_inserti32x4::<3>(four, row(3));
            let apart = _mm512_sub_epi32(four, _mm512_broadcast_i32x4(center));
            let (x, y, z) = (scale[0] as f32, scale[1] as f32, scale[2] as f32);
            let scale = _mm512_broadcast_f32x4(_mm_setr_ps(x, y, z, 0.0));
            let mut relative = Relative([0.0; 16], [0; 4]);
            _mm512_store_ps(
                relative.0.as_mut_ptr(),
                _mm512_mul_ps(_mm512_cvtepi32_ps(apart), scale),
            );
            _mm_store_si128(relative.1.as_mut_ptr().cast(), center);
            // Each value is broadcast as it is loaded, which leaves the arithmetic ports free.
            // Without the black box, the compiler would use shuffles.
            let Relative(own, center) = std::hint::black_box(&relative);
            let spread = |lane: usize| Self(_mm512_set1_ps(own[lane]));
            (
                Fixed16([
                    _mm512_set1_epi32(center[0]),
                    _mm512_set1_epi32(center[1]),
                    _mm512_set1_epi32(center[2]),
                    _mm512_setzero_si512(),
                ]),
                [
                    [spread(0), spread(1), spread(2)],
                    [spread(4), spread(5), spread(6)],
                    [spread(8), spread(9), spread(10)],
                    [spread(12), spread(13), spread(14)],
                ],
            )
        }
    }

    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; 4], unit: f64) -> [DVec3; 4] {
        // SAFETY: as above.
        unsafe {
            // Each lane holds a handful of pairs. Four levels of single precision add little to their error.
            // Each axis is reduced by itself: first two members per quarter, then all four.
            let two = |p: Self, q: Self| {
                let sum = _mm512_add_ps(_mm512_unpacklo_ps(p.0, q.0), _mm512_unpackhi_ps(p.0, q.0));
                _mm512_castps_pd(sum)
            };
            let four = |p: __m512d, q: __m512d| {
                _mm512_add_ps(
                    _mm512_castpd_ps(_mm512_unpacklo_pd(p, q)),
                    _mm512_castpd_ps(_mm512_unpackhi_pd(p, q)),
                )
            };
            let x = four(two(a[0], b[0]), two(c[0], d[0]));
            let y = four(two(a[1], b[1]), two(c[1], d[1]));
            let z = four(two(a[2], b[2]), two(c[2], d[2]));
            // The quarters are x, x, y, y. The sums of the halves leave one of each.
            let xy = _mm512_add_ps(
                _mm512_shuffle_f32x4::<0b01_00_01_00>(x, y),
                _mm512_shuffle_f32x4::<0b11_10_11_10>(x, y),
            );
            let xy = _mm512_add_ps(xy, _mm512_shuffle_f32x4::<0b10_11_00_01>(xy, xy));
            let z = _mm256_add_ps(_mm512_castps512_ps256(z), _mm512_extractf32x8_ps::<1>(z));
            let z = _mm_add_ps(_mm256_castps256_ps128(z), _mm256_extractf128_ps::<1>(z));
            let of_one = |axis: __m128| _mm256_mul_pd(_mm256_cvtps_pd(axis), _mm256_set1_pd(unit));
            let mut sums = [[0.0; 4]; 3];
            _mm256_storeu_pd(sums[0].as_mut_ptr(), of_one(_mm512_castps512_ps128(xy)));
            let y = _mm512_extractf32x4_ps::<2>(xy);
            _mm256_storeu_pd(sums[1].as_mut_ptr(), of_one(y));
            _mm256_storeu_pd(sums[2].as_mut_ptr(), of_one(z));
            let sum = |k: usize| DVec3::new(sums[0][k], sums[1][k], sums[2][k]);
            [sum(0), sum(1), sum(2), sum(3)]
        }
    }
}
