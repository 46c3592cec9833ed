//! The cell grid: particles sorted in space into rows, with their periodic images as ghost rows.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::tasks::map_items;

use crate::counting::{Given, Standing};
use crate::missing::Cells;
use crate::scan::{Candidates, PADDING};

/// Cells an axis across the search radius. Two waste less volume than one, and cost more cells.
const CELLS_PER_RADIUS: f64 = 2.0;
/// Below this many particles a cell, larger cells are cheaper to walk.
const SPARSE_CELL: f64 = 1.0;
/// Never more cells than this many for each particle (and [`SMALLEST_GRID`]): a cluster in a vacuum
/// must not cost the vacuum.
const CELLS_PER_PARTICLE: usize = 4;
/// Consecutive cells of a column that share one gathering of candidates: two spread its cost over more
/// particles, and more of them would add candidates that are near to few.
const CELLS_PER_GROUP: u32 = 2;
/// Cells that any grid may have.
const SMALLEST_GRID: usize = 512;
/// Boxes away from home up to which image flags are counted; a coordinate beyond has lost its digits.
pub(crate) const FARTHEST_IMAGE: f64 = 1_073_741_824.0;

/// Why particles cannot be sorted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// A coordinate is not finite, or so far away that nothing of its place in the box is left.
    #[error("the position of particle {particle} is not a usable number")]
    BadPosition {
        /// Index of the particle, from 0.
        particle: usize,
    },
}

/// A row that repeats another one in a neighboring box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ghost {
    /// The ghost's own row.
    pub row: u32,
    /// The row that it repeats.
    pub source: u32,
    /// By how many boxes it is shifted along each axis.
    pub shift: [i8; 3],
}

/// Particles sorted into rows by cell, in ascending order of x, then y, then z, ghosts among them.
///
/// *Places* 0..N number the particles in sorted order; *rows* number places and ghosts together.
/// It is a pure function of the positions: the same for any number of threads and any history.
#[derive(Debug, Clone, Default)]
pub struct RowTable {
    /// The particle at each place, `[N]`.
    pub particle: Vec<u32>,
    /// The row of each place, `[N]`, ascending.
    pub row: Vec<u32>,
    /// The image of each place: boxes between the unwrapped position and the home box, `[N]`.
    pub image: Vec<IVec3>,
    /// The ghosts, in ascending order of their rows.
    pub ghosts: Vec<Ghost>,
    /// The place that each row shows, itself or as a ghost, `[rows]` and padding.
    place: Vec<u32>,
    /// Rows in single precision, for the search.
    pub(crate) candidates: Candidates,
    pub(crate) cells: CellRows,
}

/// A column of cells along z beside a cell.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// The extended cell of the column at the same height, less the cell itself.
    offset: i64,
    /// How many cells up and down come within the search radius.
    reach: i64,
}

/// Where the rows of each cell begin.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellRows {
    /// Cells an axis inside the box.
    inner: [usize; 3],
    /// Layers of ghost cells on each side.
    layers: [usize; 3],
    /// Cell edges, σ.
    edge: DVec3,
    /// Who stands in each home cell.
    standing: Standing,
    /// First row of each cell of the extended grid, and the end, `[cells + 1]`.
    first_row: Vec<u32>,
    /// The extended cell of each place, `[N]`.
    cell_of_place: Vec<u32>,
    /// The columns of cells around each cell.
    columns: Vec<Column>,
    /// Scratch: folded position of each place.
    wrapped: Vec<DVec3>,
}

impl RowTable {
    /// Number of rows, ghosts included.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.place.len().saturating_sub(PADDING)
    }

    /// The place that each row shows, itself or as a ghost, `[rows]`.
    #[must_use]
    pub fn places(&self) -> &[u32] {
        &self.place[..self.rows()]
    }

    /// [`RowTable::places`] with [`PADDING`] elements more.
    pub(crate) fn padded_places(&self) -> &[u32] {
        &self.place
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let n = self.particle.capacity();
        let rows = self.place.capacity();
        n * (4 + 4 + 12 + 4 + size_of::<DVec3>())
            + rows * (4 + 12)
            + self.ghosts.capacity() * size_of::<Ghost>()
            + self.cells.first_row.capacity() * 4
            + self.cells.standing.bytes()
    }

    /// Which of the positions that were sorted stands at each place, `[N]`.
    #[must_use]
    pub fn from(&self) -> &[u32] {
        &self.cells.standing.from
    }

    /// Sorts positions for a search within `radius` σ.
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position cannot be placed; the table is then unusable.
    pub fn sort(
        &mut self,
        cell: &PeriodicBox,
        given: Given<'_>,
        radius: f64,
    ) -> Result<(), GridError> {
        let positions = given.positions();
        let n = positions.len();
        let lengths = cell.lengths();
        self.cells.choose(lengths, n, radius);
        self.cells.find_columns(radius);
        let [nx, ny, nz] = self.cells.inner;
        let inv_edge = DVec3::new(nx as f64, ny as f64, nz as f64) / lengths;

        let cells = &mut self.cells;
        let far = lengths * FARTHEST_IMAGE;
        let bad = AtomicBool::new(false);
        cells.standing.home.resize(n, 0);
        for_each_piece(&mut cells.standing.home, |first, chunk| {
            let mut usable = true;
            for (home, r) in chunk.iter_mut().zip(&positions[first..]) {
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
        if bad.into_inner()
            && let Some(bad) = positions.iter().position(|r| !r.abs().cmple(far).all())
        {
            let particle = given.particle_of(bad, &self.particle);
            return Err(GridError::BadPosition { particle });
        }
        cells.standing.sort(nx * ny * nz, &mut self.particle, given);
        self.number_rows();
        self.place_particles(positions, lengths);
        self.fill_rows(lengths);
        Ok(())
    }

    /// Numbers the rows of the extended grid, ghosts included.
    fn number_rows(&mut self) {
        let cells = &mut self.cells;
        let axes = [0, 1, 2].map(|a| cells.axis(a));
        let mut first_row = std::mem::take(&mut cells.first_row);
        first_row.clear();
        let mut rows = 0;
        for (hx, _) in &axes[0] {
            for (hy, _) in &axes[1] {
                for (hz, _) in &axes[2] {
                    let home = cells.home_index(*hx, *hy, *hz);
                    first_row.push(rows);
                    rows += cells.standing.first[home + 1] - cells.standing.first[home];
                }
            }
        }
        first_row.push(rows);
        cells.first_row = first_row;
        self.place.resize(rows as usize + PADDING, 0);
        self.candidates.resize(rows as usize);
    }

    /// Fills everything that goes by place.
    fn place_particles(&mut self, positions: &[DVec3], lengths: DVec3) {
        let n = self.particle.len();
        self.row.resize(n, 0);
        self.image.resize(n, IVec3::ZERO);
        let cells = &mut self.cells;
        cells.cell_of_place.resize(n, 0);
        cells.wrapped.resize(n, DVec3::ZERO);
        let [_, ny, nz] = cells.inner;
        let [_, ey, ez] = cells.extended();
        let [lx, ly, lz] = cells.layers;
        let Standing { home, first, from } = &cells.standing;
        let (first_row, first_place) = (&cells.first_row, first);
        for_each_piece_pair(
            &mut self.row,
            &mut cells.cell_of_place,
            |first, rows, cells| {
                for (k, (row, cell)) in rows.iter_mut().zip(cells).enumerate() {
                    let place = first + k;
                    let home = home[from[place] as usize] as usize;
                    let (x, y, z) = (home / (ny * nz), home / nz % ny, home % nz);
                    let extended = ((x + lx) * ey + y + ly) * ez + z + lz;
                    *cell = extended as u32;
                    *row = first_row[extended] + place as u32 - first_place[home];
                }
            },
        );
        for_each_piece_pair(
            &mut self.image,
            &mut cells.wrapped,
            |first, images, wrapped| {
                let all = images.iter_mut().zip(wrapped).zip(&from[first..]);
                for ((image, wrapped), from) in all {
                    (*wrapped, *image) = fold(positions[*from as usize], lengths);
                }
            },
        );
    }

    /// Fills everything that goes by row, one layer of cells after another.
    fn fill_rows(&mut self, lengths: DVec3) {
        let cells = &self.cells;
        let first_place = &cells.standing.first;
        let [_, ey, ez] = cells.extended();
        let axes = [0, 1, 2].map(|a| cells.axis(a));
        let (own_rows, wrapped) = (&self.row, &cells.wrapped);
        let mut rest = (
            self.place.as_mut_slice(),
            self.candidates.x.as_mut_slice(),
            self.candidates.y.as_mut_slice(),
            self.candidates.z.as_mut_slice(),
        );
        let mut layers = Vec::with_capacity(axes[0].len());
        for x in 0..axes[0].len() {
            let first = x * ey * ez;
            let rows = (cells.first_row[first + ey * ez] - cells.first_row[first]) as usize;
            let (place, x_rest) = rest.0.split_at_mut(rows);
            let (cx, cx_rest) = rest.1.split_at_mut(rows);
            let (cy, cy_rest) = rest.2.split_at_mut(rows);
            let (cz, cz_rest) = rest.3.split_at_mut(rows);
            rest = (x_rest, cx_rest, cy_rest, cz_rest);
            layers.push((x, place, cx, cy, cz));
        }
        let fill = |(x, place, cx, cy, cz): Layer<'_>| {
            let mut ghosts = Vec::new();
            let (hx, sx) = axes[0][x];
            let mut row = cells.first_row[x * ey * ez];
            let mut at = 0;
            for (hy, sy) in &axes[1] {
                for (hz, sz) in &axes[2] {
                    let home = cells.home_index(hx, *hy, *hz);
                    let shift = [sx, *sy, *sz];
                    let is_ghost = shift != [0; 3];
                    let offset = IVec3::from(shift.map(i32::from)).as_dvec3() * lengths;
                    for p in first_place[home]..first_place[home + 1] {
                        let r = wrapped[p as usize] + offset;
                        place[at] = p;
                        cx[at] = r.x as f32;
                        cy[at] = r.y as f32;
                        cz[at] = r.z as f32;
                        if is_ghost {
                            let source = own_rows[p as usize];
                            ghosts.push(Ghost { row, source, shift });
                        }
                        at += 1;
                        row += 1;
                    }
                }
            }
            ghosts
        };
        self.ghosts.clear();
        for mut part in map_items(layers.into_iter(), |(), _, layer| fill(layer)) {
            self.ghosts.append(&mut part);
        }
    }

    /// A range of rows that holds all neighbors of some places, and the places themselves.
    pub(crate) fn rows_near(&self, places: &Range<usize>) -> Range<u32> {
        if places.is_empty() {
            return 0..0;
        }
        let cells = &self.cells;
        let [_, ey, ez] = cells.extended();
        let [lx, ly, lz] = cells.layers;
        // Cells ascend with places, and rows with cells.
        let reach = (lx * ey + ly) * ez + lz;
        let first = cells.cell_of_place[places.start] as usize - reach;
        let last = cells.cell_of_place[places.end - 1] as usize + reach;
        cells.first_row[first]..cells.first_row[last + 1]
    }

    /// The end of the group of places that starts with `first` and shares one gathering of candidates:
    /// those of up to [`CELLS_PER_GROUP`] consecutive cells of a column, before `end`.
    pub(crate) fn group_end(&self, first: usize, end: usize) -> usize {
        let cells = &self.cells.cell_of_place[first..end];
        let beyond = cells[0] + CELLS_PER_GROUP;
        first + cells.iter().take_while(|c| **c < beyond).count()
    }

    /// Writes to `runs` the rows of all cells that come within the search radius of the cells of the
    /// places from `first` to `last`, which belong to one group.
    pub(crate) fn runs_near(&self, first: usize, last: usize, runs: &mut Vec<Range<u32>>) {
        let cells = &self.cells;
        let (low, high) = (cells.cell_of_place[first], cells.cell_of_place[last]);
        runs.clear();
        for column in &cells.columns {
            // Layers of ghosts lie around the box, so these cells exist.
            let from = (i64::from(low) + column.offset - column.reach) as usize;
            let to = (i64::from(high) + column.offset + column.reach) as usize;
            let run = cells.first_row[from]..cells.first_row[to + 1];
            if !run.is_empty() {
                runs.push(run);
            }
        }
    }

    /// How far the search radius must be enlarged so that rounding to single precision hides no pair, σ.
    pub(crate) fn search_margin(&self) -> f64 {
        let extent = (0..3)
            .map(|a| (self.cells.inner[a] + 2 * self.cells.layers[a]) as f64 * self.cells.edge[a])
            .fold(0.0, f64::max);
        // Each of two coordinates is off by half a last place of `extent`, on three axes, and the
        // distance is rounded a few times more: eight last places cover it.
        8.0 * extent * f64::from(f32::EPSILON)
    }
}

impl Cells for RowTable {
    fn count(&self) -> [u32; 3] {
        self.cells.inner.map(|count| count as u32)
    }

    #[inline(always)]
    fn places(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32> {
        let home = |z: u32| self.cells.home_index(x as usize, y as usize, z as usize);
        let first = &self.cells.standing.first;
        first[home(z[0])]..first[home(z[1]) + 1]
    }
}

impl CellRows {
    /// Chooses the grid for a box, a number of particles and a search radius.
    fn choose(&mut self, lengths: DVec3, n: usize, radius: f64) {
        let density = n as f64 / lengths.element_product();
        let small = radius / CELLS_PER_RADIUS;
        let mut edge = if density * small.powi(3) < SPARSE_CELL {
            radius
        } else {
            small
        };
        let most = (CELLS_PER_PARTICLE * n).max(SMALLEST_GRID) as f64;
        let cells = (lengths / edge).floor().max(DVec3::ONE);
        if cells.element_product() > most {
            edge = edge.max((lengths.element_product() / most).cbrt());
            // A long thin box still has a cell across it.
            while (lengths / edge).floor().max(DVec3::ONE).element_product() > 2.0 * most {
                edge *= 1.26;
            }
        }
        for axis in 0..3 {
            let inner = (lengths[axis] / edge).floor().max(1.0);
            self.inner[axis] = inner as usize;
            self.edge[axis] = lengths[axis] / inner;
            // The tiny excess keeps a radius that is just twice the edge from asking for a third layer.
            self.layers[axis] = (radius / self.edge[axis] * (1.0 - 1e-12)).ceil().max(1.0) as usize;
        }
    }

    fn extended(&self) -> [usize; 3] {
        [0, 1, 2].map(|a| self.inner[a] + 2 * self.layers[a])
    }

    fn home_index(&self, x: usize, y: usize, z: usize) -> usize {
        (x * self.inner[1] + y) * self.inner[2] + z
    }

    /// For each extended cell along an axis: the home cell that it shows, and the box that it lies in.
    fn axis(&self, axis: usize) -> Vec<(usize, i8)> {
        let inner = self.inner[axis] as i64;
        let layers = self.layers[axis] as i64;
        (-layers..inner + layers)
            .map(|c| (c.rem_euclid(inner) as usize, c.div_euclid(inner) as i8))
            .collect()
    }

    /// Lists the columns of cells that come within `radius` of a cell, in ascending order of their rows.
    fn find_columns(&mut self, radius: f64) {
        let [_, ey, ez] = self.extended().map(|e| e as i64);
        let layers = self.layers.map(|l| l as i64);
        // Rounding may put a particle just outside of its cell: distances count a little less.
        let gap =
            |axis: usize, k: i64| (k.abs() - 1).max(0) as f64 * self.edge[axis] * (1.0 - 1e-5);
        let mut columns = Vec::new();
        for x in -layers[0]..=layers[0] {
            for y in -layers[1]..=layers[1] {
                let left2 = radius * radius - gap(0, x).powi(2) - gap(1, y).powi(2);
                if left2 >= 0.0 {
                    let reach = (left2.sqrt() / self.edge[2] * (1.0 + 1e-5)).ceil() as i64;
                    columns.push(Column {
                        offset: (x * ey + y) * ez,
                        reach: reach.clamp(1, layers[2]),
                    });
                }
            }
        }
        self.columns = columns;
    }
}

/// Rows, places and coordinates of one layer of cells.
type Layer<'a> = (
    usize,
    &'a mut [u32],
    &'a mut [f32],
    &'a mut [f32],
    &'a mut [f32],
);

/// Folded position and image, as [`PeriodicBox::split`] gives them, without a call of `floor`, which
/// costs more than all the rest where the instruction set has none.
#[inline(always)]
pub(crate) fn fold(r: DVec3, lengths: DVec3) -> (DVec3, IVec3) {
    let mut wrapped = r;
    let mut image = IVec3::ZERO;
    for axis in 0..3 {
        let scaled = r[axis] / lengths[axis];
        let truncated = scaled as i32;
        let mut down = truncated.wrapping_sub(i32::from(f64::from(truncated) > scaled));
        let mut w = r[axis] - f64::from(down) * lengths[axis];
        // Rounding can land exactly on either face: −1e-20 folds to L, which belongs to the next image.
        if w >= lengths[axis] {
            w = 0.0;
            down = down.wrapping_add(1);
        } else if w < 0.0 {
            w = 0.0;
        }
        wrapped[axis] = w;
        image[axis] = down;
    }
    (wrapped, image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_is_that_of_the_box() {
        let cell = PeriodicBox::new(DVec3::new(3.0, 7.1, 10.08)).unwrap();
        for k in -4000..4000 {
            let r = DVec3::new(0.75, 1.234_5, 2.52) * f64::from(k) - 1e-20;
            assert_eq!(fold(r, cell.lengths()), cell.split(r));
        }
    }
}
