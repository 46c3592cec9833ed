//! The cell grid: particles sorted in space into rows, with their periodic images as ghost rows.

use std::ops::Range;

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::for_each_chunk;

use crate::scan::Candidates;

/// Cells an axis across the search radius. Two waste less volume than one, and cost more cells.
const CELLS_PER_RADIUS: f64 = 2.0;
/// Below this many particles a cell, larger cells are cheaper to walk.
const SPARSE_CELL: f64 = 1.0;
/// Never more cells than this many for each particle (and [`SMALLEST_GRID`]): a cluster in a vacuum
/// must not cost the vacuum.
const CELLS_PER_PARTICLE: usize = 4;
/// Cells that any grid may have.
const SMALLEST_GRID: usize = 512;
/// Boxes away from home up to which image flags are counted; a coordinate beyond has lost its digits.
const FARTHEST_IMAGE: f64 = 1_073_741_824.0;

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
    /// The place that each row shows, itself or as a ghost, `[rows]`.
    pub place: Vec<u32>,
    /// Rows in single precision, for the search.
    pub(crate) candidates: Candidates,
    pub(crate) cells: CellRows,
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
    /// First row of each cell of the extended grid, and the end, `[cells + 1]`.
    first_row: Vec<u32>,
    /// The extended cell of each place, `[N]`.
    cell_of_place: Vec<u32>,
    /// Scratch: home cell of each particle.
    home: Vec<u32>,
    /// Scratch: wrapped position and image of each particle.
    wrapped: Vec<(DVec3, IVec3)>,
}

impl RowTable {
    /// Number of rows, ghosts included.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.place.len()
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let n = self.particle.capacity();
        let rows = self.place.capacity();
        n * (4 + 4 + 12 + 4 + 4 + size_of::<(DVec3, IVec3)>())
            + rows * (4 + 12)
            + self.ghosts.capacity() * size_of::<Ghost>()
            + self.cells.first_row.capacity() * 4
    }

    /// Sorts `positions` (unwrapped, σ) for a search within `radius` σ.
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position cannot be placed; the table is then unusable.
    pub fn sort(
        &mut self,
        cell: &PeriodicBox,
        positions: &[DVec3],
        radius: f64,
    ) -> Result<(), GridError> {
        let n = positions.len();
        let lengths = cell.lengths();
        self.cells.choose(lengths, n, radius);
        let [nx, ny, nz] = self.cells.inner;
        let inv_edge = DVec3::new(nx as f64, ny as f64, nz as f64) / lengths;

        let cells = &mut self.cells;
        cells.wrapped.resize(n, (DVec3::ZERO, IVec3::ZERO));
        for_each_chunk(&mut cells.wrapped, |first, chunk| {
            for (out, r) in chunk.iter_mut().zip(&positions[first..]) {
                *out = cell.split(*r);
            }
        });
        let far = lengths * FARTHEST_IMAGE;
        // The negated comparison also catches NaN.
        if let Some(particle) = positions.iter().position(|r| !r.abs().cmple(far).all()) {
            return Err(GridError::BadPosition { particle });
        }
        cells.home.resize(n, 0);
        let wrapped = &cells.wrapped;
        for_each_chunk(&mut cells.home, |first, chunk| {
            for (home, (r, _)) in chunk.iter_mut().zip(&wrapped[first..]) {
                let scaled = *r * inv_edge;
                let x = (scaled.x as usize).min(nx - 1);
                let y = (scaled.y as usize).min(ny - 1);
                let z = (scaled.z as usize).min(nz - 1);
                *home = ((x * ny + y) * nz + z) as u32;
            }
        });

        self.sort_by_home_cell(n);
        self.lay_out_rows(lengths);
        Ok(())
    }

    /// Counting sort by home cell, stable by particle number: fills `particle`, and leaves the first
    /// place of each home cell in `cells.home` no longer needed afterwards.
    fn sort_by_home_cell(&mut self, n: usize) {
        let cells = &mut self.cells;
        let count: usize = cells.inner.iter().product();
        let mut first = vec![0_u32; count + 1];
        for home in &cells.home {
            first[*home as usize + 1] += 1;
        }
        for c in 0..count {
            first[c + 1] += first[c];
        }
        let mut next = first.clone();
        self.particle.resize(n, 0);
        for (particle, home) in cells.home.iter().enumerate() {
            let place = &mut next[*home as usize];
            self.particle[*place as usize] = particle as u32;
            *place += 1;
        }
        cells.first_row = first;
    }

    /// Numbers the rows of the extended grid, ghosts included.
    fn lay_out_rows(&mut self, lengths: DVec3) {
        let n = self.particle.len();
        let cells = &mut self.cells;
        let first_place = std::mem::take(&mut cells.first_row);
        let [ex, ey, ez] = cells.extended();
        let mut first_row = Vec::with_capacity(ex * ey * ez + 1);
        let mut rows = 0;
        let axes = [0, 1, 2].map(|a| cells.axis(a));
        for (hx, _) in &axes[0] {
            for (hy, _) in &axes[1] {
                for (hz, _) in &axes[2] {
                    let home = cells.home_index(*hx, *hy, *hz);
                    first_row.push(rows);
                    rows += first_place[home + 1] - first_place[home];
                }
            }
        }
        first_row.push(rows);
        let rows = rows as usize;

        self.row.resize(n, 0);
        self.image.resize(n, IVec3::ZERO);
        cells.cell_of_place.resize(n, 0);
        self.place.resize(rows, 0);
        self.candidates.resize(rows);
        self.ghosts.clear();

        // Rows of home cells first: ghosts refer to them.
        for (x, (hx, sx)) in axes[0].iter().enumerate() {
            for (y, (hy, sy)) in axes[1].iter().enumerate() {
                for (z, (hz, sz)) in axes[2].iter().enumerate() {
                    if [*sx, *sy, *sz] != [0; 3] {
                        continue;
                    }
                    let extended = (x * ey + y) * ez + z;
                    let home = cells.home_index(*hx, *hy, *hz);
                    let mut row = first_row[extended];
                    for place in first_place[home]..first_place[home + 1] {
                        self.row[place as usize] = row;
                        cells.cell_of_place[place as usize] = extended as u32;
                        row += 1;
                    }
                }
            }
        }
        for (place, particle) in self.particle.iter().enumerate() {
            self.image[place] = cells.wrapped[*particle as usize].1;
        }
        let mut extended = 0;
        for (hx, sx) in &axes[0] {
            for (hy, sy) in &axes[1] {
                for (hz, sz) in &axes[2] {
                    let home = cells.home_index(*hx, *hy, *hz);
                    let shift = [*sx, *sy, *sz];
                    let offset = IVec3::from(shift.map(i32::from)).as_dvec3() * lengths;
                    let places = first_place[home]..first_place[home + 1];
                    for (row, place) in (first_row[extended]..).zip(places) {
                        let r =
                            cells.wrapped[self.particle[place as usize] as usize].0 + offset;
                        let at = row as usize;
                        self.place[at] = place;
                        self.candidates.x[at] = r.x as f32;
                        self.candidates.y[at] = r.y as f32;
                        self.candidates.z[at] = r.z as f32;
                        if shift != [0; 3] {
                            self.ghosts.push(Ghost {
                                row,
                                source: self.row[place as usize],
                                shift,
                            });
                        }
                    }
                    extended += 1;
                }
            }
        }
        cells.first_row = first_row;
    }

    /// The runs of rows that can hold neighbors within the root of `radius2` of the particle at
    /// `place`, written to `runs`; returns the number of rows in them.
    pub(crate) fn runs_near(
        &self,
        place: usize,
        radius2: f32,
        runs: &mut Vec<Range<u32>>,
    ) -> usize {
        runs.clear();
        let cells = &self.cells;
        let [_, ey, ez] = cells.extended();
        let [lx, ly, lz] = cells.layers;
        let cell = cells.cell_of_place[place] as usize;
        let (x, y, z) = (cell / (ey * ez), cell / ez % ey, cell % ez);
        let own = self.row[place] as usize;
        let (rx, ry) = (self.candidates.x[own], self.candidates.y[own]);
        let mut total = 0;
        for cx in x - lx..=x + lx {
            let dx = cells.gap(0, cx, rx);
            for cy in y - ly..=y + ly {
                let dy = cells.gap(1, cy, ry);
                if dx * dx + dy * dy > radius2 {
                    continue;
                }
                let column = (cx * ey + cy) * ez;
                let run = cells.first_row[column + z - lz]..cells.first_row[column + z + lz + 1];
                if !run.is_empty() {
                    total += run.len();
                    runs.push(run);
                }
            }
        }
        total
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

    /// The distance along an axis from coordinate `r` to the nearest point of extended cell `c`, a
    /// little less than that for rounding's sake.
    fn gap(&self, axis: usize, c: usize, r: f32) -> f32 {
        let low = (c as f64 - self.layers[axis] as f64) * self.edge[axis];
        let r = f64::from(r);
        let gap = (low - r).max(r - (low + self.edge[axis])).max(0.0);
        gap as f32 * (1.0 - 1e-5)
    }
}
