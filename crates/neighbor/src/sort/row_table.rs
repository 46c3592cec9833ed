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

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::for_each_piece_pair;
use lennard_core::tasks::{for_each_item, map_items};

use crate::chunk_slots::{ChunkSlots, SMALLEST_CUT};
use crate::sort::cell_sort::{CellSort, cut};
use crate::sort::coordinates::{FARTHEST_IMAGE, PADDING, RowCoordinates, fold};
use crate::sort::parts::{Belongs, Columns, Present};
use crate::sort::positions::{GridError, Positions};

/// Number of consecutive cells of a column that share one gathering of candidates.
///
/// Two spread the cost of the gathering over more particles. More would add candidates that are near to few.
const CELLS_PER_GROUP: u32 = 2;

/// Number of columns of cells along y in a bundle, where the box is more than one bundle.
const COLUMNS_PER_BUNDLE: usize = 8;

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
    /// The columns that the table has.
    present: Present,
    sort: CellSort,
    /// The slots of each chunk.
    pub(crate) chunks: ChunkSlots,
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

    /// Number of particles of the whole system.
    #[must_use]
    pub(crate) fn whole(&self) -> usize {
        self.present.whole(self.particle.len())
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
            + self.chunks.bytes()
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
        let lengths = cell.lengths();
        self.grid.choose(lengths, self.present.whole(positions.values().len()), radius);
        let [nx, ny, nz] = self.grid.inner;
        let inv_edge = DVec3::new(nx as f64, ny as f64, nz as f64) / lengths;
        let far = lengths * FARTHEST_IMAGE;
        let present = &self.present;
        let cell_of = |r: DVec3| {
            let scaled = fold(r, lengths).0 * inv_edge;
            let column = part(scaled.x, nx) * ny + part(scaled.y, ny);
            let place = present.place(column as u32);
            let place = place.expect("a particle lies in a column of the table") as usize;
            place * nz + part(scaled.z, nz)
        };
        let cells = present.count((nx * ny) as u32) as usize * nz;
        self.sort.order(cells, &mut self.particle, positions, [far; 2], cell_of)?;
        self.cut_chunks();
        self.number_rows();
        self.fill_slots();
        self.fill_rows();
        Ok(())
    }

    /// Places all particles of the last order, whose positions are known.
    pub(crate) fn place_all(&mut self, cell: &PeriodicBox, positions: Positions<'_>) {
        let source = std::mem::take(&mut self.sort.source);
        self.place(cell, positions.by_slot(&source));
        self.sort.source = source;
    }

    /// Folds the particles into the box, where `at` gives the position at a slot, σ.
    pub fn place(&mut self, cell: &PeriodicBox, at: impl Fn(usize) -> DVec3 + Sync) {
        let (n, lengths) = (self.particle.len(), cell.lengths());
        self.image.resize(n, IVec3::ZERO);
        self.wrapped.resize(n, DVec3::ZERO);
        for_each_piece_pair(&mut self.image, &mut self.wrapped, |first, images, wrapped| {
            for (k, (image, wrapped)) in images.iter_mut().zip(wrapped).enumerate() {
                (*wrapped, *image) = fold(at(first + k), lengths);
            }
        });
    }

    /// Begins a part of `whole` particles in a box, for a search within `radius` σ: chooses the grid.
    pub(crate) fn begin_part(&mut self, cell: &PeriodicBox, whole: usize, radius: f64) -> Columns {
        self.present.begin(whole);
        self.grid.choose(cell.lengths(), whole, radius);
        let [nx, ny, _] = self.grid.inner;
        let ends = (0..ny).step_by(COLUMNS_PER_BUNDLE).chain([ny]).map(|y| y as u32).collect();
        Columns { count: [nx as u32, ny as u32], ends, lengths: cell.lengths() }
    }

    /// The column of a position in a box, in the grid that was chosen last.
    pub(crate) fn column_at(&self, cell: &PeriodicBox, r: DVec3) -> [u32; 2] {
        let [nx, ny, nz] = self.grid.inner;
        let inv_edge = DVec3::new(nx as f64, ny as f64, nz as f64) / cell.lengths();
        let scaled = fold(r, cell.lengths()).0 * inv_edge;
        [part(scaled.x, nx) as u32, part(scaled.y, ny) as u32]
    }

    /// Goes on with a part: takes its columns, and the number of each particle that will be sorted.
    pub(crate) fn take_part(&mut self, belongs: impl Fn([u32; 2]) -> Belongs, numbers: &[u32]) {
        let [nx, ny, _] = self.grid.inner;
        let all = (0..nx as u32).flat_map(|x| (0..ny as u32).map(move |y| [x, y]));
        let of_column: Vec<Belongs> = all.map(belongs).collect();
        self.present.take(&of_column, &self.grid.bundles(COLUMNS_PER_BUNDLE));
        self.particle.clear();
        self.particle.extend_from_slice(numbers);
    }

    /// Cuts the slots of each bundle, a few columns side by side, into chunks.
    fn cut_chunks(&mut self) {
        let (n, grid) = (self.particle.len(), &self.grid);
        let [nx, ny, nz] = grid.inner;
        let bundles = self.present.bundles(|| match n < SMALLEST_CUT {
            true => vec![0, (nx * ny) as u32],
            false => grid.bundles(COLUMNS_PER_BUNDLE),
        });
        self.chunks.cut(bundles.into_iter().map(|place| self.sort.first[place as usize * nz]));
    }

    /// Numbers the rows of the extended grid, ghosts included.
    fn number_rows(&mut self) {
        let homes = Homes { grid: &self.grid, present: &self.present, first: &self.sort.first };
        let axes = [0, 1, 2].map(|a| self.grid.axis(a));
        let mut first_row = Vec::with_capacity(self.grid.first_row.len());
        let mut rows = 0;
        for (hx, _) in &axes[0] {
            for (hy, _) in &axes[1] {
                let first = homes.column(*hx, *hy);
                for (hz, _) in &axes[2] {
                    first_row.push(rows);
                    rows += first.map_or(0, |first| first[hz + 1] - first[*hz]);
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
        let columns = self.present.count((nx * ny) as u32) as usize;
        let columns_of = |part: usize| part * ny..columns.min((part + 1) * ny);
        let parts = columns.div_ceil(ny);
        let lengths = || {
            (0..parts).map(|part| {
                let columns = columns_of(part);
                (first_slot[columns.end * nz] - first_slot[columns.start * nz]) as usize
            })
        };
        let [rows, cells] = [&mut self.row, &mut self.cell_of_slot].map(|a| cut(a, lengths()));
        let present = &self.present;
        for_each_item(rows.into_iter().zip(cells), |(): &mut (), part, (rows, cells)| {
            let (mut rows, mut cells) = (rows.iter_mut(), cells.iter_mut());
            for place in columns_of(part) {
                let column = present.column(place) as usize;
                let (x, y) = (column / ny, column % ny);
                let extended = ((x + lx) * ey + y + ly) * ez + lz;
                let first_slot = &first_slot[place * nz..=(place + 1) * nz];
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
        let layers =
            Layers::of(Homes { grid: &self.grid, present: &self.present, first: &self.sort.first });
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
        let layers =
            Layers::of(Homes { grid: &self.grid, present: &self.present, first: &self.sort.first });
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

/// What [`super::Cells`] asks for.
impl RowTable {
    pub(super) fn count(&self) -> [u32; 3] {
        self.grid.inner.map(|count| count as u32)
    }

    #[inline(always)]
    pub(super) fn slots_between(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32> {
        let homes = Homes { grid: &self.grid, present: &self.present, first: &self.sort.first };
        let first = homes.column(x as usize, y as usize);
        first.map_or(0..0, |first| first[z[0] as usize]..first[z[1] as usize + 1])
    }
}

/// The part of an axis, one of `parts` equal parts, that contains a scaled coordinate. A conversion to 32 bits is one instruction.
#[inline(always)]
fn part(scaled: f64, parts: usize) -> usize {
    (scaled as u32).min(parts as u32 - 1) as usize
}

/// The slots of the home cells.
#[derive(Clone, Copy)]
struct Homes<'a> {
    grid: &'a CellGrid,
    present: &'a Present,
    /// The first slot of each cell, column by column, and the end.
    first: &'a [u32],
}

impl<'a> Homes<'a> {
    /// The first slot of each cell of a column, and the end; `None` where the table does not have it.
    #[inline(always)]
    fn column(self, x: usize, y: usize) -> Option<&'a [u32]> {
        let [_, ny, nz] = self.grid.inner;
        let place = self.present.place((x * ny + y) as u32)? as usize;
        Some(&self.first[place * nz..=(place + 1) * nz])
    }
}

// The grid of cells that a row table is sorted by, with layers of ghost cells around the box.
//
// ```text
//   extended grid, seen along z (2 layers of ghost cells on each side):
//
//      g g g g g g g g      g: ghost cell, an image of a home cell
//      g g g g g g g g      h: home cell, inside the box
//      g g h h h h g g
//      g g h h h h g g      A search looks at neighboring cells by adding offsets.
//      g g h h h h g g      It needs no test for the faces of the box.
//      g g g g g g g g
//      g g g g g g g g
// ```

/// Number of cells per search radius along an axis. Two waste less volume than one, and they cost more cells.
const CELLS_PER_RADIUS: f64 = 2.0;
/// Below this many particles per cell, larger cells are cheaper to walk.
const SPARSE_CELL: f64 = 1.0;
/// Largest number of cells per particle, above [`SMALLEST_GRID`]. A droplet in a vacuum must not cost the vacuum.
const CELLS_PER_PARTICLE: usize = 4;
/// Number of cells that every grid may have.
const SMALLEST_GRID: usize = 512;

/// A column of cells along z, beside a cell.
#[derive(Debug, Clone, Copy)]
struct NearColumn {
    /// The extended cell of the column at the same height, minus the cell itself.
    offset: i64,
    /// The number of cells up and down that lie within the search radius.
    reach: i64,
}

/// The extended grid and the first row of each of its cells.
#[derive(Debug, Clone, Default)]
pub(super) struct CellGrid {
    /// Number of home cells along each axis.
    pub inner: [usize; 3],
    /// Number of layers of ghost cells on each side.
    pub layers: [usize; 3],
    /// Cell edges, σ.
    pub edge: DVec3,
    /// The first row of each cell of the extended grid, and the end, `[cells + 1]`.
    pub first_row: Vec<u32>,
    /// The columns of cells around each cell, in ascending order of their rows.
    columns: Vec<NearColumn>,
}

impl CellGrid {
    /// Chooses the grid for a box, a number of particles and a search radius.
    pub fn choose(&mut self, lengths: DVec3, n: usize, radius: f64) {
        let density = n as f64 / lengths.element_product();
        let small = radius / CELLS_PER_RADIUS;
        let mut edge = if density * small.powi(3) < SPARSE_CELL { radius } else { small };
        let most = (CELLS_PER_PARTICLE * n).max(SMALLEST_GRID) as f64;
        let cells = (lengths / edge).floor().max(DVec3::ONE);
        if cells.element_product() > most {
            edge = edge.max((lengths.element_product() / most).cbrt());
            // A long thin box still has one cell across it.
            while (lengths / edge).floor().max(DVec3::ONE).element_product() > 2.0 * most {
                edge *= 1.26;
            }
        }
        for axis in 0..3 {
            let inner = (lengths[axis] / edge).floor().max(1.0);
            self.inner[axis] = inner as usize;
            self.edge[axis] = lengths[axis] / inner;
            // Without the factor, rounding could ask for a third layer where the radius is exactly two edges.
            self.layers[axis] = (radius / self.edge[axis] * (1.0 - 1e-12)).ceil().max(1.0) as usize;
        }
        self.find_columns(radius);
    }

    /// Number of cells along each axis, ghost cells included.
    pub fn extended(&self) -> [usize; 3] {
        [0, 1, 2].map(|a| self.inner[a] + 2 * self.layers[a])
    }

    /// The first column of each bundle of columns of a layer, and the end of all.
    fn bundles(&self, width: usize) -> Vec<u32> {
        let [nx, ny, _] = self.inner;
        let first = (0..nx).flat_map(|x| (0..ny).step_by(width).map(move |y| x * ny + y));
        first.chain([nx * ny]).map(|column| column as u32).collect()
    }

    /// The home cell and the box of each extended cell along an axis.
    pub fn axis(&self, axis: usize) -> Vec<(usize, i8)> {
        let inner = self.inner[axis] as i64;
        let layers = self.layers[axis] as i64;
        (-layers..inner + layers)
            .map(|c| (c.rem_euclid(inner) as usize, c.div_euclid(inner) as i8))
            .collect()
    }

    /// The longest side of the extended grid, σ.
    pub fn extent(&self) -> f64 {
        (0..3)
            .map(|a| (self.inner[a] + 2 * self.layers[a]) as f64 * self.edge[a])
            .fold(0.0, f64::max)
    }

    /// Lists the columns of cells that lie within `radius` of a cell, in ascending order of their rows.
    fn find_columns(&mut self, radius: f64) {
        let [_, ey, ez] = self.extended().map(|e| e as i64);
        let layers = self.layers.map(|l| l as i64);
        // Rounding may put a particle just outside its cell. Distances are therefore made a little shorter.
        let gap =
            |axis: usize, k: i64| (k.abs() - 1).max(0) as f64 * self.edge[axis] * (1.0 - 1e-5);
        let mut columns = Vec::new();
        for x in -layers[0]..=layers[0] {
            for y in -layers[1]..=layers[1] {
                let left2 = radius * radius - gap(0, x).powi(2) - gap(1, y).powi(2);
                if left2 >= 0.0 {
                    let reach = (left2.sqrt() / self.edge[2] * (1.0 + 1e-5)).ceil() as i64;
                    columns.push(NearColumn {
                        offset: (x * ey + y) * ez,
                        reach: reach.clamp(1, layers[2]),
                    });
                }
            }
        }
        self.columns = columns;
    }

    /// Writes to `runs` the rows of all cells within the search radius of the extended cells from `low` to `high`,
    /// which belong to one column.
    pub fn runs_near(&self, [low, high]: [u32; 2], runs: &mut Vec<Range<u32>>) {
        runs.clear();
        for column in &self.columns {
            // Layers of ghost cells surround the box, so these cells exist.
            let from = (i64::from(low) + column.offset - column.reach) as usize;
            let to = (i64::from(high) + column.offset + column.reach) as usize;
            let run = self.first_row[from]..self.first_row[to + 1];
            if !run.is_empty() {
                runs.push(run);
            }
        }
    }

    /// A range of rows that contains all rows within the search radius of the extended cells from `first` to `last`.
    pub fn rows_near(&self, [first, last]: [u32; 2]) -> Range<u32> {
        let [_, ey, ez] = self.extended();
        let [lx, ly, lz] = self.layers;
        // Cells ascend with slots, and rows ascend with cells.
        let reach = (lx * ey + ly) * ez + lz;
        let (first, last) = (first as usize - reach, last as usize + reach);
        self.first_row[first]..self.first_row[last + 1]
    }
}

// The layers of a row table along x, which its tasks fill one by one.

/// The layers of cells of the extended grid along x.
struct Layers<'a> {
    homes: Homes<'a>,
    /// The home cell and the box of each extended cell along each axis.
    axes: [Vec<(usize, i8)>; 3],
}

impl<'a> Layers<'a> {
    fn of(homes: Homes<'a>) -> Self {
        Self { homes, axes: [0, 1, 2].map(|axis| homes.grid.axis(axis)) }
    }

    /// The rows of a layer.
    pub fn rows(&self, x: usize) -> Range<usize> {
        let grid = self.homes.grid;
        let [_, ey, ez] = grid.extended();
        let first_row = |x: usize| grid.first_row[x * ey * ez] as usize;
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
            let Some(first_slot) = self.homes.column(hx, *hy) else { continue };
            // Slots ascend along z, but for the faces of the box.
            for run in self.axes[2].chunk_by(|(_, a), (_, b)| a == b) {
                let (first, sz) = run[0];
                visit(first_slot[first]..first_slot[first + run.len()], [sx, *sy, sz]);
            }
        }
    }
}
