//! The row table: particles sorted by cell into rows, with their periodic images as ghost rows.
//!
//! ```text
//!   cells of the extended grid     ghost | home home home home | ghost
//!   rows                           0   1 | 2   3   4   5   6   | 7   8
//!   slot shown by each row         3   4 | 0   1   2   3   4   | 0   1
//!
//!   A row in double precision, as the pair loop reads it (32 bytes, one AVX register):
//!   +-----+-----+-----+-----+
//!   |  x  |  y  |  z  |  0  |   f64, σ; the coordinates of the particle or of its image
//!   +-----+-----+-----+-----+
//! ```
//!
//! A force loop over rows needs no minimum image: the nearest image of a neighbor is a row of its own.

use std::ops::Range;
use std::slice;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::tasks::{for_each_item, map_items};

use super::cell_grid::CellGrid;
use super::cell_sort::CellSort;
use super::cells::Cells;
use super::coordinates::{PADDING, RowCoordinates};
use super::fold::{FARTHEST_IMAGE, fold};
use super::layers::{Layers, cut};
use super::positions::{GridError, Positions};

/// Number of consecutive cells of a column that share one gathering of candidates.
///
/// Two spread the cost of the gathering over more particles. More would add candidates that are near to few.
const CELLS_PER_GROUP: u32 = 2;

/// A row that repeats another row in a neighboring box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ghost {
    /// The row of the ghost.
    pub row: u32,
    /// The row that the ghost repeats.
    pub source: u32,
    /// The number of boxes that the ghost is shifted by along each axis.
    pub shift: [i8; 3],
}

/// Particles sorted into rows by cell, in ascending order of x, then y, then z, with ghosts among them.
///
/// *Slots* 0..N number the particles in sorted order. *Rows* number slots and ghosts together.
/// The table is a pure function of the positions: it depends on no thread count and on no history.
#[derive(Debug, Clone, Default)]
pub struct RowTable {
    /// The particle at each slot, `[N]`.
    pub particle: Vec<u32>,
    /// The row of each slot, `[N]`, ascending.
    pub row: Vec<u32>,
    /// The image of each slot: boxes between the unwrapped position and the home box, `[N]`.
    pub image: Vec<IVec3>,
    /// The ghosts, in ascending order of their rows.
    pub ghosts: Vec<Ghost>,
    /// The slot that each row shows, `[rows]` and padding.
    slot: Vec<u32>,
    /// Coordinates of the rows in single precision, for the search.
    pub(crate) coordinates: RowCoordinates,
    grid: CellGrid,
    sort: CellSort,
    /// The extended cell of each slot, `[N]`.
    cell_of_slot: Vec<u32>,
    /// Scratch: the folded position of each slot, `[N]`, σ.
    wrapped: Vec<DVec3>,
}

impl RowTable {
    /// Number of rows, ghosts included.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.slot.len().saturating_sub(PADDING)
    }

    /// The slot that each row shows, `[rows]`.
    #[must_use]
    pub fn slots(&self) -> &[u32] {
        &self.slot[..self.rows()]
    }

    /// [`RowTable::slots`] and [`PADDING`] more elements.
    pub(crate) fn padded_slots(&self) -> &[u32] {
        &self.slot
    }

    /// Number of bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let n = self.particle.capacity();
        let rows = self.slot.capacity();
        n * (4 + 4 + 12 + 4 + size_of::<DVec3>())
            + rows * (4 + 12)
            + self.ghosts.capacity() * size_of::<Ghost>()
            + self.grid.first_row.capacity() * 4
            + self.sort.bytes()
    }

    /// The index, in the order that was given to the sort, of the position that belongs to each slot, `[N]`.
    #[must_use]
    pub fn source(&self) -> &[u32] {
        &self.sort.source
    }

    /// Sorts positions in a box for a search within `radius` σ, and places all particles.
    ///
    /// # Errors
    /// As [`RowTable::order`].
    pub fn sort(
        &mut self,
        cell: &PeriodicBox,
        positions: Positions<'_>,
        radius: f64,
    ) -> Result<(), GridError> {
        self.order(cell, positions, radius)?;
        self.place_all(cell, positions);
        self.show(cell);
        Ok(())
    }

    /// Gives the particles their slots and rows. Coordinates follow by [`RowTable::place`] and [`RowTable::show`].
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position is not a usable number; the table is then unusable.
    pub fn order(
        &mut self,
        cell: &PeriodicBox,
        positions: Positions<'_>,
        radius: f64,
    ) -> Result<(), GridError> {
        let (values, known) = (positions.values(), positions.known());
        let n = values.len();
        let lengths = cell.lengths();
        self.grid.choose(lengths, n, radius);
        let [nx, ny, nz] = self.grid.inner;
        let inv_edge = DVec3::new(nx as f64, ny as f64, nz as f64) / lengths;
        let far = lengths * FARTHEST_IMAGE;
        let bad = AtomicBool::new(false);
        self.sort.home.resize(n, 0);
        let own = &values[known.clone()];
        for_each_piece(&mut self.sort.home[known.clone()], |first, chunk| {
            let mut usable = true;
            for (home, r) in chunk.iter_mut().zip(&own[first..]) {
                // The comparison is false for NaN.
                usable &= r.abs().cmple(far).all();
                let scaled = fold(*r, lengths).0 * inv_edge;
                let x = (scaled.x as u32).min(nx as u32 - 1);
                let y = (scaled.y as u32).min(ny as u32 - 1);
                let z = (scaled.z as u32).min(nz as u32 - 1);
                *home = (x * ny as u32 + y) * nz as u32 + z;
            }
            if !usable {
                bad.store(true, Ordering::Relaxed);
            }
        });
        let is_bad = |k: &usize| !values[*k].abs().cmple(far).all();
        let bad = (bad.into_inner()).then(|| known.clone().find(is_bad));
        if let (Some(bad), _) = positions.agree(bad.flatten(), false) {
            let particle = positions.particle(bad, &self.particle);
            return Err(GridError::BadPosition { particle });
        }
        positions.make_numbers_known(&mut self.sort.home);
        self.sort.sort(nx * ny * nz, &mut self.particle, positions);
        self.number_rows();
        self.fill_slots();
        self.fill_rows();
        Ok(())
    }

    /// Places all particles of the last order, whose positions are known.
    pub(crate) fn place_all(&mut self, cell: &PeriodicBox, positions: Positions<'_>) {
        let source = std::mem::take(&mut self.sort.source);
        let all = 0..source.len();
        self.place(cell, slice::from_ref(&all), positions.by_slot(&source));
        self.sort.source = source;
    }

    /// Folds the particles at some runs of slots into the box, where `at` gives the position at a slot, σ.
    pub fn place(
        &mut self,
        cell: &PeriodicBox,
        runs: &[Range<usize>],
        at: impl Fn(usize) -> DVec3 + Sync,
    ) {
        let (n, lengths) = (self.particle.len(), cell.lengths());
        self.image.resize(n, IVec3::ZERO);
        self.wrapped.resize(n, DVec3::ZERO);
        for run in runs {
            let images = &mut self.image[run.clone()];
            let wrapped = &mut self.wrapped[run.clone()];
            for_each_piece_pair(images, wrapped, |first, images, wrapped| {
                for (k, (image, wrapped)) in images.iter_mut().zip(wrapped).enumerate() {
                    (*wrapped, *image) = fold(at(run.start + first + k), lengths);
                }
            });
        }
    }

    /// Numbers the rows of the extended grid, ghosts included.
    fn number_rows(&mut self) {
        let grid = &self.grid;
        let first_slot = &self.sort.first;
        let axes = [0, 1, 2].map(|a| grid.axis(a));
        let mut first_row = Vec::with_capacity(grid.first_row.len());
        let mut rows = 0;
        for (hx, _) in &axes[0] {
            for (hy, _) in &axes[1] {
                for (hz, _) in &axes[2] {
                    let home = grid.home_index(*hx, *hy, *hz);
                    first_row.push(rows);
                    rows += first_slot[home + 1] - first_slot[home];
                }
            }
        }
        first_row.push(rows);
        self.grid.first_row = first_row;
        self.slot.resize(rows as usize + PADDING, 0);
        self.coordinates.resize(rows as usize);
    }

    /// Fills the arrays with one element per slot that need no positions.
    fn fill_slots(&mut self) {
        let n = self.particle.len();
        self.row.resize(n, 0);
        self.cell_of_slot.resize(n, 0);
        let (grid, first_slot) = (&self.grid, &self.sort.first);
        let [nx, ny, nz] = grid.inner;
        let [_, ey, ez] = grid.extended();
        let [lx, ly, lz] = grid.layers;
        let begin = |x: usize| first_slot[grid.home_index(x, 0, 0)] as usize;
        let lengths = || (0..nx).map(|x| begin(x + 1) - begin(x));
        let [rows, cells] = [&mut self.row, &mut self.cell_of_slot].map(|a| cut(a, lengths()));
        let layers = rows.into_iter().zip(cells);
        for_each_item(layers, |(): &mut (), x, (rows, cells)| {
            let (mut rows, mut cells) = (rows.iter_mut(), cells.iter_mut());
            for y in 0..ny {
                let home = grid.home_index(x, y, 0);
                let extended = ((x + lx) * ey + y + ly) * ez + lz;
                let first_slot = &first_slot[home..=home + nz];
                // Slots of a column have consecutive rows.
                let slots = first_slot[0]..first_slot[nz];
                for (row, to) in (grid.first_row[extended]..).zip(rows.by_ref().take(slots.len())) {
                    *to = row;
                }
                for (cell, ends) in (extended as u32..).zip(first_slot.windows(2)) {
                    let of_cell = cells.by_ref().take((ends[1] - ends[0]) as usize);
                    of_cell.for_each(|to| *to = cell);
                }
            }
        });
    }

    /// Numbers the slots that rows show, and finds the ghosts.
    fn fill_rows(&mut self) {
        let layers = Layers::of(&self.grid, &self.sort.first);
        let own_rows = &self.row;
        let fill = |x: usize, slots: &mut [u32]| {
            let mut ghosts = Vec::new();
            let mut row = layers.rows(x).start as u32;
            let mut to = slots.iter_mut();
            layers.for_each_run(x, |slots, shift| {
                for (slot, to) in slots.clone().zip(&mut to) {
                    *to = slot;
                }
                let rows = row..row + slots.len() as u32;
                row = rows.end;
                if shift != [0; 3] {
                    let sources = &own_rows[slots.start as usize..slots.end as usize];
                    let ghost = |(row, source): (u32, &u32)| Ghost { row, source: *source, shift };
                    ghosts.extend(rows.zip(sources).map(ghost));
                }
            });
            ghosts
        };
        let parts = layers.cut(&mut self.slot);
        self.ghosts.clear();
        for mut part in map_items(parts.into_iter(), |(), x, slots| fill(x, slots)) {
            self.ghosts.append(&mut part);
        }
    }

    /// Fills the coordinates of the rows. They have no meaning for particles that are not placed.
    pub fn show(&mut self, cell: &PeriodicBox) {
        let layers = Layers::of(&self.grid, &self.sort.first);
        let (lengths, wrapped) = (cell.lengths(), &self.wrapped);
        let RowCoordinates { x, y, z } = &mut self.coordinates;
        let [x, y, z] = [x, y, z].map(|axis| layers.cut(axis));
        let parts = x.into_iter().zip(y).zip(z);
        for_each_item(parts, |(): &mut (), layer, ((x, y), z)| {
            let mut to = x.iter_mut().zip(y).zip(z);
            layers.for_each_run(layer, |slots, shift| {
                let offset = IVec3::from(shift.map(i32::from)).as_dvec3() * lengths;
                let wrapped = &wrapped[slots.start as usize..slots.end as usize];
                for (wrapped, ((x, y), z)) in wrapped.iter().zip(&mut to) {
                    let r = *wrapped + offset;
                    [*x, *y, *z] = r.to_array().map(|r| r as f32);
                }
            });
        });
    }

    /// A range of rows that contains all neighbors of the particles at `slots`, and these particles themselves.
    pub(crate) fn rows_near(&self, slots: &Range<usize>) -> Range<u32> {
        if slots.is_empty() {
            return 0..0;
        }
        let cell = |slot: usize| self.cell_of_slot[slot];
        self.grid.rows_near([cell(slots.start), cell(slots.end - 1)])
    }

    /// The end of the group of slots that begins with `first` and shares one gathering of candidates.
    ///
    /// A group has the slots, before `end`, of up to [`CELLS_PER_GROUP`] consecutive cells of a column.
    pub(crate) fn group_end(&self, first: usize, end: usize) -> usize {
        let cells = &self.cell_of_slot[first..end];
        let beyond = cells[0] + CELLS_PER_GROUP;
        first + cells.iter().take_while(|c| **c < beyond).count()
    }

    /// Writes to `runs` the rows of all cells within the search radius of the slots from `first` to `last`, which
    /// belong to one group.
    pub(crate) fn runs_near(&self, first: usize, last: usize, runs: &mut Vec<Range<u32>>) {
        let ends = [first, last].map(|slot| self.cell_of_slot[slot]);
        self.grid.runs_near(ends, runs);
    }

    /// The margin that is added to the search radius, so that rounding to single precision hides no pair, σ.
    pub(crate) fn search_margin(&self) -> f64 {
        // Two coordinates on three axes are each off by half a unit in the last place of the extent.
        // The distance itself is rounded a few times. Eight units in the last place cover all of it.
        8.0 * self.grid.extent() * f64::from(f32::EPSILON)
    }
}

impl Cells for RowTable {
    fn count(&self) -> [u32; 3] {
        self.grid.inner.map(|count| count as u32)
    }

    fn across(&self, slot: usize, _r: DVec3, _lengths: DVec3) -> [f64; 2] {
        let at = self.wrapped[slot] / self.grid.edge;
        [at.x, at.y]
    }

    #[inline(always)]
    fn slots(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32> {
        let home = |z: u32| self.grid.home_index(x as usize, y as usize, z as usize);
        let first = &self.sort.first;
        first[home(z[0])]..first[home(z[1]) + 1]
    }
}
