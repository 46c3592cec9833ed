//! The layers of a row table along x, which its tasks fill one by one.

use std::ops::Range;

use super::cell_grid::CellGrid;

/// The layers of cells of the extended grid along x.
pub(super) struct Layers<'a> {
    grid: &'a CellGrid,
    /// The first slot of each home cell, and the end.
    first_slot: &'a [u32],
    /// The home cell and the box of each extended cell along each axis.
    axes: [Vec<(usize, i8)>; 3],
}

impl<'a> Layers<'a> {
    pub fn of(grid: &'a CellGrid, first_slot: &'a [u32]) -> Self {
        Self { grid, first_slot, axes: [0, 1, 2].map(|axis| grid.axis(axis)) }
    }

    /// The rows of a layer.
    pub fn rows(&self, x: usize) -> Range<usize> {
        let [_, ey, ez] = self.grid.extended();
        let first_row = |x: usize| self.grid.first_row[x * ey * ez] as usize;
        first_row(x)..first_row(x + 1)
    }

    /// An array with one element per row, cut into layers.
    pub fn cut<'t, T>(&self, rows: &'t mut [T]) -> Vec<&'t mut [T]> {
        cut(rows, (0..self.axes[0].len()).map(|x| self.rows(x).len()))
    }

    /// Visits the rows of a layer in their order, in runs of cells of a column: the slots of each, and its box.
    pub fn for_each_run(&self, x: usize, mut visit: impl FnMut(Range<u32>, [i8; 3])) {
        let (hx, sx) = self.axes[0][x];
        for (hy, sy) in &self.axes[1] {
            // Slots ascend along z, but for the faces of the box.
            for run in self.axes[2].chunk_by(|(_, a), (_, b)| a == b) {
                let (first, sz) = run[0];
                let home = self.grid.home_index(hx, *hy, first);
                let slots = self.first_slot[home]..self.first_slot[home + run.len()];
                visit(slots, [sx, *sy, sz]);
            }
        }
    }
}

/// The first parts of an array, of these lengths.
pub(super) fn cut<T>(mut items: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let part = |length| items.split_off_mut(..length).unwrap_or_default();
    lengths.map(part).collect()
}
