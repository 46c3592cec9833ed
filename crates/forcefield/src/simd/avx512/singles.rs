//! Sixteen singles.

use std::arch::x86_64::{
    __m512 as Table, __m512 as Vector, __m512i as Species, __mmask16 as Mask,
    _cvtmask16_u32 as bits, _cvtu32_mask16 as among, _kand_mask16 as both,
    _mm512_add_epi32 as add_bits, _mm512_add_ps as add, _mm512_and_si512 as and_bits,
    _mm512_castps_si512 as species, _mm512_castps_si512 as to_bits,
    _mm512_castsi512_ps as from_bits, _mm512_cmp_ps_mask as cmp, _mm512_div_ps as div,
    _mm512_fmadd_ps as fmadd, _mm512_maskz_mov_ps as keep, _mm512_max_ps as max,
    _mm512_min_ps as min, _mm512_mul_ps as mul, _mm512_set1_epi32 as each_bits,
    _mm512_set1_ps as splat, _mm512_slli_epi32 as shift_left, _mm512_sqrt_ps as sqrt,
    _mm512_srlv_epi32 as shift_right, _mm512_storeu_si512 as store_bits,
    _mm512_sub_epi32 as sub_bits, _mm512_sub_ps as sub, *,
};

use glam::DVec3;
use lennard_neighbor::CLUSTER;

use crate::number::{Number, RowsOf};
use crate::simd::lanes::{BySpecies, FixedLanes, Lanes};
use crate::simd::level::Avx512;
use crate::simd::registers::registers;
use crate::simd::row::{FixedRow, species_of_fixed as species_of};

registers! {
    /// Sixteen singles. A value proves that this processor has AVX-512.
    F32x16: f32, u32, 16, Avx512, FixedRow, u64
}

impl FixedLanes for F32x16 {
    #[inline(always)]
    unsafe fn load(_isa: Avx512, from: *const f32) -> Self {
        // SAFETY: a value of this type or a token proves AVX-512, here and below; the contract is passed on.
        Self(unsafe { _mm512_loadu_ps(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: as above.
        unsafe { _mm512_storeu_ps(to, self.0) }
    }
    #[inline(always)]
    unsafe fn pack(self, bits: u32, to: *mut f32) {
        // SAFETY: as above.
        unsafe { _mm512_storeu_ps(to, _mm512_maskz_compress_ps(among(bits), self.0)) }
    }
    #[inline(always)]
    unsafe fn pack_narrow(self, bits: u32, to: *mut u16) {
        // SAFETY: as above.
        unsafe {
            let packed = _mm512_maskz_compress_epi32(among(bits), to_bits(self.0));
            _mm256_storeu_si256(to.cast(), _mm512_cvtepi32_epi16(packed));
        }
    }
    #[inline(always)]
    fn whole(_isa: Avx512, number: u32) -> Self {
        // SAFETY: as above.
        Self(unsafe { coordinate(number as i32) })
    }
    #[inline(always)]
    fn numbers_from(_isa: Avx512, first: u32) -> Self {
        // SAFETY: as above.
        unsafe {
            let ramp = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            Self(from_bits(_mm512_add_epi32(_mm512_set1_epi32(first as i32), ramp)))
        }
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_cvtepi32_ps(_mm512_sub_epi32(to_bits(self.0), to_bits(other.0))) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_roundscale_ps::<_MM_FROUND_TO_NEAREST_INT>(self.0) })
    }
    #[inline(always)]
    fn near_others(self, limit: Self, number: Self, own: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let other = _mm512_cmpneq_epi32_mask(to_bits(number.0), to_bits(own.0));
            bits(_mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(other, self.0, limit.0))
        }
    }
    #[inline(always)]
    fn others(self, first: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let apart = _mm512_sub_epi32(to_bits(self.0), to_bits(first.0));
            bits(_mm512_cmpge_epu32_mask(apart, _mm512_set1_epi32(CLUSTER as i32)))
        }
    }

    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; 4], unit: f64) -> [DVec3; 4] {
        // SAFETY: a value of this type proves AVX-512.
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

#[inline(always)]
unsafe fn coordinate(fixed: i32) -> Vector {
    // SAFETY: the caller proves AVX-512, here and below.
    unsafe { _mm512_castsi512_ps(_mm512_set1_epi32(fixed)) }
}

/// The numbers of sixteen rows by column. Rows are loaded in fours, so that lanes end in the order of the rows.
#[inline(always)]
unsafe fn transposed(row: impl Fn(usize) -> *const f32) -> [Vector; 4] {
    // SAFETY: as above; the rows are readable.
    unsafe {
        let four = |k: usize| {
            let v = _mm512_castps128_ps512(_mm_loadu_ps(row(k)));
            let v = _mm512_insertf32x4::<1>(v, _mm_loadu_ps(row(k + 4)));
            let v = _mm512_insertf32x4::<2>(v, _mm_loadu_ps(row(k + 8)));
            _mm512_insertf32x4::<3>(v, _mm_loadu_ps(row(k + 12)))
        };
        let (a, b, c, d) = (four(0), four(1), four(2), four(3));
        let low = |p, q| _mm512_castps_pd(_mm512_unpacklo_ps(p, q));
        let high = |p, q| _mm512_castps_pd(_mm512_unpackhi_ps(p, q));
        let (first_ab, last_ab) = (low(a, b), high(a, b));
        let (first_cd, last_cd) = (low(c, d), high(c, d));
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(first_ab, first_cd)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(first_ab, first_cd)),
            _mm512_castpd_ps(_mm512_unpacklo_pd(last_ab, last_cd)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(last_ab, last_cd)),
        ]
    }
}

#[inline(always)]
unsafe fn table(numbers: &BySpecies<f32>) -> Table {
    // SAFETY: as above; there are eight numbers, aligned.
    unsafe { _mm512_broadcast_f32x8(_mm256_load_ps(numbers.0.as_ptr())) }
}

#[inline(always)]
unsafe fn pick(table: Table, species: Species) -> Vector {
    // SAFETY: as above.
    unsafe { _mm512_permutexvar_ps(species, table) }
}

#[inline(always)]
unsafe fn sum(v: Vector) -> f64 {
    // SAFETY: as above.
    unsafe {
        let low = _mm512_cvtps_pd(_mm512_castps512_ps256(v));
        _mm512_reduce_add_pd(_mm512_add_pd(low, _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(v))))
    }
}

/// Loops over clusters take [`FixedLanes::sum_four`] in its place.
#[inline(always)]
unsafe fn sum3([x, y, z]: [Vector; 3], unit: f64) -> DVec3 {
    // SAFETY: as above.
    unsafe { unit * DVec3::new(sum(x), sum(y), sum(z)) }
}
