//! Four doubles.

use std::arch::x86_64::{
    __m256d as Mask, __m256d as Species, __m256d as Vector, _mm256_add_epi64 as add_bits,
    _mm256_add_pd as add, _mm256_and_pd as both, _mm256_and_pd as keep,
    _mm256_and_si256 as and_bits, _mm256_castpd_si256 as to_bits, _mm256_castsi256_pd as from_bits,
    _mm256_cmp_pd as cmp, _mm256_div_pd as div, _mm256_fmadd_pd as fmadd, _mm256_max_pd as max,
    _mm256_min_pd as min, _mm256_mul_pd as mul, _mm256_set1_epi64x as each_bits,
    _mm256_set1_pd as coordinate, _mm256_set1_pd as splat, _mm256_slli_epi64 as shift_left,
    _mm256_sqrt_pd as sqrt, _mm256_srlv_epi64 as shift_right, _mm256_storeu_si256 as store_bits,
    _mm256_sub_epi64 as sub_bits, _mm256_sub_pd as sub, *,
};

use glam::DVec3;

use crate::number::{Number, RowsOf};
use crate::simd::lanes::{BySpecies, Lanes};
use crate::simd::level::Avx2;
use crate::simd::registers::registers;
use crate::simd::row::DoubleRow;

registers! {
    /// Four doubles. A value proves that this processor has AVX2 and FMA.
    F64x4: f64, u64, 4, Avx2, DoubleRow, DoubleRow
}

/// A double for each of eight species: species 0 to 3, and species 4 to 7.
type Table = [Vector; 2];

/// The numbers of four rows by column.
#[inline(always)]
unsafe fn transposed(row: impl Fn(usize) -> *const f64) -> [Vector; 4] {
    // SAFETY: the rows are readable and aligned; the caller proves AVX2, here and below.
    unsafe {
        let row = |k: usize| _mm256_load_pd(row(k));
        let (a, b, c, d) = (row(0), row(1), row(2), row(3));
        let even_low = _mm256_unpacklo_pd(a, b);
        let odd_low = _mm256_unpackhi_pd(a, b);
        let even_high = _mm256_unpacklo_pd(c, d);
        let odd_high = _mm256_unpackhi_pd(c, d);
        [
            _mm256_permute2f128_pd::<0x20>(even_low, even_high),
            _mm256_permute2f128_pd::<0x20>(odd_low, odd_high),
            _mm256_permute2f128_pd::<0x31>(even_low, even_high),
            _mm256_permute2f128_pd::<0x31>(odd_low, odd_high),
        ]
    }
}

fn species_of(row: &DoubleRow) -> usize {
    row.species_by_halves()
}

unsafe fn species(padding: Vector) -> Species {
    padding
}

#[inline(always)]
unsafe fn table(numbers: &BySpecies<f64>) -> Table {
    // SAFETY: as above; there are eight numbers, aligned.
    unsafe { [_mm256_load_pd(numbers.0.as_ptr()), _mm256_load_pd(numbers.0.as_ptr().add(4))] }
}

/// The halves of a double are picked as singles, and the sign of the species says from which register.
#[inline(always)]
unsafe fn pick([low, high]: Table, species: Species) -> Vector {
    // SAFETY: as above.
    unsafe {
        let halves = _mm256_castpd_si256(species);
        let from = |table: Vector| {
            _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(table), halves))
        };
        _mm256_blendv_pd(from(low), from(high), species)
    }
}

/// The lanes set in the lowest bits.
#[inline(always)]
unsafe fn among(bits: u32) -> Mask {
    // SAFETY: as above.
    unsafe {
        let lane = _mm256_setr_epi64x(1, 2, 4, 8);
        let set = _mm256_and_si256(_mm256_set1_epi64x(bits.into()), lane);
        _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, lane))
    }
}

#[inline(always)]
unsafe fn bits(mask: Mask) -> u32 {
    // SAFETY: as above.
    unsafe { _mm256_movemask_pd(mask) as u32 }
}

#[inline(always)]
pub(super) unsafe fn sum(v: Vector) -> f64 {
    // SAFETY: as above.
    unsafe {
        let pair = _mm_add_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd::<1>(v));
        _mm_cvtsd_f64(_mm_add_sd(pair, _mm_unpackhi_pd(pair, pair)))
    }
}

/// The order of each sum is the order of `sum`: the halves first, then the rest.
#[inline(always)]
pub(super) unsafe fn sum3([x, y, z]: [Vector; 3], unit: f64) -> DVec3 {
    // SAFETY: as above.
    unsafe {
        let low = _mm256_permute2f128_pd::<0x20>(x, y);
        let high = _mm256_permute2f128_pd::<0x31>(x, y);
        let xy = _mm256_add_pd(low, high);
        let xy = _mm256_add_pd(xy, _mm256_permute_pd::<0b0101>(xy));
        let xy = _mm256_mul_pd(xy, _mm256_set1_pd(unit));
        let y = _mm_cvtsd_f64(_mm256_extractf128_pd::<1>(xy));
        DVec3::new(_mm256_cvtsd_f64(xy), y, unit * sum(z))
    }
}
