//! From particles to rows with AVX2, a register for each particle: the same bits as [`super::packing`].

use std::arch::x86_64::*;
use std::ops::Range;

use glam::DVec3;
use lennard_neighbor::{ColumnTable, FIXED_ROUNDING, FIXED_UNITS, RowTable, Way, Ways};

use super::packing::{self, Motion, Pace};
use super::{DoubleRow, FixedRow, Scatter};

/// Elements in fours; the last ones, which make no four, are left to the plain loops.
fn fours<T>(of: &[T]) -> std::slice::Iter<'_, [T; 4]> {
    of.as_chunks().0.iter()
}

/// x, y, z and 0.
#[target_feature(enable = "avx2")]
#[inline]
fn load(r: &DVec3) -> __m256d {
    let xyz = _mm256_setr_epi64x(-1, -1, -1, 0);
    let at: &[f64; 3] = r.as_ref();
    // SAFETY: what the mask leaves out is not read.
    unsafe { _mm256_maskload_pd(at.as_ptr(), xyz) }
}

/// |d|² of four vectors whose last component is 0, summed as [`DVec3::length_squared`] does.
#[target_feature(enable = "avx2")]
#[inline]
fn squares([a, b, c, d]: [__m256d; 4]) -> __m256d {
    let (a, b) = (_mm256_mul_pd(a, a), _mm256_mul_pd(b, b));
    let (c, d) = (_mm256_mul_pd(c, c), _mm256_mul_pd(d, d));
    // x + y of a and b, z of a and b; the same of c and d.
    let (ab, cd) = (_mm256_hadd_pd(a, b), _mm256_hadd_pd(c, d));
    _mm256_add_pd(
        _mm256_permute2f128_pd::<0x20>(ab, cd),
        _mm256_permute2f128_pd::<0x31>(ab, cd),
    )
}

/// See [`packing::write_ways`].
#[target_feature(enable = "avx2")]
pub fn write_ways(motion: Motion<'_>, squares: &[f64], ways: &mut [Way]) {
    let parts = Ways::new(motion.far2);
    let (along, steps) = (_mm256_set1_pd(parts.along), _mm256_set1_pd(parts.squares));
    let all = fours(motion.order).zip(fours(motion.built));
    for (((order, built), squares), to) in all.zip(fours(squares)).zip(ways.as_chunks_mut::<4>().0)
    {
        let whole = |k: usize| {
            let r = load(&motion.positions[order[k] as usize]);
            _mm256_cvtpd_epi32(_mm256_mul_pd(_mm256_sub_pd(r, load(&built[k])), along))
        };
        let first_two = _mm_packs_epi32(whole(0), whole(1));
        let last_two = _mm_packs_epi32(whole(2), whole(3));
        let squares = _mm256_mul_pd(
            _mm256_setr_pd(squares[0], squares[1], squares[2], squares[3]),
            steps,
        );
        // The second where the first is no number.
        let squares = _mm256_cvtpd_epi32(_mm256_min_pd(squares, _mm256_set1_pd(254.0)));
        let squares = _mm_slli_epi32::<24>(_mm_add_epi32(squares, _mm_set1_epi32(1)));
        // Beside x, y and z there is 0 where the square belongs.
        let ways = _mm_or_si128(_mm_packs_epi16(first_two, last_two), squares);
        // SAFETY: there are four, of four bytes in this order.
        unsafe { _mm_storeu_si128(to.as_mut_ptr().cast(), ways) };
    }
    let (done, all) = (ways.len() / 4 * 4, ways.len());
    packing::write_ways(motion.part(done..all), &squares[done..], &mut ways[done..]);
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
    rows: &Scatter<'_, DoubleRow>,
) {
    let lengths = load(&motion.lengths);
    let places = first..first + to.len();
    let own_rows = fours(&table.row[places.clone()]);
    let images = fours(&table.image[places]);
    let all = fours(motion.order)
        .zip(own_rows)
        .zip(images.zip(fours(motion.built)));
    for (((order, own_rows), (images, built)), to) in all.zip(to.as_chunks_mut::<4>().0) {
        let mut moved = [_mm256_setzero_pd(); 4];
        for k in 0..4 {
            let r = load(&motion.positions[order[k] as usize]);
            let [x, y, z] = images[k].to_array();
            let image = _mm256_cvtepi32_pd(_mm_setr_epi32(x, y, z, 0));
            let home = _mm256_sub_pd(r, _mm256_mul_pd(image, lengths));
            let mut row = DoubleRow::default();
            // SAFETY: a row has four elements and the alignment of a register; rows of places are distinct, and these
            // places are this thread's.
            unsafe {
                _mm256_store_pd(row.0.as_mut_ptr(), home);
                rows.write(own_rows[k] as usize, row);
            }
            moved[k] = _mm256_sub_pd(r, load(&built[k]));
        }
        // SAFETY: there are four.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), squares(moved)) };
    }
    let (done, all) = (to.len() / 4 * 4, to.len());
    let rest = motion.part(done..all);
    // SAFETY: the contract is passed on.
    unsafe { packing::pack_double(table, rest, first + done, &mut to[done..], rows) };
}

/// See [`packing::go_on`].
#[target_feature(enable = "avx2")]
pub fn go_on(
    positions: &mut [DVec3],
    velocities: &mut [DVec3],
    forces: &[DVec3],
    pace: Pace,
) -> f64 {
    let [half_kick, dt] = [pace.half_kick, pace.dt].map(|h| _mm256_set1_pd(h));
    let sign = _mm256_set1_pd(-0.0);
    // The components of four particles are three registers.
    let mut longest = [_mm256_setzero_pd(); 3];
    let (x, x_rest) = positions.as_chunks_mut::<4>();
    let (v, v_rest) = velocities.as_chunks_mut::<4>();
    let (f, f_rest) = forces.as_chunks::<4>();
    for ((x, v), f) in x.iter_mut().zip(v).zip(f) {
        let (x, v) = (x.as_mut_ptr().cast::<f64>(), v.as_mut_ptr().cast::<f64>());
        let f = f.as_ptr().cast::<f64>();
        for (k, longest) in longest.iter_mut().enumerate() {
            // SAFETY: four vectors are twelve numbers that follow each other.
            unsafe {
                let (x, v) = (x.add(4 * k), v.add(4 * k));
                let kick = _mm256_mul_pd(half_kick, _mm256_loadu_pd(f.add(4 * k)));
                let v_next = _mm256_add_pd(_mm256_add_pd(_mm256_loadu_pd(v), kick), kick);
                let before = _mm256_loadu_pd(x);
                let after = _mm256_add_pd(before, _mm256_mul_pd(dt, v_next));
                let step = _mm256_andnot_pd(sign, _mm256_sub_pd(after, before));
                *longest = _mm256_max_pd(step, *longest);
                _mm256_storeu_pd(v, v_next);
                _mm256_storeu_pd(x, after);
            }
        }
    }
    let mut of_each = [DVec3::ZERO; 4];
    for (k, longest) in longest.into_iter().enumerate() {
        // SAFETY: as above.
        unsafe { _mm256_storeu_pd(of_each.as_mut_ptr().cast::<f64>().add(4 * k), longest) };
    }
    let longest = of_each.into_iter().fold(DVec3::ZERO, DVec3::max);
    packing::go_on(x_rest, v_rest, f_rest, pace, longest)
}

const _: () =
    assert!(size_of::<DVec3>() == 3 * size_of::<f64>() && align_of::<DVec3>() == align_of::<f64>());

/// See [`packing::pack_ghosts`].
///
/// # Safety
/// As there.
#[target_feature(enable = "avx2")]
pub unsafe fn pack_ghosts(
    table: &RowTable,
    lengths: DVec3,
    ghosts: Range<usize>,
    rows: &Scatter<'_, DoubleRow>,
) {
    let lengths = load(&lengths);
    for ghost in &table.ghosts[ghosts] {
        let [x, y, z] = ghost.shift;
        let shift = _mm_cvtsi32_si128(i32::from_le_bytes([x, y, z, 0].map(|s| s as u8)));
        let shift = _mm256_cvtepi32_pd(_mm_cvtepi8_epi32(shift));
        // SAFETY: the source is no ghost, so nobody writes it now; each ghost has a row of its own; rows are aligned.
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

/// See [`packing::pack_columns`].
///
/// # Safety
/// As there.
#[target_feature(enable = "avx2")]
pub unsafe fn pack_columns(
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    mut to: Option<&mut [f64]>,
    rows: &Scatter<'_, FixedRow>,
) {
    let n = motion.order.len();
    let mut done = 0;
    if table.is_near_home() {
        let units = load(&(FIXED_UNITS / motion.lengths));
        let rounding = _mm256_set1_pd(FIXED_ROUNDING);
        for order in fours(motion.order) {
            let mut r = [_mm256_setzero_pd(); 4];
            for k in 0..4 {
                r[k] = load(&motion.positions[order[k] as usize]);
                // Not fused: the list was built from the same bits.
                let scaled = _mm256_add_pd(_mm256_mul_pd(r[k], units), rounding);
                let low = _mm_castpd_ps(_mm256_castpd256_pd128(scaled));
                let high = _mm_castpd_ps(_mm256_extractf128_pd::<1>(scaled));
                let fixed = _mm_castps_si128(_mm_shuffle_ps::<0b10_00_10_00>(low, high));
                let mut row = FixedRow::default();
                // SAFETY: a row has four elements and the alignment of a register; these places are this thread's.
                unsafe {
                    _mm_store_si128(row.0.as_mut_ptr().cast(), fixed);
                    rows.write(first + done + k, row);
                }
            }
            if let Some(to) = &mut to {
                let places = done..done + 4;
                let built = &motion.built[places.clone()];
                let moved = |k: usize| _mm256_sub_pd(r[k], load(&built[k]));
                let found = squares([moved(0), moved(1), moved(2), moved(3)]);
                // SAFETY: there are four.
                unsafe { _mm256_storeu_pd(to[places].as_mut_ptr(), found) };
            }
            done += 4;
        }
    }
    let rest = to.map(|to| &mut to[done..]);
    // SAFETY: the contract is passed on.
    unsafe { packing::pack_columns(table, motion.part(done..n), first + done, rest, rows) };
}

#[cfg(test)]
mod tests {
    use super::super::{By, Level, Moved, go_on, pack_columns, pack_double};
    use super::*;
    use lennard_core::PeriodicBox;
    use lennard_neighbor::Given;

    /// Whether what is tested here can run; says so where it cannot.
    #[allow(clippy::print_stdout)]
    fn has_avx2() -> bool {
        let has = Level::Avx2.is_available();
        if !has {
            println!("skipped: this processor has no AVX2");
        }
        has
    }

    /// Rows and displacements of what is `shift` boxes away from home, at a level.
    type Packed = (Vec<DoubleRow>, Moved, Vec<FixedRow>, Moved, [Vec<Way>; 2]);

    const LENGTHS: DVec3 = DVec3::new(9.0, 8.0, 10.0);

    fn packed(level: Level, by: By, shift: f64, broken: bool) -> Packed {
        let cell = PeriodicBox::new(LENGTHS).unwrap();
        // No multiple of four or of a batch, and more than one task.
        let n = 2307;
        let noise = |k: usize| ((k as f64 * 12.9898).sin() * 43_758.545_3).rem_euclid(1.0);
        let start: Vec<DVec3> = (0..n)
            .map(|i| {
                let at = DVec3::new(noise(i), noise(i + 5000), noise(i + 9000));
                let image = if i % 3 == 0 {
                    DVec3::splat(shift)
                } else {
                    DVec3::NEG_X
                };
                (at + image) * LENGTHS
            })
            .collect();
        let mut now: Vec<DVec3> = start.clone();
        for (i, r) in now.iter_mut().enumerate() {
            *r += DVec3::splat(noise(i + 777) - 0.5) * 0.3;
        }
        if broken {
            now[1234].y = f64::NAN;
        }
        let built = |particles: &[u32]| -> Vec<DVec3> {
            particles.iter().map(|p| start[*p as usize]).collect()
        };
        fn motion<'a>(positions: &'a [DVec3], order: &'a [u32], built: &'a [DVec3]) -> Motion<'a> {
            Motion {
                positions,
                order,
                built,
                far2: 0.01,
                lengths: LENGTHS,
            }
        }
        let mut ways = [vec![Way::default(); n], vec![Way::default(); n]];
        let mut by_cell = RowTable::default();
        by_cell.sort(&cell, Given::ByParticle(&start), 2.8).unwrap();
        let at = built(&by_cell.particle);
        let mut double = vec![DoubleRow::default(); by_cell.rows()];
        let moved_double = pack_double(
            level,
            by,
            &by_cell,
            motion(&now, &by_cell.particle, &at),
            &mut double,
            Some(&mut ways[0]),
        );
        let mut columns = ColumnTable::default();
        columns.sort(&cell, Given::ByParticle(&start)).unwrap();
        assert_eq!(columns.is_near_home(), shift.abs() < 1e5);
        let at = built(&columns.particle);
        let mut fixed = vec![FixedRow::default(); n];
        let moved_fixed = pack_columns(
            level,
            by,
            &columns,
            motion(&now, &columns.particle, &at),
            &mut fixed,
            Some(&mut ways[1]),
        );
        (double, moved_double, fixed, moved_fixed, ways)
    }

    /// NaN equals itself here.
    fn bits((double, moved_double, fixed, moved_fixed, ways): Packed) -> impl PartialEq {
        let double: Vec<[u64; 4]> = double.iter().map(|r| r.0.map(f64::to_bits)).collect();
        let bits = |m: Moved| (m.largest2.to_bits(), m.finite, m.far);
        // What is not finite has a way that means nothing.
        let ways = ways.map(|mut ways| {
            ways.retain(|way| way.square < 255);
            ways
        });
        (double, bits(moved_double), fixed, bits(moved_fixed), ways)
    }

    #[test]
    fn registers_pack_the_same_bits_as_plain_loops() {
        if !has_avx2() {
            return;
        }
        for shift in [0.0, 3.0, -3e6] {
            for broken in [false, true] {
                let plain = packed(Level::Portable, By::All, shift, broken);
                for moved in [&plain.1, &plain.3] {
                    assert_eq!(moved.finite, !broken);
                    assert!(!moved.far.is_empty() && moved.largest2 > 0.06);
                    assert!(moved.far.is_sorted());
                }
                let plain = bits(plain);
                for by in [By::OneThread, By::All] {
                    let found = bits(packed(Level::Avx2, by, shift, broken));
                    assert!(
                        found == plain,
                        "{shift} boxes away, {by:?}, broken: {broken}"
                    );
                }
            }
        }
    }

    #[test]
    fn registers_go_on_to_the_same_bits_as_plain_loops_within_the_same_bound() {
        if !has_avx2() {
            return;
        }
        let noise = |k: usize| (k as f64 * 12.9898).sin();
        let vectors = |from: usize, n: usize, scale: f64| -> Vec<DVec3> {
            let at = |k: usize| DVec3::new(noise(k), noise(k + 700), noise(k + 1400)) * scale;
            (from..from + n).map(at).collect()
        };
        let pace = Pace {
            half_kick: 0.002,
            dt: 0.004,
        };
        for n in [0, 1, 3, 4, 7, 50] {
            // The longest step is anybody's.
            for fastest in 0..n {
                let start = vectors(0, n, 1e4);
                let mut v = vectors(99, n, 1.0);
                v[fastest] *= 7.0;
                let forces = vectors(333, n, 50.0);
                let [plain, found] = [Level::Portable, Level::Avx2].map(|level| {
                    let (mut x, mut v) = (start.clone(), v.clone());
                    let bound = go_on(level, &mut x, &mut v, &forces, pace);
                    (x, v, bound)
                });
                assert_eq!(found, plain);
                let steps = found.0.iter().zip(&start).map(|(x, x0)| (x - x0).length());
                let longest = steps.fold(0.0, f64::max);
                assert!((longest..1.8 * longest).contains(&found.2), "{n} {fastest}");
            }
        }
    }

    #[test]
    fn those_that_moved_far_are_all_found() {
        let squares: Vec<f64> = (0..203).map(|i| f64::from(i % 7)).collect();
        let mut moved = Moved::NOTHING;
        moved.include(1000, &squares[..101], 4.5);
        moved.include(1101, &squares[101..], 4.5);
        let far = (1000..).zip(&squares).filter(|(_, d2)| **d2 > 4.5);
        assert_eq!(moved.far, far.map(|(place, _)| place).collect::<Vec<u32>>());
        assert_eq!((moved.largest2, moved.finite), (6.0, true));
        moved.include(2000, &[1.0, 2.0], 4.5);
        assert_eq!((moved.largest2, moved.finite), (6.0, true));
        moved.include(3000, &[0.0, f64::NAN, 1.0, 2.0, f64::INFINITY], 4.5);
        assert!(!moved.finite && moved.far.last() == Some(&3004));
    }
}
