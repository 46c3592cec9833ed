//! Rows of tables in lanes of AVX-512.

use std::arch::x86_64::*;

use super::avx512::{F32x16, F64x8};
use crate::pair::tabulated::TableRows;

impl F64x8 {
    /// [`Real::look_up`](crate::real::Real::look_up).
    ///
    /// Whole rows are loaded and transposed, as rows of coordinates are: four gathers would load each row four times.
    #[inline(always)]
    pub(super) fn row_of(self, rows: &TableRows) -> (Self, [Self; 4]) {
        const SHIFT: u32 = TableRows::SHIFTS.0;
        // Rows are numbered in units of 8 bytes, which an address takes without a shift.
        const UNITS: usize = 4;
        let (rows, numbering) = rows.wide();
        // SAFETY: a value of this type proves AVX-512. A clamped number has a row, and a number that is not one becomes the lowest.
        unsafe {
            let held = _mm512_max_pd(self.0, _mm512_set1_pd(numbering.lowest));
            let held = _mm512_min_pd(held, _mm512_set1_pd(numbering.highest));
            let number = _mm512_srli_epi64::<SHIFT>(_mm512_castpd_si512(held));
            let begin = _mm512_castsi512_pd(_mm512_slli_epi64::<SHIFT>(number));
            let first = _mm512_set1_epi64(numbering.first as i64);
            let mut at = [0_u64; 8];
            let units = _mm512_slli_epi64::<{ UNITS.ilog2() }>(_mm512_sub_epi64(number, first));
            _mm512_storeu_si512(at.as_mut_ptr().cast(), units);
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
            let columns = [
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(even_low, even_high)),
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(odd_low, odd_high)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(even_low, even_high)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(odd_low, odd_high)),
            ];
            (Self(_mm512_sub_pd(self.0, begin)), columns)
        }
    }
}

impl F32x16 {
    /// [`Real::look_up`](crate::real::Real::look_up).
    #[inline(always)]
    pub(super) fn row_of(self, rows: &TableRows) -> (Self, [Self; 4]) {
        const SHIFT: u32 = TableRows::SHIFTS.1;
        const UNITS: usize = 2;
        let (rows, numbering) = rows.narrow();
        // SAFETY: as above.
        unsafe {
            let held = _mm512_max_ps(self.0, _mm512_set1_ps(numbering.lowest as f32));
            let held = _mm512_min_ps(held, _mm512_set1_ps(numbering.highest as f32));
            let number = _mm512_srli_epi32::<SHIFT>(_mm512_castps_si512(held));
            let begin = _mm512_castsi512_ps(_mm512_slli_epi32::<SHIFT>(number));
            let first = _mm512_set1_epi32(numbering.first as i32);
            let mut at = [0_u32; 16];
            let units = _mm512_slli_epi32::<{ UNITS.ilog2() }>(_mm512_sub_epi32(number, first));
            _mm512_storeu_si512(at.as_mut_ptr().cast(), units);
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
            let column = |v: __m512d| Self(_mm512_castpd_ps(v));
            let columns = [
                column(_mm512_unpacklo_pd(first_ab, first_cd)),
                column(_mm512_unpackhi_pd(first_ab, first_cd)),
                column(_mm512_unpacklo_pd(last_ab, last_cd)),
                column(_mm512_unpackhi_pd(last_ab, last_cd)),
            ];
            (Self(_mm512_sub_ps(self.0, begin)), columns)
        }
    }
}
