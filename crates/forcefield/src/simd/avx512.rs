//! Lanes of AVX-512: eight doubles or sixteen singles.

mod fixed;

use std::arch::x86_64::*;

use glam::DVec3;

use super::arithmetic::arithmetic;
use super::by_level::run_loops;
use super::cluster_loop::{self, ClusterJob};
use super::lanes::{BySpecies, Entry, Lanes, RowLanes};
use super::level::Avx512;
use super::output::Output;
use super::registers::register;
use super::row::{DoubleRow, FixedRow, species_of_fixed};
use super::row_loop::{self, RowJob};
use super::totals::{ChunkTotals, Detail};
use crate::interaction::Interaction;
use crate::number::RowsOf;
use crate::options::Precision;

/// Eight doubles. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct F64x8(pub(super) __m512d);

/// Sixteen singles. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct F32x16(pub(super) __m512);

/// Fixed-point coordinates of sixteen rows along x, y and z, and their species. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct Fixed16([__m512i; 4]);

register!(
    F64x8,
    f64,
    _mm512_set1_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_fmadd_pd,
    _mm512_sqrt_pd,
    _mm512_min_pd,
    _mm512_max_pd
);
register!(
    F32x16,
    f32,
    _mm512_set1_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_fmadd_ps,
    _mm512_sqrt_ps,
    _mm512_min_ps,
    _mm512_max_ps
);

impl Lanes for F64x8 {
    const WIDTH: usize = 8;
    type Isa = Avx512;
    type Row = DoubleRow;
    type Rows = [Self; 3];
    type Mask = __mmask8;
    type Number = f64;
    type Species = __m512i;
    type Table = Self;
    type Count = u32;

    #[inline(always)]
    fn constant(_isa: Avx512, value: f64) -> Self {
        // SAFETY: the token proves AVX-512.
        Self(unsafe { _mm512_set1_pd(value) })
    }

    #[inline(always)]
    fn spread(isa: Avx512, row: &DoubleRow) -> Self::Rows {
        let [x, y, z, _] = row.0;
        let constant = |value| Self::constant(isa, value);
        [constant(x), constant(y), constant(z)]
    }

    #[inline(always)]
    fn species_of(row: &DoubleRow) -> usize {
        row.species_by_lowest_bits()
    }
    #[inline(always)]
    fn table(_isa: Avx512, numbers: &BySpecies<f64>) -> Self {
        // SAFETY: there are eight numbers, aligned; the token proves AVX-512.
        Self(unsafe { _mm512_load_pd(numbers.0.as_ptr()) })
    }
    #[inline(always)]
    fn pick(table: Self, species: __m512i) -> Self {
        // SAFETY: a value of this type proves AVX-512.
        Self(unsafe { _mm512_permutexvar_pd(species, table.0) })
    }

    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        self.row_of(rows, first)
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX-512.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn none(_isa: Self::Isa) -> u32 {
        0
    }
    #[inline(always)]
    fn count(count: u32, mask: Self::Mask) -> u32 {
        count + mask.count_ones()
    }
    #[inline(always)]
    fn counted(count: u32) -> u32 {
        count
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_maskz_mov_pd(mask, self.0) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: as above.
        unsafe { _mm512_reduce_add_pd(self.0) }
    }
}

impl RowLanes for F64x8 {
    #[inline(always)]
    unsafe fn differences<E: Entry>(
        own: Self::Rows,
        rows: *const DoubleRow,
        entries: *const E,
    ) -> ([Self; 3], __m512i) {
        // SAFETY: eight entries are readable, each numbers a readable row; a value or the token proves AVX-512.
        unsafe {
            let row = |k: usize| (*entries.add(k)).row(rows).cast::<f64>();
            let two = |k: usize| {
                let low = _mm512_castpd256_pd512(_mm256_load_pd(row(k)));
                _mm512_insertf64x4::<1>(low, _mm256_load_pd(row(k + 2)))
            };
            // Rows are loaded in pairs and transposed: lanes end in the order of the entries.
            let (a, b, c, d) = (two(0), two(1), two(4), two(5));
            let xz_low = _mm512_unpacklo_pd(a, b);
            let y_low = _mm512_unpackhi_pd(a, b);
            let xz_high = _mm512_unpacklo_pd(c, d);
            let y_high = _mm512_unpackhi_pd(c, d);
            let x = _mm512_shuffle_f64x2::<0b10_00_10_00>(xz_low, xz_high);
            let y = _mm512_shuffle_f64x2::<0b10_00_10_00>(y_low, y_high);
            let z = _mm512_shuffle_f64x2::<0b11_01_11_01>(xz_low, xz_high);
            let species = _mm512_shuffle_f64x2::<0b11_01_11_01>(y_low, y_high);
            let apart = [own[0] - Self(x), own[1] - Self(y), own[2] - Self(z)];
            (apart, _mm512_castpd_si512(species))
        }
    }

    #[inline(always)]
    fn first(mask: Self::Mask, count: usize) -> Self::Mask {
        mask & ((1_u32 << count) - 1) as u8
    }

    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self, unit: f64) -> DVec3 {
        // SAFETY: as above.
        unsafe {
            let none = _mm512_setzero_pd();
            let xy = _mm512_add_pd(_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
            let z = _mm512_add_pd(_mm512_unpacklo_pd(z.0, none), _mm512_unpackhi_pd(z.0, none));
            // xy holds x y x y x y x y, and z holds z 0 z 0 z 0 z 0. The quarters become x y z 0.
            let low = _mm512_shuffle_f64x2::<0b01_00_01_00>(xy, z);
            let high = _mm512_shuffle_f64x2::<0b11_10_11_10>(xy, z);
            let halves = _mm512_add_pd(low, high);
            let xy = _mm512_castpd512_pd256(halves);
            let z = _mm512_extractf64x4_pd::<1>(halves);
            let xy = _mm_add_pd(_mm256_castpd256_pd128(xy), _mm256_extractf128_pd::<1>(xy));
            let z = _mm_add_pd(_mm256_castpd256_pd128(z), _mm256_extractf128_pd::<1>(z));
            let unit = _mm_set1_pd(unit);
            let (xy, z) = (_mm_mul_pd(xy, unit), _mm_mul_pd(z, unit));
            let y = _mm_unpackhi_pd(xy, xy);
            DVec3::new(_mm_cvtsd_f64(xy), _mm_cvtsd_f64(y), _mm_cvtsd_f64(z))
        }
    }
}

impl Lanes for F32x16 {
    const WIDTH: usize = 16;
    type Isa = Avx512;
    type Row = FixedRow;
    type Rows = Fixed16;
    type Mask = __mmask16;
    type Number = f32;
    type Species = __m512i;
    type Table = Self;
    type Count = __m512i;

    #[inline(always)]
    fn constant(_isa: Avx512, value: f64) -> Self {
        // SAFETY: the token proves AVX-512.
        Self(unsafe { _mm512_set1_ps(value as f32) })
    }

    #[inline(always)]
    fn spread(_isa: Avx512, row: &FixedRow) -> Fixed16 {
        // SAFETY: the token proves AVX-512.
        unsafe {
            Fixed16([
                _mm512_set1_epi32(row[0]),
                _mm512_set1_epi32(row[1]),
                _mm512_set1_epi32(row[2]),
                _mm512_set1_epi32(row[3]),
            ])
        }
    }

    #[inline(always)]
    fn species_of(row: &FixedRow) -> usize {
        species_of_fixed(row)
    }
    #[inline(always)]
    fn table(_isa: Avx512, numbers: &BySpecies<f32>) -> Self {
        // SAFETY: there are eight numbers, aligned; the token proves AVX-512.
        Self(unsafe { _mm512_broadcast_f32x8(_mm256_load_ps(numbers.0.as_ptr())) })
    }
    #[inline(always)]
    fn pick(table: Self, species: __m512i) -> Self {
        // SAFETY: a value of this type proves AVX-512.
        Self(unsafe { _mm512_permutexvar_ps(species, table.0) })
    }

    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f32>, first: Self) -> (Self, [Self; 5]) {
        self.row_of(rows, first)
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX-512.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn none(_isa: Avx512) -> __m512i {
        // SAFETY: the token proves AVX-512.
        unsafe { _mm512_setzero_si512() }
    }
    #[inline(always)]
    fn count(count: __m512i, mask: Self::Mask) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_mask_add_epi32(count, mask, count, _mm512_set1_epi32(1)) }
    }
    #[inline(always)]
    fn counted(count: __m512i) -> u32 {
        // SAFETY: as above.
        unsafe { _mm512_reduce_add_epi32(count) as u32 }
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_maskz_mov_ps(mask, self.0) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: as above.
        unsafe {
            let low = _mm512_cvtps_pd(_mm512_castps512_ps256(self.0));
            let high = _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(self.0));
            _mm512_reduce_add_pd(_mm512_add_pd(low, high))
        }
    }
}

run_loops!(Avx512, "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt", F64x8, F32x16);
