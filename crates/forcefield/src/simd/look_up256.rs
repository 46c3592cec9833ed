//! Rows of pair laws in lanes of AVX2.

use std::arch::x86_64::*;

use super::avx2::{F32x8, F64x4};
use crate::number::{Number, RowsOf};

impl F64x4 {
    /// [`Lanes::look_up`](super::Lanes::look_up).
    #[inline(always)]
    pub(super) fn row_of(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        // Rows are numbered in units of 8 bytes, which an address takes without a shift.
        const UNITS: usize = 4;
        let counts_from = f64::COUNTS_FROM.to_bits() + rows.first;
        // SAFETY: a value of this type proves AVX2. A clamped number has a row, and a number that is not one becomes the lowest.
        unsafe {
            let held = _mm256_max_pd(self.0, _mm256_set1_pd(rows.lowest));
            let held = _mm256_castpd_si256(_mm256_min_pd(held, _mm256_set1_pd(rows.highest)));
            let number = _mm256_srlv_epi64(held, _mm256_set1_epi64x(rows.shift.into()));
            let begin = _mm256_and_si256(held, _mm256_set1_epi64x(-1 << rows.shift));
            let first = _mm256_sub_epi64(
                _mm256_castpd_si256(first.0),
                _mm256_set1_epi64x(counts_from as i64),
            );
            let number = _mm256_add_epi64(number, first);
            let mut at = [0_u64; 4];
            let units = _mm256_slli_epi64::<{ UNITS.ilog2() as i32 }>(number);
            _mm256_storeu_si256(at.as_mut_ptr().cast(), units);
            let rows = rows.rows();
            let row = |k: usize| {
                debug_assert!(at[k] as usize / UNITS < rows.len());
                _mm256_load_pd(rows.as_ptr().cast::<u64>().add(at[k] as usize).cast())
            };
            let (a, b, c, d) = (row(0), row(1), row(2), row(3));
            let even_low = _mm256_unpacklo_pd(a, b);
            let odd_low = _mm256_unpackhi_pd(a, b);
            let even_high = _mm256_unpacklo_pd(c, d);
            let odd_high = _mm256_unpackhi_pd(c, d);
            let [u, g0, g1, g2] = [
                _mm256_permute2f128_pd::<0x20>(even_low, even_high),
                _mm256_permute2f128_pd::<0x20>(odd_low, odd_high),
                _mm256_permute2f128_pd::<0x31>(even_low, even_high),
                _mm256_permute2f128_pd::<0x31>(odd_low, odd_high),
            ];
            let g3 = _mm256_castsi256_pd(_mm256_slli_epi64::<32>(_mm256_castpd_si256(g2)));
            let row = [Self(u), Self(g0), Self(g1), Self(g2), Self(g3)];
            (Self(_mm256_sub_pd(self.0, _mm256_castsi256_pd(begin))), row)
        }
    }
}

impl F32x8 {
    /// [`Lanes::look_up`](super::Lanes::look_up).
    #[inline(always)]
    pub(super) fn row_of(self, rows: &RowsOf<f32>, first: Self) -> (Self, [Self; 5]) {
        const UNITS: usize = 2;
        let counts_from = (f32::COUNTS_FROM as f32).to_bits() + rows.first as u32;
        // SAFETY: as above.
        unsafe {
            let held = _mm256_max_ps(self.0, _mm256_set1_ps(rows.lowest as f32));
            let held =
                _mm256_castps_si256(_mm256_min_ps(held, _mm256_set1_ps(rows.highest as f32)));
            let number = _mm256_srlv_epi32(held, _mm256_set1_epi32(rows.shift as i32));
            let begin = _mm256_and_si256(held, _mm256_set1_epi32(-1 << rows.shift));
            let first = _mm256_sub_epi32(
                _mm256_castps_si256(first.0),
                _mm256_set1_epi32(counts_from as i32),
            );
            let number = _mm256_add_epi32(number, first);
            let mut at = [0_u32; 8];
            let units = _mm256_slli_epi32::<{ UNITS.ilog2() as i32 }>(number);
            _mm256_storeu_si256(at.as_mut_ptr().cast(), units);
            let rows = rows.rows();
            let row = |k: usize| {
                debug_assert!(at[k] as usize / UNITS < rows.len());
                _mm_load_ps(rows.as_ptr().cast::<u64>().add(at[k] as usize).cast())
            };
            let two = |k: usize| {
                let low = _mm256_castps128_ps256(row(k));
                _mm256_castps_pd(_mm256_insertf128_ps::<1>(low, row(k + 4)))
            };
            let (a, b, c, d) = (two(0), two(1), two(2), two(3));
            let low = |p: __m256d, q: __m256d| {
                _mm256_castps_pd(_mm256_unpacklo_ps(_mm256_castpd_ps(p), _mm256_castpd_ps(q)))
            };
            let high = |p: __m256d, q: __m256d| {
                _mm256_castps_pd(_mm256_unpackhi_ps(_mm256_castpd_ps(p), _mm256_castpd_ps(q)))
            };
            let (first_ab, last_ab) = (low(a, b), high(a, b));
            let (first_cd, last_cd) = (low(c, d), high(c, d));
            let [u, g0, g1, g2] = [
                _mm256_castpd_ps(_mm256_unpacklo_pd(first_ab, first_cd)),
                _mm256_castpd_ps(_mm256_unpackhi_pd(first_ab, first_cd)),
                _mm256_castpd_ps(_mm256_unpacklo_pd(last_ab, last_cd)),
                _mm256_castpd_ps(_mm256_unpackhi_pd(last_ab, last_cd)),
            ];
            let g3 = _mm256_castsi256_ps(_mm256_slli_epi32::<20>(_mm256_castps_si256(g2)));
            let row = [Self(u), Self(g0), Self(g1), Self(g2), Self(g3)];
            (Self(_mm256_sub_ps(self.0, _mm256_castsi256_ps(begin))), row)
        }
    }
}
