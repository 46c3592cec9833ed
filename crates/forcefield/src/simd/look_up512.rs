//! Rows of pair laws in lanes of AVX-512.

use std::arch::x86_64::*;

use super::avx512::{F32x16, F64x8};
use crate::number::{Number, RowsOf};

impl F64x8 {
    /// [`Lanes::look_up`](super::Lanes::look_up).
    ///
    /// Whole rows are loaded and transposed, as rows of coordinates are: four gathers would load each row four times.
    #[inline(always)]
    pub(super) fn row_of(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        // Rows are numbered in units of 8 bytes, which an address takes without a shift.
        const UNITS: usize = 4;
        let counts_from = f64::COUNTS_FROM.to_bits() + rows.first;
        // SAFETY: a value of this type proves AVX-512. A clamped number has a row, and a number that is not one becomes the lowest.
        unsafe {
            let held = _mm512_max_pd(self.0, _mm512_set1_pd(rows.lowest));
            let held = _mm512_castpd_si512(_mm512_min_pd(held, _mm512_set1_pd(rows.highest)));
            let number = _mm512_srlv_epi64(held, _mm512_set1_epi64(rows.shift.into()));
            let begin = _mm512_and_si512(held, _mm512_set1_epi64(-1 << rows.shift));
            let first = _mm512_sub_epi64(
                _mm512_castpd_si512(first.0),
                _mm512_set1_epi64(counts_from as i64),
            );
            let number = _mm512_add_epi64(number, first);
            let mut at = [0_u64; 8];
            let units = _mm512_slli_epi64::<{ UNITS.ilog2() }>(number);
            _mm512_storeu_si512(at.as_mut_ptr().cast(), units);
            let rows = rows.rows();
            let row = |k: usize| {
                debug_assert!(at[k] as usize / UNITS < rows.len());
                _mm256_load_pd(rows.as_ptr().cast::<u64>().add(at[k] as usize).cast())
            };
            let two = |k: usize| {
                let low = _mm512_castpd256_pd512(row(k));
                _mm512_insertf64x4::<1>(low, row(k + 2))
            };
            let (a, b, c, d) = (two(0), two(1), two(4), two(5));
            let even_low = _mm512_unpacklo_pd(a, b);
            let odd_low = _mm512_unpackhi_pd(a, b);
            let even_high = _mm512_unpacklo_pd(c, d);
            let odd_high = _mm512_unpackhi_pd(c, d);
            let [u, g0, g1, g2] = [
                _mm512_shuffle_f64x2::<0b10_00_10_00>(even_low, even_high),
                _mm512_shuffle_f64x2::<0b10_00_10_00>(odd_low, odd_high),
                _mm512_shuffle_f64x2::<0b11_01_11_01>(even_low, even_high),
                _mm512_shuffle_f64x2::<0b11_01_11_01>(odd_low, odd_high),
            ];
            let g3 = _mm512_castsi512_pd(_mm512_slli_epi64::<32>(_mm512_castpd_si512(g2)));
            let row = [Self(u), Self(g0), Self(g1), Self(g2), Self(g3)];
            (Self(_mm512_sub_pd(self.0, _mm512_castsi512_pd(begin))), row)
        }
    }
}

impl F32x16 {
    /// [`Lanes::look_up`](super::Lanes::look_up).
    #[inline(always)]
    pub(super) fn row_of(self, rows: &RowsOf<f32>, first: Self) -> (Self, [Self; 5]) {
        const UNITS: usize = 2;
        let counts_from = (f32::COUNTS_FROM as f32).to_bits() + rows.first as u32;
        // SAFETY: as above.
        unsafe {
            let held = _mm512_max_ps(self.0, _mm512_set1_ps(rows.lowest as f32));
            let held =
                _mm512_castps_si512(_mm512_min_ps(held, _mm512_set1_ps(rows.highest as f32)));
            let number = _mm512_srlv_epi32(held, _mm512_set1_epi32(rows.shift as i32));
            let begin = _mm512_and_si512(held, _mm512_set1_epi32(-1 << rows.shift));
            let first = _mm512_sub_epi32(
                _mm512_castps_si512(first.0),
                _mm512_set1_epi32(counts_from as i32),
            );
            let number = _mm512_add_epi32(number, first);
            let mut at = [0_u32; 16];
            let units = _mm512_slli_epi32::<{ UNITS.ilog2() }>(number);
            _mm512_storeu_si512(at.as_mut_ptr().cast(), units);
            let rows = rows.rows();
            let row = |k: usize| {
                debug_assert!(at[k] as usize / UNITS < rows.len());
                _mm_load_ps(rows.as_ptr().cast::<u64>().add(at[k] as usize).cast())
            };
            let four = |k: usize| {
                let v = _mm512_castps128_ps512(row(k));
                let v = _mm512_insertf32x4::<1>(v, row(k + 4));
                let v = _mm512_insertf32x4::<2>(v, row(k + 8));
                _mm512_insertf32x4::<3>(v, row(k + 12))
            };
            let (a, b, c, d) = (four(0), four(1), four(2), four(3));
            let low = |p: __m512, q: __m512| _mm512_castps_pd(_mm512_unpacklo_ps(p, q));
            let high = |p: __m512, q: __m512| _mm512_castps_pd(_mm512_unpackhi_ps(p, q));
            let (first_ab, last_ab) = (low(a, b), high(a, b));
            let (first_cd, last_cd) = (low(c, d), high(c, d));
            let [u, g0, g1, g2] = [
                _mm512_castpd_ps(_mm512_unpacklo_pd(first_ab, first_cd)),
                _mm512_castpd_ps(_mm512_unpackhi_pd(first_ab, first_cd)),
                _mm512_castpd_ps(_mm512_unpacklo_pd(last_ab, last_cd)),
                _mm512_castpd_ps(_mm512_unpackhi_pd(last_ab, last_cd)),
            ];
            let g3 = _mm512_castsi512_ps(_mm512_slli_epi32::<20>(_mm512_castps_si512(g2)));
            let row = [Self(u), Self(g0), Self(g1), Self(g2), Self(g3)];
            (Self(_mm512_sub_ps(self.0, _mm512_castsi512_ps(begin))), row)
        }
    }
}
