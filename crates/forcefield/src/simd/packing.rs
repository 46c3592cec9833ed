//! From particles to rows: folding, displacements since the build, and ghosts, in one pass each. Plain loops.

use std::ops::Range;

use lennard_neighbor::{ColumnTable, DisplacementScale, FIXED_UNITS, PackedDisplacement, RowTable};

use super::disjoint::Disjoint;
use super::motion::Motion;
use super::row::{DoubleRow, FixedRow};

/// Writes the packed displacements of particles whose |d|² are in `squares`.
pub fn pack_displacements(motion: Motion<'_>, squares: &[f64], to: &mut [PackedDisplacement]) {
    let scale = DisplacementScale::new(motion.far2);
    for (k, (packed, d2)) in to.iter_mut().zip(squares).enumerate() {
        *packed = scale.pack(motion.displacement(k), *d2);
    }
}

/// Writes the rows of the slots from `first` on in double precision, and |d|² to `squares`.
///
/// A row is the position minus the image that the particle had at the build, so that rows move continuously.
///
/// # Safety
/// No other thread writes the rows of these slots.
pub unsafe fn pack_double(
    table: &RowTable,
    motion: Motion<'_>,
    first: usize,
    squares: &mut [f64],
    rows: &Disjoint<'_, DoubleRow>,
) {
    for (k, d2) in squares.iter_mut().enumerate() {
        let slot = first + k;
        let r = motion.at(k);
        *d2 = motion.displacement(k).length_squared();
        let home = r - table.image[slot].as_dvec3() * motion.lengths;
        let row = DoubleRow([home.x, home.y, home.z, motion.padding(k)]);
        // SAFETY: rows of slots are distinct, and these slots belong to this thread.
        unsafe { rows.write(table.row[slot] as usize, row) };
    }
}

/// Writes some ghosts: the rows that they repeat, shifted by whole boxes.
///
/// # Safety
/// No other thread writes these ghosts, and none writes a row that is not a ghost.
pub unsafe fn pack_ghosts(
    table: &RowTable,
    lengths: glam::DVec3,
    ghosts: Range<usize>,
    rows: &Disjoint<'_, DoubleRow>,
) {
    for ghost in &table.ghosts[ghosts] {
        let [sx, sy, sz] = ghost.shift;
        // SAFETY: the source is no ghost, so no thread writes it now.
        let DoubleRow([x, y, z, padding]) = unsafe { rows.read(ghost.source as usize) };
        let shifted = [
            x + f64::from(sx) * lengths.x,
            y + f64::from(sy) * lengths.y,
            z + f64::from(sz) * lengths.z,
            padding,
        ];
        // SAFETY: each ghost has a row of its own.
        unsafe { rows.write(ghost.row as usize, DoubleRow(shifted)) };
    }
}

/// Writes the rows of the slots from `first` on in fixed point, and |d|² to `squares`, where given.
///
/// # Safety
/// No other thread writes the rows of these slots.
pub unsafe fn pack_fixed(
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    mut squares: Option<&mut [f64]>,
    rows: &Disjoint<'_, FixedRow>,
) {
    let units = FIXED_UNITS / motion.lengths;
    for k in 0..motion.len() {
        let slot = first + k;
        let r = motion.at(k);
        if let Some(squares) = &mut squares {
            squares[k] = motion.displacement(k).length_squared();
        }
        let [x, y, z] = table.fixed(slot, r, motion.lengths, units);
        // SAFETY: these slots belong to this thread.
        unsafe { rows.write(slot, [x, y, z, motion.fixed_padding(k)]) };
    }
}
