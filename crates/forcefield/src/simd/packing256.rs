//! From particles to rows with AVX2, one register per particle: the same bits as [`super::packing`].

use std::arch::x86_64::*;
use std::ops::Range;

use glam::DVec3;
use lennard_neighbor::{
    ColumnTable, DisplacementScale, FIXED_ROUNDING, FIXED_UNITS, PackedDisplacement, RowTable,
};

use super::disjoint::Disjoint;
use super::motion::Motion;
use super::packing;
use super::row::{DoubleRow, FixedRow};

/// Elements in groups of four; the plain loops take the last one to three elements.
fn fours<T>(of: &[T]) -> std::slice::Iter<'_, [T; 4]> {
    of.as_chunks().0.iter()
}

/// x, y, z and 0.
#[target_feature(enable = "avx2")]
#[inline]
fn load(r: &DVec3) -> __m256d {
    let xyz = _mm256_setr_epi64x(-1, -1, -1, 0);
    let at: &[f64; 3] = r.as_ref();
    // SAFETY: the fourth lane is masked out and not read.
    unsafe { _mm256_maskload_pd(at.as_ptr(), xyz) }
}

/// The displacement r − stretch·x⁰ of one particle.
#[target_feature(enable = "avx2")]
#[inline]
fn displacement(r: __m256d, built: &DVec3, stretch: __m256d) -> __m256d {
    // Multiplication and subtraction stay apart: the plain loops have the same bits.
    _mm256_sub_pd(r, _mm256_mul_pd(stretch, load(built)))
}

/// |d|² of four vectors whose last component is 0, summed in the order of [`DVec3::length_squared`].
#[target_feature(enable = "avx2")]
#[inline]
fn squares([a, b, c, d]: [__m256d; 4]) -> __m256d {
    let (a, b) = (_mm256_mul_pd(a, a), _mm256_mul_pd(b, b));
    let (c, d) = (_mm256_mul_pd(c, c), _mm256_mul_pd(d, d));
    // The lanes hold x + y of a and b, then z of a and b. The second register holds the same of c and d.
    let (ab, cd) = (_mm256_hadd_pd(a, b), _mm256_hadd_pd(c, d));
    _mm256_add_pd(_mm256_permute2f128_pd::<0x20>(ab, cd), _mm256_permute2f128_pd::<0x31>(ab, cd))
}

/// See [`packing::pack_displacements`].
#[target_feature(enable = "avx2")]
pub fn pack_displacements(motion: Motion<'_>, squares: &[f64], to: &mut [PackedDisplacement]) {
    let scale = DisplacementScale::new(motion.far2);
    let stretch = load(&motion.stretch);
    let (along, steps) = (_mm256_set1_pd(scale.along), _mm256_set1_pd(scale.squares));
    let all = fours(motion.indices()).zip(fours(motion.built));
    for (((order, built), squares), packed) in
        all.zip(fours(squares)).zip(to.as_chunks_mut::<4>().0)
    {
        let whole = |k: usize| {
            let r = load(&motion.positions[order[k] as usize]);
            _mm256_cvtpd_epi32(_mm256_mul_pd(displacement(r, &built[k], stretch), along))
        };
        let first_half = _mm_packs_epi32(whole(0), whole(1));
        let second_half = _mm_packs_epi32(whole(2), whole(3));
        let squares =
            _mm256_mul_pd(_mm256_setr_pd(squares[0], squares[1], squares[2], squares[3]), steps);
        // Where the first operand is NaN, the result is the second.
        let squares = _mm256_cvtpd_epi32(_mm256_min_pd(squares, _mm256_set1_pd(254.0)));
        let squares = _mm_slli_epi32::<24>(_mm_add_epi32(squares, _mm_set1_epi32(1)));
        // x, y and z leave a zero byte in the place of the square.
        let all = _mm_or_si128(_mm_packs_epi16(first_half, second_half), squares);
        // SAFETY: there are four packed displacements, of four bytes each in this order.
        unsafe { _mm_storeu_si128(packed.as_mut_ptr().cast(), all) };
    }
    let (done, all) = (to.len() / 4 * 4, to.len());
    packing::pack_displacements(motion.part(done..all), &squares[done..], &mut to[done..]);
}

/// See [`packing::pack_double`].
///
/// # Safety
/// As there.
#[target_feature(enable = "avx2")]
pub unsafe fn pack_double(
    table: &RowTable,
    motion: Motion<'_>,
    first: usize,
    to: &mut [f64],
    rows: &Disjoint<'_, DoubleRow>,
) {
    let lengths = load(&motion.lengths);
    let stretch = load(&motion.stretch);
    let slots = first..first + to.len();
    let own_rows = fours(&table.row[slots.clone()]);
    let images = fours(&table.image[slots]);
    let all = fours(motion.indices()).zip(own_rows).zip(images.zip(fours(motion.built)));
    let fours = all.zip(to.as_chunks_mut::<4>().0).enumerate();
    for (four, (((order, own_rows), (images, built)), to)) in fours {
        let mut moved = [_mm256_setzero_pd(); 4];
        for k in 0..4 {
            let r = load(&motion.positions[order[k] as usize]);
            let [x, y, z] = images[k].to_array();
            let image = _mm256_cvtepi32_pd(_mm_setr_epi32(x, y, z, 0));
            let home = _mm256_sub_pd(r, _mm256_mul_pd(image, lengths));
            let mut row = DoubleRow::default();
            // SAFETY: a row has four elements and the alignment of a register. Rows of slots are distinct, and these slots
            // belong to this thread.
            unsafe {
                _mm256_store_pd(row.0.as_mut_ptr(), home);
                if motion.species.is_some() {
                    row.0[3] = motion.padding(4 * four + k);
                }
                rows.write(own_rows[k] as usize, row);
            }
            moved[k] = displacement(r, &built[k], stretch);
        }
        // SAFETY: there are four.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), squares(moved)) };
    }
    let (done, all) = (to.len() / 4 * 4, to.len());
    let rest = motion.part(done..all);
    // SAFETY: the contract is passed on.
    unsafe { packing::pack_double(table, rest, first + done, &mut to[done..], rows) };
}

/// See [`packing::pack_ghosts`].
///
/// # Safety
/// As there.
#[target_feature(enable = "avx2")]
pub unsafe fn pack_ghosts(
    table: &RowTable,
    lengths: DVec3,
    ghosts: Range<usize>,
    rows: &Disjoint<'_, DoubleRow>,
) {
    let lengths = load(&lengths);
    for ghost in &table.ghosts[ghosts] {
        let [x, y, z] = ghost.shift;
        let shift = _mm_cvtsi32_si128(i32::from_le_bytes([x, y, z, 0].map(|s| s as u8)));
        let shift = _mm256_cvtepi32_pd(_mm_cvtepi8_epi32(shift));
        // SAFETY: the source is no ghost, so no thread writes it now. Each ghost has a row of its own, and rows are
        // aligned.
        unsafe {
            let source = rows.read(ghost.source as usize);
            let source = _mm256_load_pd(source.0.as_ptr());
            let mut row = DoubleRow::default();
            let shifted = _mm256_add_pd(source, _mm256_mul_pd(shift, lengths));
            _mm256_store_pd(row.0.as_mut_ptr(), shifted);
            rows.write(ghost.row as usize, row);
        }
    }
}

/// See [`packing::pack_fixed`].
///
/// # Safety
/// As there.
#[target_feature(enable = "avx2")]
pub unsafe fn pack_fixed(
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    mut to: Option<&mut [f64]>,
    rows: &Disjoint<'_, FixedRow>,
) {
    let n = motion.len();
    let mut done = 0;
    if table.is_near_home() {
        let units = load(&(FIXED_UNITS / motion.lengths));
        let stretch = load(&motion.stretch);
        let rounding = _mm256_set1_pd(FIXED_ROUNDING);
        for order in fours(motion.indices()) {
            let mut r = [_mm256_setzero_pd(); 4];
            for k in 0..4 {
                r[k] = load(&motion.positions[order[k] as usize]);
                // Multiplication and addition stay apart: the build of the list has the same bits.
                let scaled = _mm256_add_pd(_mm256_mul_pd(r[k], units), rounding);
                let low = _mm_castpd_ps(_mm256_castpd256_pd128(scaled));
                let high = _mm_castpd_ps(_mm256_extractf128_pd::<1>(scaled));
                let fixed = _mm_castps_si128(_mm_shuffle_ps::<0b10_00_10_00>(low, high));
                let mut row = FixedRow::default();
                // SAFETY: a row has four elements; these slots belong to this thread.
                unsafe {
                    _mm_storeu_si128(row.as_mut_ptr().cast(), fixed);
                    if motion.species.is_some() {
                        row[3] = motion.fixed_padding(done + k);
                    }
                    rows.write(first + done + k, row);
                }
            }
            if let Some(to) = &mut to {
                let slots = done..done + 4;
                let built = &motion.built[slots.clone()];
                let moved = |k: usize| displacement(r[k], &built[k], stretch);
                let found = squares([moved(0), moved(1), moved(2), moved(3)]);
                // SAFETY: there are four.
                unsafe { _mm256_storeu_pd(to[slots].as_mut_ptr(), found) };
            }
            done += 4;
        }
    }
    let rest = to.map(|to| &mut to[done..]);
    // SAFETY: the contract is passed on.
    unsafe { packing::pack_fixed(table, motion.part(done..n), first + done, rest, rows) };
}

#[cfg(test)]
mod tests;
