//! The column table: particles sorted into columns along z, in fixed point, so that consecutive slots lie side by side.
//!
//! ```text
//!   A row in fixed point, as the pair loop reads it (16 bytes, a quarter of a cache line):
//!   +------+------+------+------+
//!   |  x   |  y   |  z   |  0   |   i32, in units of L/2³² along each axis; one row per slot
//!   +------+------+------+------+
//! ```
//!
//! There are no ghosts: the difference of two integers wraps around as the periodic box does.

use std::ops::Range;

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::for_each_piece_of_three;

use crate::chunk_slots::{ChunkSlots, SMALLEST_CUT};
use crate::clusters::format::BLOCK_REACH;
use crate::sort::cell_sort::CellSort;
use crate::sort::coordinates::{FARTHEST_IMAGE, FIXED_UNITS, FixedRow, PADDING, fold, to_fixed};
use crate::sort::parts::{Belongs, Columns, Present};
use crate::sort::positions::{GridError, Positions};

/// The largest image number below which coordinates need no folding first.
///
/// Below it, a coordinate in units is less than 2⁵⁰, with room for the motion until the next sort.
const NEAR_IMAGE: f64 = 131_072.0;

/// Particles sorted into columns along z, and along each column.
///
/// *Slots* 0..N number the particles in sorted order. The table is a pure function of the positions.
#[derive(Debug, Clone, Default)]
pub struct ColumnTable {
    /// The particle at each slot, `[N]`.
    pub particle: Vec<u32>,
    /// The image of each slot: boxes between the unwrapped position and the home box, `[N]`.
    ///
    /// It is empty where all particles are so near to the home box that fixed point needs no folding.
    image: Vec<IVec3>,
    /// The room of the coordinates along each axis in fixed point, each `[N]` and [`PADDING`].
    room: Vec<FixedRow>,
    pub(crate) grid: ColumnGrid,
    /// The columns that the table has.
    pub(crate) present: Present,
    sort: CellSort,
    /// The slots of each chunk.
    pub(crate) chunks: ChunkSlots,
}

impl ColumnTable {
    /// Whether all particles are so near to the home box that fixed point needs no folding.
    #[must_use]
    pub fn is_near_home(&self) -> bool {
        self.image.is_empty()
    }

    /// The position `r` of the particle at `slot` in fixed point; see [`to_fixed`].
    #[inline(always)]
    #[must_use]
    pub fn fixed(&self, slot: usize, r: DVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
        let image = self.image.get(slot).copied().unwrap_or_default();
        to_fixed(r, image, lengths, units)
    }

    /// Number of particles of the whole system.
    #[must_use]
    pub(crate) fn whole(&self) -> usize {
        self.present.whole(self.particle.len())
    }

    /// Number of bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.particle.capacity() * 4
            + self.image.capacity() * size_of::<IVec3>()
            + self.room.capacity() * size_of::<FixedRow>()
            + self.sort.bytes()
            + self.chunks.bytes()
    }

    /// Coordinates of each slot along each axis in fixed point, `[N]` and [`PADDING`], during a build.
    #[must_use]
    pub fn at(&self) -> [&[i32]; 3] {
        let each = self.particle.len() + PADDING;
        let all = self.room.as_flattened();
        [0, 1, 2].map(|axis| &all[axis * each..(axis + 1) * each])
    }

    /// Lends the room of rows to the coordinates of a build, or takes it back: a loop needs its rows between builds alone.
    pub fn swap_room(&mut self, rows: &mut Vec<FixedRow>) {
        std::mem::swap(&mut self.room, rows);
    }

    /// The index, in the order that was given to the sort, of the position that belongs to each slot, `[N]`.
    #[must_use]
    pub fn source(&self) -> &[u32] {
        &self.sort.source
    }

    /// Sorts positions in a box, and places all particles.
    ///
    /// # Errors
    /// As [`ColumnTable::order`].
    pub fn sort(&mut self, cell: &PeriodicBox, positions: Positions<'_>) -> Result<(), GridError> {
        self.order(cell, positions)?;
        self.place_all(cell, positions);
        Ok(())
    }

    /// Gives the particles their slots. Coordinates follow by [`ColumnTable::place`].
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position is not a usable number; the table is then unusable.
    pub fn order(&mut self, cell: &PeriodicBox, positions: Positions<'_>) -> Result<(), GridError> {
        let values = positions.values();
        let n = values.len();
        let lengths = cell.lengths();
        let units = FIXED_UNITS / lengths;
        let (near, far) = (lengths * NEAR_IMAGE, lengths * FARTHEST_IMAGE);
        let whole = self.present.whole(n);
        self.grid = ColumnGrid::choose(lengths, whole);
        let (grid, present) = (self.grid, &self.present);
        let cell_of = |r: DVec3| {
            let [column, slice] = grid.parts_of(to_fixed(r, image_of(r, lengths), lengths, units));
            let place = present.place(column).expect("a particle lies in a column of the table");
            place as usize * grid.slices as usize + grid.along(column, slice) as usize
        };
        let [nx, ny] = grid.across;
        let cells = present.count(nx * ny) as usize * grid.slices as usize;
        let some_are_far =
            self.sort.order(cells, &mut self.particle, positions, [near, far], cell_of)?;
        let columns = present.bundles(|| {
            let first = if n < SMALLEST_CUT { vec![0] } else { grid.bundles() };
            first.into_iter().chain([nx * ny]).collect()
        });
        let first = |column: u32| self.sort.first[(column * grid.slices) as usize];
        self.chunks.cut(columns.into_iter().map(first));
        self.image.clear();
        if some_are_far {
            let of_slots = self.sort.source.iter().map(|k| image_of(values[*k as usize], lengths));
            self.image.extend(of_slots);
        }
        Ok(())
    }

    /// Begins a part of `whole` particles in a box: chooses the grid.
    pub(crate) fn begin_part(&mut self, cell: &PeriodicBox, whole: usize) -> Columns {
        self.present.begin(whole);
        self.grid = ColumnGrid::choose(cell.lengths(), whole);
        let Self { grid, .. } = self;
        let [_, ny] = grid.across;
        let strips = (0..ny).step_by(grid.strip as usize);
        let ends = strips.flat_map(|begin| {
            (begin..(begin + grid.strip).min(ny)).step_by(COLUMNS_PER_BUNDLE as usize)
        });
        let ends = ends.chain([ny]).collect();
        Columns { count: grid.across, ends, lengths: cell.lengths() }
    }

    /// The column of a position in a box, in the grid that was chosen last.
    pub(crate) fn column_at(&self, cell: &PeriodicBox, r: DVec3) -> [u32; 2] {
        let lengths = cell.lengths();
        let [x, y, _] = to_fixed(r, image_of(r, lengths), lengths, FIXED_UNITS / lengths);
        let [nx, ny] = self.grid.across;
        [ColumnGrid::part(x, nx), ColumnGrid::part(y, ny)]
    }

    /// Goes on with a part: takes its columns, and the number of each particle that will be sorted.
    pub(crate) fn take_part(&mut self, belongs: impl Fn([u32; 2]) -> Belongs, numbers: &[u32]) {
        let [nx, ny] = self.grid.across;
        let mut of_column = vec![Belongs::Nowhere; (nx * ny) as usize];
        for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
            of_column[self.grid.column(x, y) as usize] = belongs([x, y]);
        }
        self.present.take(&of_column, &self.grid.bundles());
        self.particle.clear();
        self.particle.extend_from_slice(numbers);
    }

    /// Places all particles of the last order, whose positions are known.
    pub(crate) fn place_all(&mut self, cell: &PeriodicBox, positions: Positions<'_>) {
        let source = std::mem::take(&mut self.sort.source);
        self.place(cell, positions.by_slot(&source));
        self.sort.source = source;
    }

    /// Fills the coordinates, where `at` gives the position at a slot, σ.
    pub fn place(&mut self, cell: &PeriodicBox, at: impl Fn(usize) -> DVec3 + Sync) {
        let (lengths, units) = (cell.lengths(), FIXED_UNITS / cell.lengths());
        let n = self.particle.len();
        let mut room = std::mem::take(&mut self.room);
        room.reserve_exact((n + PADDING).saturating_sub(room.len()));
        room.resize(n + PADDING, FixedRow::default());
        let (x, rest) = room.as_flattened_mut().split_at_mut(n + PADDING);
        let (y, z) = rest.split_at_mut(n + PADDING);
        let [x, y, z] = [x, y, z].map(|axis| &mut axis[..n]);
        for_each_piece_of_three(x, y, z, |first, x, y, z| {
            for (k, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
                [*x, *y, *z] = self.fixed(first + k, at(first + k), lengths, units);
            }
        });
        self.room = room;
    }

    /// The cell of a slot in the box, and the number of its particle.
    pub(crate) fn key(&self, slot: u32) -> [u32; 2] {
        let cell = self.sort.first.partition_point(|first| *first <= slot) as u32 - 1;
        let slices = self.grid.slices;
        let column = self.present.column((cell / slices) as usize);
        [column * slices + cell % slices, self.particle[slot as usize]]
    }

    /// The slots of a column between two slices, both included.
    #[inline(always)]
    pub(crate) fn slots_of(&self, column: u32, slices: [u32; 2]) -> Range<u32> {
        let Some(place) = self.present.place(column) else { return 0..0 };
        let [a, b] = slices
            .map(|slice| (place * self.grid.slices + self.grid.along(column, slice)) as usize);
        let first = &self.sort.first;
        first[a.min(b)]..first[a.max(b) + 1]
    }
}

/// The image of a position in a box, where fixed point needs it; elsewhere zero.
fn image_of(r: DVec3, lengths: DVec3) -> IVec3 {
    match r.abs().cmple(lengths * NEAR_IMAGE).all() {
        true => IVec3::ZERO,
        false => fold(r, lengths).1,
    }
}

/// What [`super::Cells`] asks for.
impl ColumnTable {
    pub(super) fn count(&self) -> [u32; 3] {
        let [x, y] = self.grid.across;
        [x, y, self.grid.slices]
    }
}

// The grid of columns along z that fixed-point coordinates are sorted by.
//
// ```text
//   numbers of 4 x 4 columns in two strips, along the order of the slots:
//
//   y
//   3 | 14  13  10   9    strip 1, from right to left
//   2 | 15  12  11   8
//   1 |  1   2   5   6    strip 0, from left to right
//   0 |  0   3   4   7
//     +----------------
//        0   1   2   3  x
//
//   Each column is cut into slices along z. Every second column is walked from its far end:
//
//   column 0   column 1   column 2
//      ^          v          ^       consecutive slots stay close in space
//      ^          v          ^
// ```
//
// Up to four columns of a strip side by side along y are a bundle. Chunks and clusters begin anew in each bundle. So they
// depend on the particles of the bundle, and not on how many particles come before them.

/// The side of a column over the particle spacing (V/N)^{1/3}; the second value is used where it spares a strip.
///
/// Consecutive particles are closest to each other at 1.3. At 1.7 they are hardly farther apart, and the search visits
/// fewer columns.
const COLUMN_OVER_SPACING: [f64; 2] = [1.7, 1.65];

/// Particles per cell of the sort: few, so that a column is nearly sorted along z.
const PARTICLES_PER_SLICE: f64 = 0.5;

/// Largest number of cells per particle, above [`SMALLEST_GRID`].
const CELLS_PER_PARTICLE: f64 = 4.0;

/// Number of cells that every grid may have.
const SMALLEST_GRID: f64 = 64.0;

/// Largest distance along x, in columns, between two neighbors in a list; a few lists reach farther.
const APART_ALONG_X: f64 = 4.0;
/// Largest distance along y, in columns, between two neighbors in a list at that distance along x.
const APART_ALONG_Y: f64 = 3.0;

/// Number of columns in a bundle. The last one across a strip may have fewer.
const COLUMNS_PER_BUNDLE: u32 = 4;

/// Smallest width of a strip, in columns: below it, most lists would cross from one strip to the next.
const NARROWEST_STRIP: f64 = 8.0;

/// The cells of the sort: columns along z, `across` of them along x and y, each cut into slices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct ColumnGrid {
    /// Number of columns along x and y.
    pub across: [u32; 2],
    /// Number of slices per column.
    pub slices: u32,
    /// Number of columns along y in a strip.
    ///
    /// Strips are numbered one after another. Column numbers of neighbors along x stay close in a box of any width.
    strip: u32,
    /// 2³² over `strip`, rounded up: a division would take as long as the rest of the numbering of a column.
    strip_inverse: u64,
    /// Whether a block reaches every slot from any other one.
    pub all_in_reach: bool,
}

impl ColumnGrid {
    /// Chooses the grid for a box and a number of particles.
    pub fn choose(lengths: DVec3, n: usize) -> Self {
        let [usual, narrower] = COLUMN_OVER_SPACING.map(|side| Self::with(side, lengths, n));
        if narrower.strips() < usual.strips() { narrower } else { usual }
    }

    /// The grid whose columns have this side over the particle spacing.
    fn with(side: f64, lengths: DVec3, n: usize) -> Self {
        let all_in_reach = n <= BLOCK_REACH as usize + 1;
        let n = n.max(1) as f64;
        let most = (CELLS_PER_PARTICLE * n).max(SMALLEST_GRID);
        let side = side * (lengths.element_product() / n).cbrt();
        let count = |length: f64| (length / side).round().clamp(1.0, most.sqrt());
        let across = [count(lengths.x), count(lengths.y)];
        let columns = across[0] * across[1];
        let slices = (n / PARTICLES_PER_SLICE / columns).ceil();
        let in_reach = (f64::from(BLOCK_REACH) * columns / n - APART_ALONG_Y) / APART_ALONG_X;
        let widest = in_reach.max(NARROWEST_STRIP).floor();
        // Strips get nearly equal widths.
        let strips = (across[1] / widest).ceil();
        let strip = (across[1] / strips).ceil() as u32;
        Self {
            strip,
            strip_inverse: (1_u64 << 32).div_ceil(u64::from(strip)),
            all_in_reach,
            across: across.map(|c| c as u32),
            slices: slices.clamp(1.0, (most / columns).max(1.0)) as u32,
        }
    }

    fn strips(&self) -> u32 {
        self.across[1].div_ceil(self.strip)
    }

    /// The part of an axis, one of `count` equal parts, that contains a fixed-point coordinate.
    #[inline(always)]
    pub fn part(coordinate: i32, count: u32) -> u32 {
        ((u64::from(coordinate as u32) * u64::from(count)) >> 32) as u32
    }

    /// The number of the column at (x, y), in the order of slots.
    #[inline(always)]
    pub fn column(&self, x: u32, y: u32) -> u32 {
        let [nx, ny] = self.across;
        // The product is exact, since y times the width of a strip is less than 2³².
        let number = ((u64::from(y) * self.strip_inverse) >> 32) as u32;
        let begin = number * self.strip;
        let width = (ny - begin).min(self.strip);
        let x = if number % 2 == 1 { nx - 1 - x } else { x };
        let y = y - begin;
        let y = if x % 2 == 1 { width - 1 - y } else { y };
        begin * nx + x * width + y
    }

    /// The first column of each bundle, ascending.
    fn bundles(&self) -> Vec<u32> {
        let [nx, ny] = self.across;
        let mut first = Vec::new();
        for begin in (0..ny).step_by(self.strip as usize) {
            let width = self.strip.min(ny - begin);
            for x in 0..nx {
                // Every second row of columns is walked from its far end.
                let is_first = |y: &u32| match x % 2 {
                    0 => y.is_multiple_of(COLUMNS_PER_BUNDLE),
                    _ => *y == 0 || (width - y).is_multiple_of(COLUMNS_PER_BUNDLE),
                };
                let columns = (0..width).filter(is_first).map(|y| begin * nx + x * width + y);
                first.extend(columns);
            }
        }
        first
    }

    /// Whether neighbors in two columns share blocks, which reach from one to the other in a uniform fluid.
    ///
    /// It is a matter of the box and of N alone: no number of a slot decides it.
    #[inline(always)]
    pub fn share_blocks(&self, a: u32, b: u32) -> bool {
        self.all_in_reach || a.abs_diff(b) <= (APART_ALONG_X as u32 * self.strip) / 2 + 2
    }

    /// The place of a slice along a column, in the order of slots.
    #[inline(always)]
    pub fn along(&self, column: u32, slice: u32) -> u32 {
        if column % 2 == 1 { self.slices - 1 - slice } else { slice }
    }

    /// The column and the slice that contain a point in fixed point.
    #[inline(always)]
    pub fn parts_of(&self, [x, y, z]: [i32; 3]) -> [u32; 2] {
        let [nx, ny] = self.across;
        let column = self.column(Self::part(x, nx), Self::part(y, ny));
        [column, Self::part(z, self.slices)]
    }

    /// The distance in slots, in a uniform fluid of `n` particles, to the last slot within `radius` σ.
    pub fn slots_ahead(&self, lengths: DVec3, radius: f64, n: usize) -> usize {
        let [x, y] = [0, 1].map(|axis| {
            let side = lengths[axis] / f64::from(self.across[axis]);
            (radius / side).ceil() as usize
        });
        let [nx, ny] = self.across.map(|count| count as usize);
        // One more column, since every second column is walked from its far end.
        let columns = x * ny.min(self.strip as usize) + y + 1;
        columns * n / (nx * ny)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_of_a_column_hold_its_particles_and_every_particle_has_one_slot() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 8.0, 10.0)).unwrap();
        let positions: Vec<DVec3> = (0..601)
            .map(|i| DVec3::new(0.819, 0.671, 0.5497) * f64::from(i) * 9.7 - DVec3::splat(500.0))
            .collect();
        let mut table = ColumnTable::default();
        table.sort(&cell, Positions::ById(&positions)).unwrap();
        let mut seen = vec![false; 601];
        for particle in &table.particle {
            assert!(!std::mem::replace(&mut seen[*particle as usize], true));
        }
        let units = FIXED_UNITS / cell.lengths();
        for (slot, particle) in table.particle.iter().enumerate() {
            let r = positions[*particle as usize];
            let [x, y, z] = table.fixed(slot, r, cell.lengths(), units);
            assert_eq!([x, y, z], [0, 1, 2].map(|axis| table.at()[axis][slot]));
            let grid = &table.grid;
            let column = grid
                .column(ColumnGrid::part(x, grid.across[0]), ColumnGrid::part(y, grid.across[1]));
            let slice = ColumnGrid::part(z, grid.slices);
            let slots = table.slots_of(column, [slice, slice]);
            assert!(slots.contains(&(slot as u32)));
        }
    }

    #[test]
    fn each_column_of_any_strip_has_a_number_and_neighbors_in_it_follow_each_other() {
        for (x, y, n) in [(3.0, 700.0, 40_000), (90.0, 95.0, 700_000), (9.0, 9.0, 600)] {
            let grid = ColumnGrid::choose(DVec3::new(x, y, 100.0), n);
            let [nx, ny] = grid.across;
            let mut seen = vec![false; (nx * ny) as usize];
            for y in 0..ny {
                let strip = y / grid.strip;
                for x in 0..nx {
                    let column = grid.column(x, y);
                    assert!(!std::mem::replace(&mut seen[column as usize], true));
                    assert!(
                        (strip * grid.strip * nx..(strip + 1) * grid.strip * nx).contains(&column)
                    );
                    if y > 0 && (y - 1) / grid.strip == strip {
                        assert_eq!(column.abs_diff(grid.column(x, y - 1)), 1);
                    }
                }
            }
        }
        // The largest number of columns across, in the narrowest and in the widest strips.
        for (x, z, strip) in [(1.0, 1.0, 8..9), (1e9, 1e-9, 16_384..16_385)] {
            let grid = ColumnGrid::choose(DVec3::new(x, 1e9, z), 1 << 28);
            let [nx, ny] = grid.across;
            assert!(ny == 1 << 15 && strip.contains(&grid.strip));
            for y in (0..ny).filter(|y| y % grid.strip < 2 || y % grid.strip > grid.strip - 2) {
                assert_eq!(grid.column(0, y) / (nx * grid.strip), y / grid.strip);
            }
        }
    }

    #[test]
    fn a_million_particles_need_two_strips_and_lists_seldom_leave_the_reach_of_a_block() {
        let n = 953_312;
        let grid = ColumnGrid::choose(DVec3::splat(104.137), n);
        assert_eq!((grid.across, grid.strips()), ([60, 60], 2));
        let wider = ColumnGrid::with(COLUMN_OVER_SPACING[0], DVec3::splat(104.137), n);
        assert_eq!((wider.across, wider.strips()), ([58, 58], 3));
        assert_eq!(wider.strip, 20, "strips have equal widths");
        for (x, y) in (0..56).flat_map(|x| (0..27).map(move |y| (x, y))) {
            let apart = grid.column(x, y).abs_diff(grid.column(x + 4, y + 3));
            assert!(apart * n as u32 / 3600 <= BLOCK_REACH, "{apart} columns");
        }
    }

    #[test]
    fn bundles_are_columns_side_by_side_and_neighbors_in_a_strip_share_blocks() {
        for (x, y, n) in [(3.0, 700.0, 40_000), (104.137, 104.137, 953_312), (33.6, 33.6, 32_000)] {
            let grid = ColumnGrid::choose(DVec3::new(x, y, 104.137), n);
            let [nx, ny] = grid.across;
            let bundles = grid.bundles();
            assert!(bundles[0] == 0 && bundles.is_sorted_by(|a, b| a < b && b - a <= 4));
            let bundle = |x, y| bundles.partition_point(|first| *first <= grid.column(x, y));
            for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
                let first = y / grid.strip * grid.strip + y % grid.strip / 4 * 4;
                assert_eq!(bundle(x, y), bundle(x, first));
                let is_near = |x: u32, y: u32, own: [u32; 2]| {
                    grid.share_blocks(grid.column(x, y), grid.column(own[0], own[1]))
                };
                if x + 2 < nx && y + 2 < ny {
                    let in_strip = y / grid.strip == (y + 2) / grid.strip;
                    assert!(!in_strip || is_near(x + 2, y + 2, [x, y]));
                    assert!(!in_strip || is_near(x + 2, y, [x, y + 2]));
                }
            }
            let beyond_a_face = grid.share_blocks(grid.column(0, 0), grid.column(nx - 1, 0));
            assert_eq!(beyond_a_face, n < 100_000, "{x}");
        }
    }
}
