//! Lanes of AVX2 with FMA: four doubles or eight singles.

mod fixed;

use std::arch::x86_64::*;

use glam::DVec3;

use super::arithmetic::arithmetic;
use super::by_level::run_loops;
use super::cluster_loop::{self, ClusterJob};
use super::lanes::{BySpecies, Entry, Lanes, RowLanes};
use super::level::Avx2;
use super::output::Output;
use super::registers::register;
use super::row::{DoubleRow, FixedRow, species_of_fixed};
use super::row_loop::{self, RowJob};
use super::totals::{ChunkTotals, Detail};
use crate::interaction::Interaction;
use crate::number::RowsOf;
use crate::options::Precision;

/// Four doubles. A value proves that this processor has AVX2 and FMA.
#[derive(Clone, Copy)]
pub struct F64x4(pub(super) __m256d);

/// Eight singles. A value proves that this processor has AVX2 and FMA.
#[derive(Clone, Copy)]
pub struct F32x8(pub(super) __m256);

/// Fixed-point coordinates of eight rows along x, y and z, and their species. A value proves that this processor has AVX2.
#[derive(Clone, Copy)]
pub struct Fixed8([__m256i; 4]);

/// A double for each of eight species.
#[derive(Clone, Copy)]
pub struct Doubles {
    /// Species 0 to 3.
    low: F64x4,
    /// Species 4 to 7.
    high: F64x4,
}

register!(
    F64x4,
    f64,
    _mm256_set1_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_sqrt_pd,
    _mm256_min_pd,
    _mm256_max_pd
);
register!(
    F32x8,
    f32,
    _mm256_set1_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_sqrt_ps,
    _mm256_min_ps,
    _mm256_max_ps
);

impl Lanes for F64x4 {
    const WIDTH: usize = 4;
    type Isa = Avx2;
    type Row = DoubleRow;
    type Rows = [Self; 3];
    type Mask = __m256d;
    type Number = f64;
    type Species = __m256d;
    type Table = Doubles;
    type Count = u32;

    #[inline(always)]
    fn constant(_isa: Avx2, value: f64) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn spread(isa: Avx2, row: &DoubleRow) -> Self::Rows {
        let [x, y, z, _] = row.0;
        let constant = |value| Self::constant(isa, value);
        [constant(x), constant(y), constant(z)]
    }

    #[inline(always)]
    fn species_of(row: &DoubleRow) -> usize {
        row.species_by_halves()
    }
    #[inline(always)]
    fn table(_isa: Avx2, numbers: &BySpecies<f64>) -> Doubles {
        // SAFETY: there are eight numbers, aligned; the token proves AVX2.
        unsafe {
            let four = |k: usize| F64x4(_mm256_load_pd(numbers.0.as_ptr().add(k)));
            Doubles { low: four(0), high: four(4) }
        }
    }
    #[inline(always)]
    fn pick(table: Doubles, species: __m256d) -> Self {
        // SAFETY: a value of this type proves AVX2.
        unsafe {
            // The halves of a double are picked as singles, and the sign of the species says from which register.
            let halves = _mm256_castpd_si256(species);
            let from = |table: F64x4| {
                let picked = _mm256_permutevar8x32_ps(_mm256_castpd_ps(table.0), halves);
                _mm256_castps_pd(picked)
            };
            Self(_mm256_blendv_pd(from(table.low), from(table.high), species))
        }
    }

    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        self.row_of(rows, first)
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX2.
        unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn none(_isa: Self::Isa) -> u32 {
        0
    }
    #[inline(always)]
    fn count(count: u32, mask: Self::Mask) -> u32 {
        // SAFETY: as above.
        count + unsafe { _mm256_movemask_pd(mask).count_ones() }
    }
    #[inline(always)]
    fn counted(count: u32) -> u32 {
        count
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_and_pd(self.0, mask) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: as above.
        unsafe {
            let pair =
                _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(pair, _mm_unpackhi_pd(pair, pair)))
        }
    }
}

impl RowLanes for F64x4 {
    #[inline(always)]
    unsafe fn differences<E: Entry>(
        own: Self::Rows,
        rows: *const DoubleRow,
        entries: *const E,
    ) -> ([Self; 3], __m256d) {
        // SAFETY: four entries are readable, each numbers a readable row; a value or the token proves AVX2.
        unsafe {
            let row = |k: usize| _mm256_load_pd((*entries.add(k)).row(rows).cast());
            let (a, b, c, d) = (row(0), row(1), row(2), row(3));
            let xz_low = _mm256_unpacklo_pd(a, b);
            let y_low = _mm256_unpackhi_pd(a, b);
            let xz_high = _mm256_unpacklo_pd(c, d);
            let y_high = _mm256_unpackhi_pd(c, d);
            let x = _mm256_permute2f128_pd::<0x20>(xz_low, xz_high);
            let y = _mm256_permute2f128_pd::<0x20>(y_low, y_high);
            let z = _mm256_permute2f128_pd::<0x31>(xz_low, xz_high);
            let species = _mm256_permute2f128_pd::<0x31>(y_low, y_high);
            let apart = [own[0] - Self(x), own[1] - Self(y), own[2] - Self(z)];
            (apart, species)
        }
    }

    #[inline(always)]
    fn first(mask: Self::Mask, count: usize) -> Self::Mask {
        // SAFETY: as above.
        unsafe {
            let limit = _mm256_set1_pd(count as f64);
            let valid = _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_setr_pd(0.0, 1.0, 2.0, 3.0), limit);
            _mm256_and_pd(mask, valid)
        }
    }

    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self, unit: f64) -> DVec3 {
        // SAFETY: as above.
        unsafe {
            // The order of each sum is the order of `sum`: the halves first, then the rest.
            let low = _mm256_permute2f128_pd::<0x20>(x.0, y.0);
            let high = _mm256_permute2f128_pd::<0x31>(x.0, y.0);
            let xy = _mm256_add_pd(low, high);
            let xy = _mm256_add_pd(xy, _mm256_permute_pd::<0b0101>(xy));
            let xy = _mm256_mul_pd(xy, _mm256_set1_pd(unit));
            let y = _mm_cvtsd_f64(_mm256_extractf128_pd::<1>(xy));
            DVec3::new(_mm256_cvtsd_f64(xy), y, unit * z.sum())
        }
    }
}

impl F32x8 {
    /// The sums of lanes k and k + 4, in double precision.
    #[inline(always)]
    fn halves(self) -> F64x4 {
        // SAFETY: a value of this type proves AVX2.
        unsafe {
            let low = _mm256_cvtps_pd(_mm256_castps256_ps128(self.0));
            let high = _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0));
            F64x4(_mm256_add_pd(low, high))
        }
    }
}

impl Lanes for F32x8 {
    const WIDTH: usize = 8;
    type Isa = Avx2;
    type Row = FixedRow;
    type Rows = Fixed8;
    type Mask = __m256;
    type Number = f32;
    type Species = __m256i;
    type Table = Self;
    /// Counts by lanes: single counts of four members would be gathered into a register.
    type Count = __m256i;

    #[inline(always)]
    fn constant(_isa: Avx2, value: f64) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_ps(value as f32) })
    }

    #[inline(always)]
    fn spread(_isa: Avx2, row: &FixedRow) -> Fixed8 {
        // SAFETY: the token proves AVX2.
        unsafe {
            Fixed8([
                _mm256_set1_epi32(row[0]),
                _mm256_set1_epi32(row[1]),
                _mm256_set1_epi32(row[2]),
                _mm256_set1_epi32(row[3]),
            ])
        }
    }

    #[inline(always)]
    fn species_of(row: &FixedRow) -> usize {
        species_of_fixed(row)
    }
    #[inline(always)]
    fn table(_isa: Avx2, numbers: &BySpecies<f32>) -> Self {
        // SAFETY: there are eight numbers, aligned; the token proves AVX2.
        Self(unsafe { _mm256_load_ps(numbers.0.as_ptr()) })
    }
    #[inline(always)]
    fn pick(table: Self, species: __m256i) -> Self {
        // SAFETY: a value of this type proves AVX2.
        Self(unsafe { _mm256_permutevar8x32_ps(table.0, species) })
    }

    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f32>, first: Self) -> (Self, [Self; 5]) {
        self.row_of(rows, first)
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX2.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn none(_isa: Avx2) -> __m256i {
        // SAFETY: the token proves AVX2.
        unsafe { _mm256_setzero_si256() }
    }
    #[inline(always)]
    fn count(count: __m256i, mask: Self::Mask) -> __m256i {
        // A lane of the mask is −1. SAFETY: as above.
        unsafe { _mm256_sub_epi32(count, _mm256_castps_si256(mask)) }
    }
    #[inline(always)]
    fn counted(count: __m256i) -> u32 {
        let mut lanes = [0_u32; 8];
        // SAFETY: as above; eight numbers are written.
        unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), count) };
        lanes.into_iter().sum()
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_and_ps(self.0, mask) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.halves().sum()
    }
}

run_loops!(Avx2, "avx2,fma,bmi1,bmi2,popcnt", F64x4, F32x8);
