//! Lanes of AVX-512: eight doubles or sixteen singles.

use std::arch::x86_64::*;

use glam::DVec3;

use super::arithmetic::arithmetic;
use super::cluster_loop::{self, ClusterJob};
use super::lanes::{BlockEntry, Entry, FixedLanes, Lanes, RowLanes};
use super::level::Avx512;
use super::output::Output;
use super::registers::register;
use super::row::{DoubleRow, FixedRow};
use super::row_loop::{self, RowJob};
use super::totals::{ChunkTotals, Detail};
use crate::options::Precision;
use crate::pair::PairForm;

/// Eight doubles. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct F64x8(pub(super) __m512d);

/// Sixteen singles. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct F32x16(pub(super) __m512);

/// Fixed-point coordinates of sixteen rows along x, y and z. A value proves that this processor has AVX-512.
#[derive(Clone, Copy)]
pub struct Fixed16([__m512i; 3]);

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
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX-512.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn count(mask: Self::Mask) -> u32 {
        mask.count_ones()
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
    ) -> [Self; 3] {
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
            [own[0] - Self(x), own[1] - Self(y), own[2] - Self(z)]
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
                _mm512_set1_epi32(row.0[0]),
                _mm512_set1_epi32(row.0[1]),
                _mm512_set1_epi32(row.0[2]),
            ])
        }
    }

    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        // SAFETY: a value of this type proves AVX-512.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, limit.0) }
    }
    #[inline(always)]
    fn count(mask: Self::Mask) -> u32 {
        mask.count_ones()
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

/// The members of a cluster relative to its center, and the center.
#[repr(C, align(64))]
struct Relative([f32; 16], [i32; 4]);

impl FixedLanes for F32x16 {
    const SPECIAL_LOOPS: bool = true;

    #[inline(always)]
    unsafe fn gather(_isa: Avx512, rows: *const FixedRow, entries: *const BlockEntry) -> Fixed16 {
        // SAFETY: sixteen entries are readable, each numbers a readable row; a value or the token proves AVX-512.
        unsafe {
            let row = |k: usize| _mm_load_si128((*entries.add(k)).row(rows).cast());
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
            ])
        }
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
            let row = |k: usize| _mm_load_si128(rows[k].0.as_ptr().cast());
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

/// The loop over row lists.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn run_double<F: PairForm>(
    isa: Avx512,
    job: &RowJob<'_, F>,
    rows: &[DoubleRow],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> ChunkTotals {
    // SAFETY: the caller runs each chunk once.
    unsafe { row_loop::run::<F64x8, F>(isa, job, rows, chunk, detail, output) }
}

/// The loop over cluster lists.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn run_cluster<F: PairForm>(
    isa: Avx512,
    job: &ClusterJob<'_, F>,
    rows: &[FixedRow],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> ChunkTotals {
    // SAFETY: as above.
    unsafe { cluster_loop::run::<F32x16, F>(isa, job, rows, chunk, detail, output) }
}

/// The arithmetic of a number of rounds without memory, in a precision.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
pub fn limit<F: PairForm>(
    isa: Avx512,
    form: &F,
    r_cut: f64,
    rounds: u64,
    precision: Precision,
) -> (u64, f64) {
    match precision {
        Precision::Double => arithmetic::<F64x8, F>(isa, form, r_cut, rounds),
        Precision::Mixed => arithmetic::<F32x16, F>(isa, form, r_cut, rounds),
    }
}
