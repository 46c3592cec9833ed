//! Eight doubles.

use std::arch::x86_64::{
    __m512d as Table, __m512d as Vector, __m512i as Species, __mmask8 as Mask,
    _cvtmask8_u32 as bits, _cvtu32_mask8 as among, _kand_mask8 as both,
    _mm512_add_epi64 as add_bits, _mm512_add_pd as add, _mm512_and_si512 as and_bits,
    _mm512_castpd_si512 as species, _mm512_castpd_si512 as to_bits,
    _mm512_castsi512_pd as from_bits, _mm512_cmp_pd_mask as cmp, _mm512_div_pd as div,
    _mm512_fmadd_pd as fmadd, _mm512_maskz_mov_pd as keep, _mm512_max_pd as max,
    _mm512_min_pd as min, _mm512_mul_pd as mul, _mm512_reduce_add_pd as sum,
    _mm512_set1_epi64 as each_bits, _mm512_set1_pd as coordinate, _mm512_set1_pd as splat,
    _mm512_slli_epi64 as shift_left, _mm512_sqrt_pd as sqrt, _mm512_srlv_epi64 as shift_right,
    _mm512_storeu_si512 as store_bits, _mm512_sub_epi64 as sub_bits, _mm512_sub_pd as sub, *,
};

use glam::DVec3;

use crate::number::{Number, RowsOf};
use crate::simd::lanes::{BySpecies, Lanes};
use crate::simd::level::Avx512;
use crate::simd::registers::registers;
use crate::simd::row::DoubleRow;

registers! {
    /// Eight doubles. A value proves that this processor has AVX-512.
    F64x8: f64, u64, 8, Avx512, DoubleRow, DoubleRow
}

/// The numbers of eight rows by column. Rows are loaded in pairs, so that lanes end in the order of the rows.
#[inline(always)]
unsafe fn transposed(row: impl Fn(usize) -> *const f64) -> [Vector; 4] {
    // SAFETY: the rows are readable and aligned; the caller proves AVX-512, here and below.
    unsafe {
        let two = |k: usize| {
            let low = _mm512_castpd256_pd512(_mm256_load_pd(row(k)));
            _mm512_insertf64x4::<1>(low, _mm256_load_pd(row(k + 2)))
        };
        let (a, b, c, d) = (two(0), two(1), two(4), two(5));
        let even_low = _mm512_unpacklo_pd(a, b);
        let odd_low = _mm512_unpackhi_pd(a, b);
        let even_high = _mm512_unpacklo_pd(c, d);
        let odd_high = _mm512_unpackhi_pd(c, d);
        [
            _mm512_shuffle_f64x2::<0b10_00_10_00>(even_low, even_high),
            _mm512_shuffle_f64x2::<0b10_00_10_00>(odd_low, odd_high),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(even_low, even_high),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(odd_low, odd_high),
        ]
    }
}

fn species_of(row: &DoubleRow) -> usize {
    row.species_by_lowest_bits()
}

#[inline(always)]
unsafe fn table(numbers: &BySpecies<f64>) -> Table {
    // SAFETY: as above; there are eight numbers, aligned.
    unsafe { _mm512_load_pd(numbers.0.as_ptr()) }
}

#[inline(always)]
unsafe fn pick(table: Table, species: Species) -> Vector {
    // SAFETY: as above.
    unsafe { _mm512_permutexvar_pd(species, table) }
}

#[inline(always)]
unsafe fn sum3([x, y, z]: [Vector; 3], unit: f64) -> DVec3 {
    // SAFETY: as above.
    unsafe {
        let none = _mm512_setzero_pd();
        let xy = _mm512_add_pd(_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
        let z = _mm512_add_pd(_mm512_unpacklo_pd(z, none), _mm512_unpackhi_pd(z, none));
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
