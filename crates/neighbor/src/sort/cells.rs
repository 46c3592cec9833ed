//! Ranges of cells along a periodic axis, numbered on beyond the faces of the box.

use std::ops::Range;

use crate::sort::columns::ColumnTable;
use crate::sort::row_table::RowTable;

/// The cell of the box, one of `count`, that is the image of a cell numbered on beyond the faces.
#[inline(always)]
pub(crate) fn wrap_cell(cell: i64, count: u32) -> u32 {
    let count = i64::from(count);
    // Nearly all cells lie in the box or beside it, and a division is slow.
    let near = [cell, cell.wrapping_add(count), cell.wrapping_sub(count)];
    let inside = near.into_iter().find(|cell| (0..count).contains(cell));
    inside.unwrap_or_else(|| cell.rem_euclid(count)) as u32
}

/// Consecutive cells along an axis, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CellRange {
    pub first: i64,
    pub last: i64,
}

impl CellRange {
    /// The range cut to at most `count` cells, so that no cell occurs twice.
    #[inline(always)]
    fn at_most(self, count: u32) -> Self {
        let all = i64::from(count);
        if self.last.saturating_sub(self.first) < all - 1 {
            return self;
        }
        Self { first: 0, last: all - 1 }
    }

    /// The cells of the box that the range covers, each once; the axis has `count` cells.
    #[inline(always)]
    pub fn wrapped(self, count: u32) -> impl Iterator<Item = u32> {
        let Self { first, last } = self.at_most(count);
        (first..=last).map(move |cell| wrap_cell(cell, count))
    }

    /// The same cells as one run or two runs of consecutive cells, both ends included.
    #[inline(always)]
    pub fn runs(self, count: u32) -> impl Iterator<Item = [u32; 2]> {
        let Self { first, last } = self.at_most(count);
        let (a, b) = (wrap_cell(first, count), wrap_cell(last, count));
        let (run, beyond_the_face) =
            if a <= b { ([a, b], None) } else { ([a, count - 1], Some([0, b])) };
        [Some(run), beyond_the_face].into_iter().flatten()
    }
}

// The cells of either sort, as the search for unlisted pairs reads them.

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

    /// The slots of the particles in a column.
    #[must_use]
    pub fn column(self, [x, y]: [u32; 2]) -> Range<u32> {
        let [_, _, nz] = self.count();
        self.slots(x, y, [0, nz - 1])
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_beyond_the_faces_wraps_and_no_cell_comes_twice() {
        let wrapped = |first, last| CellRange { first, last }.wrapped(5).collect::<Vec<_>>();
        assert_eq!(wrapped(-2, 1), [3, 4, 0, 1]);
        assert_eq!(wrapped(4, 8), [0, 1, 2, 3, 4]);
        assert_eq!(wrapped(-7, 9), [0, 1, 2, 3, 4]);
        let runs = |first, last| CellRange { first, last }.runs(5).collect::<Vec<_>>();
        assert_eq!(runs(-2, 1), [[3, 4], [0, 1]]);
        assert_eq!(runs(6, 8), [[1, 3]]);
        assert_eq!(runs(-1, 6), [[0, 4]]);
        assert_eq!(runs(i64::MIN, i64::MAX), [[0, 4]]);
        assert_eq!([i64::MIN, i64::MAX].map(|k| wrap_cell(k, 8)), [0, 7]);
        assert_eq!([-11, -1, 0, 4, 5, 13].map(|k| wrap_cell(k, 5)), [4, 4, 0, 4, 0, 3]);
    }
}
