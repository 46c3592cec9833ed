//! Particles sorted into compact clusters of four, for lists of tiles.

use std::ops::Range;

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;

use crate::grid::{FARTHEST_IMAGE, GridError, fold};

/// Particles a cluster.
pub const CLUSTER: usize = 4;

/// 2³², the units of a [`ClusterRow`] along each side of the box.
pub const FIXED_UNITS: f64 = 4_294_967_296.0;

/// Side of a column of clusters over the side of the cube that four particles fill: slightly flat
/// clusters, since those at the ends of columns are long.
const COLUMN_OVER_CUBE: f64 = 1.05;

/// Particles a cell of the sort, along a column: few, so that a column is as good as sorted.
const PARTICLES_PER_SLICE: f64 = 0.5;

/// Never more cells than this many for each particle (and [`SMALLEST_GRID`]).
const CELLS_PER_PARTICLE: f64 = 4.0;

/// Cells that any grid may have.
const SMALLEST_GRID: f64 = 64.0;

/// Boxes away from home up to which a coordinate in units is below 2⁵⁰, with room for motion until the next
/// sort.
const NEAR_IMAGE: f64 = 131_072.0;

/// 1.5·2⁵²: added to a number below 2⁵¹, it leaves the nearest integer in the lowest bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// The coordinates of four particles in fixed point: x of each, y of each, z of each, in units of
/// L/2³² along each axis.
///
/// Differences of such numbers are exact, and wrap around as the periodic box does. A cluster that is not
/// full repeats its first particle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct ClusterRow(pub [[i32; CLUSTER]; 3]);

/// A coordinate vector in fixed point; `units` is 2³² over the box lengths, and `image` the boxes between
/// `r` and the home box, more or less: its purpose is to leave a number that the rounding can hold.
#[inline(always)]
#[must_use]
pub fn to_fixed(r: DVec3, image: IVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
    let home = if image == IVec3::ZERO {
        r
    } else {
        r - image.as_dvec3() * lengths
    };
    let scaled = home * units + ROUNDING;
    [scaled.x, scaled.y, scaled.z].map(|s| s.to_bits() as u32 as i32)
}

/// Particles sorted into columns along z and along each column, then cut into clusters of four.
///
/// *Places* 0..N number the particles in sorted order; cluster c holds the places 4c to 4c + 3. Columns
/// follow each other like the lines of a ploughed field, so that a cluster that spans two of them is
/// compact too. The order is a pure function of the positions.
#[derive(Debug, Clone, Default)]
pub struct ClusterTable {
    /// The particle at each place, `[N]`.
    pub particle: Vec<u32>,
    /// The image of each place, boxes between the unwrapped position and the home box, `[N]`; empty where all
    /// particles are so near to home that fixed coordinates need no help.
    image: Vec<IVec3>,
    pub(crate) grid: Columns,
    /// First place of each cell of the sort, and the end.
    first: Vec<u32>,
    /// The clusters that hold the particles of each column.
    columns: Vec<Range<u32>>,
    /// Scratch: the cell of each particle.
    home: Vec<u32>,
}

/// The cells of the sort: `across` columns along x and y, each cut into slices along z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Columns {
    pub across: [u32; 2],
    pub slices: u32,
}

impl Columns {
    fn choose(lengths: DVec3, n: usize) -> Self {
        let n = n.max(1) as f64;
        let most = (CELLS_PER_PARTICLE * n).max(SMALLEST_GRID);
        let side = COLUMN_OVER_CUBE * (CLUSTER as f64 * lengths.element_product() / n).cbrt();
        let count = |length: f64| (length / side).round().clamp(1.0, most.sqrt());
        let across = [count(lengths.x), count(lengths.y)];
        let columns = across[0] * across[1];
        let slices = (n / PARTICLES_PER_SLICE / columns).ceil();
        Self {
            across: across.map(|c| c as u32),
            slices: slices.clamp(1.0, (most / columns).max(1.0)) as u32,
        }
    }

    fn cells(&self) -> usize {
        self.across[0] as usize * self.across[1] as usize * self.slices as usize
    }

    /// Which of `count` equal parts of an axis a coordinate lies in.
    #[inline(always)]
    fn part(coordinate: i32, count: u32) -> u32 {
        ((u64::from(coordinate as u32) * u64::from(count)) >> 32) as u32
    }

    /// The column at (x, y) of the grid, in the order of places.
    #[inline(always)]
    pub fn column(&self, x: u32, y: u32) -> u32 {
        let y = if x % 2 == 1 {
            self.across[1] - 1 - y
        } else {
            y
        };
        x * self.across[1] + y
    }

    /// The cell of a column at a slice, in the order of places.
    #[inline(always)]
    pub fn cell(&self, column: u32, slice: u32) -> usize {
        let slice = if column % 2 == 1 {
            self.slices - 1 - slice
        } else {
            slice
        };
        column as usize * self.slices as usize + slice as usize
    }

    #[inline(always)]
    fn cell_of(&self, [x, y, z]: [i32; 3]) -> usize {
        let [nx, ny] = self.across;
        let column = self.column(Self::part(x, nx), Self::part(y, ny));
        self.cell(column, Self::part(z, self.slices))
    }
}

impl ClusterTable {
    /// The particle at `place`, which is at `r`, in fixed point; see [`to_fixed`].
    #[inline(always)]
    fn to_fixed(&self, place: usize, r: DVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
        let image = self.image.get(place).copied().unwrap_or_default();
        to_fixed(r, image, lengths, units)
    }

    /// The row of a cluster whose particles are where `position` says by place; `units` is 2³² over `lengths`.
    #[inline(always)]
    pub fn row(
        &self,
        cluster: usize,
        lengths: DVec3,
        units: DVec3,
        mut position: impl FnMut(usize) -> DVec3,
    ) -> ClusterRow {
        let first = cluster * CLUSTER;
        let mut row = ClusterRow::default();
        for k in 0..CLUSTER {
            // A cluster that is not full repeats its first particle.
            let place = if first + k < self.particle.len() {
                first + k
            } else {
                first
            };
            let [x, y, z] = self.to_fixed(place, position(place), lengths, units);
            (row.0[0][k], row.0[1][k], row.0[2][k]) = (x, y, z);
        }
        row
    }

    /// Number of clusters.
    #[must_use]
    pub fn clusters(&self) -> usize {
        self.particle.len().div_ceil(CLUSTER)
    }

    /// Particles of the last cluster, 1 to 4.
    #[must_use]
    pub fn in_last(&self) -> usize {
        (self.particle.len() + CLUSTER - 1) % CLUSTER + 1
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.particle.capacity() * 4
            + self.image.capacity() * size_of::<IVec3>()
            + self.first.capacity() * 4
            + self.columns.capacity() * 8
            + self.home.capacity() * 4
    }

    /// Sorts `positions` (unwrapped, σ).
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position cannot be placed; the table is then unusable.
    pub fn sort(&mut self, cell: &PeriodicBox, positions: &[DVec3]) -> Result<(), GridError> {
        let n = positions.len();
        let lengths = cell.lengths();
        let units = FIXED_UNITS / lengths;
        let far = lengths * FARTHEST_IMAGE;
        self.grid = Columns::choose(lengths, n);
        // Two ahead: after the scatter, entry c + 1 has moved from the first place of c to that of c + 1.
        self.first.clear();
        self.first.resize(self.grid.cells() + 2, 0);
        self.home.clear();
        self.home.reserve_exact(n);
        let near = lengths * NEAR_IMAGE;
        let mut all_near = true;
        for (particle, r) in positions.iter().enumerate() {
            // The comparison is false for NaN.
            let is_near = r.abs().cmple(near).all();
            if !is_near && !r.abs().cmple(far).all() {
                return Err(GridError::BadPosition { particle });
            }
            all_near &= is_near;
            let image = if is_near {
                IVec3::ZERO
            } else {
                fold(*r, lengths).1
            };
            let home = self.grid.cell_of(to_fixed(*r, image, lengths, units));
            self.first[home + 2] += 1;
            self.home.push(home as u32);
        }
        for c in 1..self.first.len() {
            self.first[c] += self.first[c - 1];
        }
        self.particle.resize(n, 0);
        for (particle, home) in self.home.iter().enumerate() {
            let place = &mut self.first[*home as usize + 1];
            self.particle[*place as usize] = particle as u32;
            *place += 1;
        }
        let slices = self.grid.slices as usize;
        self.columns.clear();
        for cells in self.first[..self.grid.cells()]
            .chunks_exact(slices)
            .enumerate()
        {
            let end = self.first[(cells.0 + 1) * slices];
            self.columns.push(clusters_around(cells.1[0], end));
        }
        self.image.clear();
        if !all_near {
            let images = self.particle.iter().map(|p| {
                let r = positions[*p as usize];
                if r.abs().cmple(near).all() {
                    IVec3::ZERO
                } else {
                    fold(r, lengths).1
                }
            });
            self.image.extend(images);
        }
        Ok(())
    }

    /// Whether the particles of a row lie in different columns.
    pub(crate) fn spans(&self, row: &ClusterRow) -> bool {
        let [nx, ny] = self.grid.across;
        let [x, y, _] = row.0;
        let column = |k: usize| (Columns::part(x[k], nx), Columns::part(y[k], ny));
        (1..CLUSTER).any(|k| column(k) != column(0))
    }

    /// The clusters that hold the particles of a column from one slice to another, both included.
    #[inline(always)]
    pub(crate) fn clusters_of(&self, column: u32, slices: [u32; 2]) -> Range<u32> {
        let (a, b) = (
            self.grid.cell(column, slices[0]),
            self.grid.cell(column, slices[1]),
        );
        clusters_around(self.first[a.min(b)], self.first[a.max(b) + 1])
    }

    /// The clusters that hold the particles of a column.
    #[inline(always)]
    pub(crate) fn clusters_of_column(&self, column: u32) -> &Range<u32> {
        &self.columns[column as usize]
    }
}

/// The clusters that hold the places from `first` to before `end`.
#[inline(always)]
fn clusters_around(first: u32, end: u32) -> Range<u32> {
    if first == end {
        return 0..0;
    }
    first / CLUSTER as u32..end.div_ceil(CLUSTER as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_of_a_column_hold_its_particles_and_every_particle_has_one_place() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 8.0, 10.0)).unwrap();
        let positions: Vec<DVec3> = (0..601)
            .map(|i| DVec3::new(0.819, 0.671, 0.5497) * f64::from(i) * 9.7 - DVec3::splat(500.0))
            .collect();
        let mut table = ClusterTable::default();
        table.sort(&cell, &positions).unwrap();
        let mut seen = vec![false; 601];
        for particle in &table.particle {
            assert!(!std::mem::replace(&mut seen[*particle as usize], true));
        }
        assert_eq!((table.clusters(), table.in_last()), (151, 1));
        let units = FIXED_UNITS / cell.lengths();
        for (place, particle) in table.particle.iter().enumerate() {
            let r = positions[*particle as usize];
            let [x, y, z] = table.to_fixed(place, r, cell.lengths(), units);
            let grid = &table.grid;
            let column = grid.column(
                Columns::part(x, grid.across[0]),
                Columns::part(y, grid.across[1]),
            );
            let slice = Columns::part(z, grid.slices);
            let run = table.clusters_of(column, [slice, slice]);
            assert!(run.contains(&((place / CLUSTER) as u32)));
        }
    }

    #[test]
    fn fixed_coordinates_wrap_as_the_box_does() {
        let lengths = DVec3::new(3.0, 7.1, 10.08);
        let units = FIXED_UNITS / lengths;
        for k in -50..50 {
            let r = DVec3::new(0.75, 1.234_5, 2.52) + lengths * f64::from(k);
            let home = to_fixed(r - lengths * f64::from(k), IVec3::ZERO, lengths, units);
            let found = to_fixed(r, IVec3::splat(k), lengths, units);
            let near = to_fixed(r, IVec3::ZERO, lengths, units);
            for axis in 0..3 {
                // 350 σ have lost a last place of 6e-14, far below a unit of 1e-9 or so.
                assert!(found[axis].wrapping_sub(home[axis]).abs() <= 1);
                assert!(near[axis].wrapping_sub(home[axis]).abs() <= 1);
            }
        }
    }
}
