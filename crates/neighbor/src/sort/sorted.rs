//! The cells of either sort, as the search for unlisted pairs reads them.

use std::ops::Range;

use glam::DVec3;

use super::columns::ColumnTable;
use super::row_table::RowTable;

/// Particles sorted into cells, as they were when a list was built; the cells of a column along z follow each other.
#[derive(Debug, Clone, Copy)]
pub enum Cells<'a> {
    /// Of rows.
    Rows(&'a RowTable),
    /// Of columns, cut into slices along z.
    Columns(&'a ColumnTable),
}

impl Cells<'_> {
    /// Number of cells along each axis.
    #[must_use]
    pub fn count(self) -> [u32; 3] {
        match self {
            Self::Rows(table) => table.count(),
            Self::Columns(table) => table.count(),
        }
    }

    /// Where the particle at a slot lies across the columns along x and y, in columns from the face of the box. The sort had
    /// its position `r` in a box of these sides, σ.
    pub(crate) fn across(self, slot: usize, r: DVec3, lengths: DVec3) -> [f64; 2] {
        match self {
            Self::Rows(table) => table.across(slot),
            Self::Columns(table) => table.across(slot, r, lengths),
        }
    }

    /// The slots of the particles in the column at (x, y), between two cells along z, both included.
    #[inline(always)]
    pub(crate) fn slots(self, x: u32, y: u32, z: [u32; 2]) -> Range<u32> {
        match self {
            Self::Rows(table) => table.slots_between(x, y, z),
            Self::Columns(table) => table.slots_of(table.grid.column(x, y), z),
        }
    }
}
