//! The grid of cells that a row table is sorted by, with layers of ghost cells around the box.
//!
//! ```text
//!   extended grid, seen along z (2 layers of ghost cells on each side):
//!
//!      g g g g g g g g      g: ghost cell, an image of a home cell
//!      g g g g g g g g      h: home cell, inside the box
//!      g g h h h h g g
//!      g g h h h h g g      A search looks at neighboring cells by adding offsets.
//!      g g h h h h g g      It needs no test for the faces of the box.
//!      g g g g g g g g
//!      g g g g g g g g
//! ```

use std::ops::Range;

use glam::DVec3;

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

    /// The number of the home cell at (x, y, z).
    pub fn home_index(&self, x: usize, y: usize, z: usize) -> usize {
        (x * self.inner[1] + y) * self.inner[2] + z
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
