//! Eight singles.

use std::arch::x86_64::{
    __m256 as Mask, __m256 as Table, __m256 as Vector, __m256i as Species,
    _mm256_add_epi32 as add_bits, _mm256_add_ps as add, _mm256_and_ps as both,
    _mm256_and_ps as keep, _mm256_and_si256 as and_bits, _mm256_castps_si256 as species,
    _mm256_castps_si256 as to_bits, _mm256_castsi256_ps as from_bits, _mm256_cmp_ps as cmp,
    _mm256_div_ps as div, _mm256_fmadd_ps as fmadd, _mm256_max_ps as max, _mm256_min_ps as min,
    _mm256_mul_ps as mul, _mm256_permutevar8x32_ps as pick, _mm256_set1_epi32 as each_bits,
    _mm256_set1_ps as splat, _mm256_slli_epi32 as shift_left, _mm256_sqrt_ps as sqrt,
    _mm256_srlv_epi32 as shift_right, _mm256_storeu_si256 as store_bits,
    _mm256_sub_epi32 as sub_bits, _mm256_sub_ps as sub, *,
};

use glam::DVec3;
use lennard_neighbor::CLUSTER;

use super::doubles;
use crate::number::{Number, RowsOf};
use crate::simd::lanes::{BySpecies, FixedLanes, Lanes};
use crate::simd::level::Avx2;
use crate::simd::registers::registers;
use crate::simd::row::{FixedRow, species_of_fixed as species_of};

registers! {
    /// Eight singles. A value proves that this processor has AVX2 and FMA.
    F32x8: f32, u32, 8, Avx2, FixedRow, u64
}

impl FixedLanes for F32x8 {
    const FEW_REGISTERS: bool = true;

    #[inline(always)]
    unsafe fn load(_isa: Avx2, from: *const f32) -> Self {
        // SAFETY: a value of this type or a token proves AVX2, here and below; the contract is passed on.
        Self(unsafe { _mm256_loadu_ps(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: as above.
        unsafe { _mm256_storeu_ps(to, self.0) }
    }
    #[inline(always)]
    unsafe fn pack(self, bits: u32, to: *mut f32) {
        // SAFETY: as above.
        unsafe { _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(self.0, packed(bits))) }
    }
    #[inline(always)]
    unsafe fn pack_narrow(self, bits: u32, to: *mut u16) {
        // SAFETY: as above.
        unsafe {
            let numbers = _mm256_permutevar8x32_epi32(to_bits(self.0), packed(bits));
            let low = _mm256_castsi256_si128(numbers);
            let high = _mm256_extracti128_si256::<1>(numbers);
            _mm_storeu_si128(to.cast(), _mm_packus_epi32(low, high));
        }
    }
    #[inline(always)]
    fn whole(_isa: Avx2, number: u32) -> Self {
        // SAFETY: as above.
        Self(unsafe { coordinate(number as i32) })
    }
    #[inline(always)]
    fn numbers_from(_isa: Avx2, first: u32) -> Self {
        // SAFETY: as above.
        unsafe {
            let ramp = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            Self(from_bits(_mm256_add_epi32(_mm256_set1_epi32(first as i32), ramp)))
        }
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_cvtepi32_ps(_mm256_sub_epi32(to_bits(self.0), to_bits(other.0))) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn round(self) -> Self {
        const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
        // SAFETY: as above.
        Self(unsafe { _mm256_round_ps::<NEAREST>(self.0) })
    }
    #[inline(always)]
    fn near_others(self, limit: Self, number: Self, own: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let own = from_bits(_mm256_cmpeq_epi32(to_bits(number.0), to_bits(own.0)));
            bits(_mm256_andnot_ps(own, self.at_most(limit)))
        }
    }
    #[inline(always)]
    fn others(self, first: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let apart = _mm256_sub_epi32(to_bits(self.0), to_bits(first.0));
            let last = _mm256_min_epu32(apart, _mm256_set1_epi32(CLUSTER as i32 - 1));
            !bits(from_bits(_mm256_cmpeq_epi32(last, apart)))
        }
    }

    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; 4], unit: f64) -> [DVec3; 4] {
        let of = |[x, y, z]: [Self; 3]| Self::sum3(x, y, z, unit);
        [of(a), of(b), of(c), of(d)]
    }
}

/// For each mask of eight lanes, the numbers of the lanes that are set, packed together.
static PACKED: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// The numbers of the lanes that are set in the lowest eight bits, packed together.
#[inline(always)]
unsafe fn packed(bits: u32) -> __m256i {
    // SAFETY: a row of the table is one register.
    unsafe { _mm256_loadu_si256(PACKED[bits as usize % 256].as_ptr().cast()) }
}

#[inline(always)]
unsafe fn coordinate(fixed: i32) -> Vector {
    // SAFETY: the caller proves AVX2, here and below.
    unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(fixed)) }
}

/// The numbers of eight rows by column.
#[inline(always)]
unsafe fn transposed(row: impl Fn(usize) -> *const f32) -> [Vector; 4] {
    // SAFETY: as above; the rows are readable.
    unsafe {
        let two = |k: usize| {
            let low = _mm256_castps128_ps256(_mm_loadu_ps(row(k)));
            _mm256_insertf128_ps::<1>(low, _mm_loadu_ps(row(k + 4)))
        };
        let (a, b, c, d) = (two(0), two(1), two(2), two(3));
        let low = |p, q| _mm256_castps_pd(_mm256_unpacklo_ps(p, q));
        let high = |p, q| _mm256_castps_pd(_mm256_unpackhi_ps(p, q));
        let (first_ab, last_ab) = (low(a, b), high(a, b));
        let (first_cd, last_cd) = (low(c, d), high(c, d));
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(first_ab, first_cd)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(first_ab, first_cd)),
            _mm256_castpd_ps(_mm256_unpacklo_pd(last_ab, last_cd)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(last_ab, last_cd)),
        ]
    }
}

#[inline(always)]
unsafe fn table(numbers: &BySpecies<f32>) -> Table {
    // SAFETY: as above; there are eight numbers, aligned.
    unsafe { _mm256_load_ps(numbers.0.as_ptr()) }
}

/// The lanes set in the lowest bits.
#[inline(always)]
unsafe fn among(bits: u32) -> Mask {
    // SAFETY: as above.
    unsafe {
        let lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lane);
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, lane))
    }
}

#[inline(always)]
unsafe fn bits(mask: Mask) -> u32 {
    // SAFETY: as above.
    unsafe { _mm256_movemask_ps(mask) as u32 }
}

/// The sums of lanes k and k + 4, in double precision.
#[inline(always)]
unsafe fn halves(v: Vector) -> __m256d {
    // SAFETY: as above.
    unsafe {
        let low = _mm256_cvtps_pd(_mm256_castps256_ps128(v));
        _mm256_add_pd(low, _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(v)))
    }
}

#[inline(always)]
unsafe fn sum(v: Vector) -> f64 {
    // SAFETY: as above.
    unsafe { doubles::sum(halves(v)) }
}

#[inline(always)]
unsafe fn sum3([x, y, z]: [Vector; 3], unit: f64) -> DVec3 {
    // SAFETY: as above.
    unsafe { doubles::sum3([halves(x), halves(y), halves(z)], unit) }
}
