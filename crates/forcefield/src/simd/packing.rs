//! From particles to rows: wrapping, displacement since the build, and ghosts, in one pass each.

use std::ops::Range;

use glam::DVec3;
use lennard_neighbor::{ColumnTable, FIXED_UNITS, RowTable};

use super::{DoubleRow, FixedRow, Scatter};

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

    /// Includes the particle at a place; a displacement with a square above `far2` is far.
    #[inline(always)]
    pub fn include(&mut self, place: usize, displacement: DVec3, far2: f64) {
        let d2 = displacement.length_squared();
        if d2 > far2 {
            self.far.push(place as u32);
        }
        self.finite &= d2 < f64::INFINITY;
        self.largest2 = if d2 > self.largest2 {
            d2
        } else {
            self.largest2
        };
    }
}

/// The build that displacements are counted from.
#[derive(Debug, Clone, Copy)]
pub struct Built<'a> {
    /// The positions of the build, by place, σ.
    pub at: &'a [DVec3],
    /// The |x − x⁰|² beyond which a particle moved far, σ².
    pub far2: f64,
}

/// Writes the rows of some places in double precision: positions minus the image that each had when the
/// list was built, so that rows move continuously.
///
/// # Safety
/// No other thread writes the rows of these places.
pub unsafe fn pack_double(
    table: &RowTable,
    positions: &[DVec3],
    built: Built<'_>,
    lengths: DVec3,
    places: Range<usize>,
    rows: &Scatter<'_, DoubleRow>,
) -> Moved {
    let mut moved = Moved::NOTHING;
    let places = table.particle[places.clone()]
        .iter()
        .zip(&table.row[places.clone()])
        .zip(&table.image[places.clone()])
        .zip(built.at[places.clone()].iter().zip(places));
    for (((particle, row), image), (at, place)) in places {
        let r = positions[*particle as usize];
        moved.include(place, r - *at, built.far2);
        let r = r - image.as_dvec3() * lengths;
        // SAFETY: rows of places are distinct, and these places are this thread's.
        unsafe { rows.write(*row as usize, DoubleRow([r.x, r.y, r.z, 0.0])) };
    }
    moved
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

/// Writes the rows of some places in fixed point.
///
/// # Safety
/// No other thread writes the rows of these places.
pub unsafe fn pack_columns(
    table: &ColumnTable,
    positions: &[DVec3],
    built: Built<'_>,
    lengths: DVec3,
    places: Range<usize>,
    rows: &Scatter<'_, FixedRow>,
) -> Moved {
    let units = FIXED_UNITS / lengths;
    let mut moved = Moved::NOTHING;
    for place in places {
        let r = positions[table.particle[place] as usize];
        moved.include(place, r - built.at[place], built.far2);
        let [x, y, z] = table.fixed(place, r, lengths, units);
        // SAFETY: these places are this thread's.
        unsafe { rows.write(place, FixedRow([x, y, z, 0])) };
    }
    moved
}
