//! From particles to rows: wrapping, displacement since the build, and ghosts, in one pass each.

use std::ops::Range;

use glam::DVec3;
use lennard_neighbor::{ColumnTable, FIXED_UNITS, RowTable, Way, Ways};

use super::{DoubleRow, FixedRow, Level, Scatter};

/// How far some particles have moved since the list was built.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// The largest |x − x⁰|² met, σ².
    pub largest2: f64,
    /// Whether every one was a finite number.
    pub finite: bool,
    /// The places of those that moved far.
    pub far: Vec<u32>,
}

impl Moved {
    /// Nothing has moved.
    pub const NOTHING: Self = Self {
        largest2: 0.0,
        finite: true,
        far: Vec::new(),
    };

    /// The union of two sets of particles.
    pub fn and(mut self, other: Self) -> Self {
        self.far.extend(other.far);
        Self {
            largest2: self.largest2.max(other.largest2),
            finite: self.finite & other.finite,
            far: self.far,
        }
    }

    /// Includes the places from `first` on, by the squares of their displacements; those above `far2` are far.
    pub fn include(&mut self, first: usize, squares: &[f64], far2: f64) {
        // No branch for each: which ones moved far is anybody's guess.
        let mut largest2 = [self.largest2; 4];
        let mut all_near = true;
        let (fours, rest) = squares.as_chunks::<4>();
        for four in fours {
            for (largest2, d2) in largest2.iter_mut().zip(four) {
                *largest2 = if *d2 > *largest2 { *d2 } else { *largest2 };
                // False for NaN.
                all_near &= *d2 <= far2;
            }
        }
        for d2 in rest {
            largest2[0] = if *d2 > largest2[0] { *d2 } else { largest2[0] };
            all_near &= *d2 <= far2;
        }
        self.largest2 = largest2.into_iter().fold(0.0, f64::max);
        if all_near {
            return;
        }
        let mut len = self.far.len();
        self.far.resize(len + squares.len(), 0);
        for (place, d2) in (first..).zip(squares) {
            self.far[len] = place as u32;
            len += usize::from(*d2 > far2);
            self.finite &= *d2 < f64::INFINITY;
        }
        self.far.truncate(len);
    }
}

/// Places whose displacements are looked at together.
const BATCH: usize = 64;

/// Packs places in batches by `pack(motion, first, squares)`, which writes |x − x⁰|² of each place from `first` on; and
/// writes their ways, where these are wanted.
///
/// # Safety
/// No other thread writes the ways of these places.
#[inline(always)]
pub unsafe fn in_batches(
    level: Level,
    motion: Motion<'_>,
    places: Range<usize>,
    ways: Option<&Scatter<'_, Way>>,
    pack: impl Fn(Motion<'_>, usize, &mut [f64]),
) -> Moved {
    let mut moved = Moved::NOTHING;
    let mut squares = [0.0; BATCH];
    for first in places.clone().step_by(BATCH) {
        let batch = first..places.end.min(first + BATCH);
        let squares = &mut squares[..batch.len()];
        let motion = motion.part(batch.clone());
        pack(motion, first, squares);
        moved.include(first, squares, motion.far2);
        if let Some(ways) = ways {
            // SAFETY: the contract is passed on.
            super::write_ways(level, motion, squares, unsafe { ways.part(batch) });
        }
    }
    moved
}

/// Writes ways of particles whose |x − x⁰|² are known.
pub fn write_ways(motion: Motion<'_>, squares: &[f64], ways: &mut [Way]) {
    let parts = Ways::new(motion.far2);
    for (k, (way, d2)) in ways.iter_mut().zip(squares).enumerate() {
        *way = parts.way(motion.moved(k), *d2);
    }
}

/// Where the particles at some places are, and where they were when the list was built.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// Unwrapped positions, σ.
    pub positions: &'a [DVec3],
    /// Which of them belongs to each place.
    pub order: &'a [u32],
    /// The positions of the build, by place, σ.
    pub built: &'a [DVec3],
    /// The |x − x⁰|² beyond which a particle moved far, σ².
    pub far2: f64,
    /// The sides of the box, σ.
    pub lengths: DVec3,
}

impl Motion<'_> {
    /// That of some of the places.
    #[inline(always)]
    pub fn part(self, places: Range<usize>) -> Self {
        Self {
            order: &self.order[places.clone()],
            built: &self.built[places],
            ..self
        }
    }

    /// Where the particle at the `k`th place is, σ.
    #[inline(always)]
    fn at(&self, k: usize) -> DVec3 {
        self.positions[self.order[k] as usize]
    }

    /// Its x − x⁰, σ.
    #[inline(always)]
    fn moved(&self, k: usize) -> DVec3 {
        self.at(k) - self.built[k]
    }
}

/// How particles go on.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Half a step over the mass, τ.
    pub half_kick: f64,
    /// The step, τ.
    pub dt: f64,
}

/// Two half kicks and a drift, v ← v + (h/2m)·F twice, x ← x + h·v: the bits of [`lennard_core::sweeps`]. Gives what no step
/// |x − x_before| of these and of others is longer than, of which the longest along each axis are known, σ.
#[inline(always)]
pub fn go_on(
    positions: &mut [DVec3],
    velocities: &mut [DVec3],
    forces: &[DVec3],
    pace: Pace,
    mut longest: DVec3,
) -> f64 {
    for ((x, v), f) in positions.iter_mut().zip(velocities).zip(forces) {
        let (before, kick) = (*x, pace.half_kick * *f);
        *v += kick;
        *v += kick;
        *x += pace.dt * *v;
        longest = (*x - before).abs().max(longest);
    }
    // With some care: all of it is rounded.
    longest.length() * (1.0 + 1e-12)
}

/// Writes the rows of the places from `first` on in double precision, positions minus the image that each had when the
/// list was built, so that rows move continuously; and |x − x⁰|².
///
/// # Safety
/// No other thread writes the rows of these places.
pub unsafe fn pack_double(
    table: &RowTable,
    motion: Motion<'_>,
    first: usize,
    squares: &mut [f64],
    rows: &Scatter<'_, DoubleRow>,
) {
    for (k, d2) in squares.iter_mut().enumerate() {
        let place = first + k;
        let r = motion.at(k);
        *d2 = motion.moved(k).length_squared();
        let home = r - table.image[place].as_dvec3() * motion.lengths;
        let row = DoubleRow([home.x, home.y, home.z, 0.0]);
        // SAFETY: rows of places are distinct, and these places are this thread's.
        unsafe { rows.write(table.row[place] as usize, row) };
    }
}

/// Refreshes some ghosts from the rows that they repeat.
///
/// # Safety
/// No other thread writes these ghosts, and none writes a row that is not a ghost.
pub unsafe fn pack_ghosts(
    table: &RowTable,
    lengths: DVec3,
    ghosts: Range<usize>,
    rows: &Scatter<'_, DoubleRow>,
) {
    for ghost in &table.ghosts[ghosts] {
        let [sx, sy, sz] = ghost.shift;
        // SAFETY: the source is no ghost, so nobody writes it now.
        let DoubleRow([x, y, z, _]) = unsafe { rows.read(ghost.source as usize) };
        let shifted = [
            x + f64::from(sx) * lengths.x,
            y + f64::from(sy) * lengths.y,
            z + f64::from(sz) * lengths.z,
            0.0,
        ];
        // SAFETY: each ghost has a row of its own.
        unsafe { rows.write(ghost.row as usize, DoubleRow(shifted)) };
    }
}

/// Writes the rows of the places from `first` on in fixed point, and |x − x⁰|², where there is room for them.
///
/// # Safety
/// No other thread writes the rows of these places.
pub unsafe fn pack_columns(
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    mut squares: Option<&mut [f64]>,
    rows: &Scatter<'_, FixedRow>,
) {
    let units = FIXED_UNITS / motion.lengths;
    for k in 0..motion.order.len() {
        let place = first + k;
        let r = motion.at(k);
        if let Some(squares) = &mut squares {
            squares[k] = motion.moved(k).length_squared();
        }
        let [x, y, z] = table.fixed(place, r, motion.lengths, units);
        // SAFETY: these places are this thread's.
        unsafe { rows.write(place, FixedRow([x, y, z, 0])) };
    }
}
