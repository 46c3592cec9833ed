//! Particles sorted into columns along z, in fixed point, so that particles that follow each other lie side by side.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::{for_each_piece, for_each_piece_of_three};

use crate::blocks::REACH;
use crate::counting::{Given, Standing};
use crate::grid::{FARTHEST_IMAGE, GridError, fold};
use crate::missing::Cells;
use crate::scan::PADDING;

/// 2³², the units of a coordinate in fixed point along each side of the box.
pub const FIXED_UNITS: f64 = 4_294_967_296.0;

/// Side of a column over the spacing of particles, (V/N)^{1/3}; the second where that spares a strip. Two particles that
/// follow each other are nearest to each other at 1.3, and hardly farther apart at 1.7, where there are fewer columns to search.
const COLUMN_OVER_SPACING: [f64; 2] = [1.7, 1.65];

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
pub const FIXED_ROUNDING: f64 = 6_755_399_441_055_744.0;

/// A coordinate vector in fixed point, in units of L/2³² along each axis; `units` is 2³² over the box
/// lengths, and `image` the boxes between `r` and the home box, more or less: its purpose is to leave a number
/// that the rounding can hold.
///
/// Differences of such numbers are exact, and wrap around as the periodic box does.
#[inline(always)]
#[must_use]
pub fn to_fixed(r: DVec3, image: IVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
    let home = if image == IVec3::ZERO {
        r
    } else {
        r - image.as_dvec3() * lengths
    };
    let scaled = home * units + FIXED_ROUNDING;
    [scaled.x, scaled.y, scaled.z].map(|s| s.to_bits() as u32 as i32)
}

/// Particles sorted into columns along z, and along each column.
///
/// *Places* 0..N number the particles in sorted order. Columns follow each other like the lines of a ploughed
/// field, so that particles that follow each other across the end of one are close too. The order is a pure
/// function of the positions.
#[derive(Debug, Clone, Default)]
pub struct ColumnTable {
    /// The particle at each place, `[N]`.
    pub particle: Vec<u32>,
    /// The image of each place, boxes between the unwrapped position and the home box, `[N]`; empty where all
    /// particles are so near to home that fixed coordinates need no help.
    image: Vec<IVec3>,
    /// Coordinates of each place along each axis in fixed point, `[N]` and [`PADDING`].
    pub at: [Vec<i32>; 3],
    pub(crate) grid: Columns,
    standing: Standing,
}

/// A list names members of columns that are at most so far apart along x, seldom farther.
const APART_ALONG_X: f64 = 4.0;
/// And of so many columns at the ends of these.
const APART_ALONG_Y: f64 = 3.0;

/// Fewest columns in the width of a strip: with fewer, most lists would cross from one strip to the next.
const NARROWEST_STRIP: f64 = 8.0;

/// The cells of the sort: `across` columns along x and y, each cut into slices along z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Columns {
    pub across: [u32; 2],
    pub slices: u32,
    /// Columns along y in a strip. Strips are numbered one after another, so that the numbers of neighbors along x stay
    /// close to each other in boxes of any width.
    strip: u32,
    /// 2³² over that, rounded up: a division takes as long as all else that numbers a column.
    strip_inverse: u64,
}

impl Columns {
    fn choose(lengths: DVec3, n: usize) -> Self {
        let [usual, narrower] = COLUMN_OVER_SPACING.map(|side| Self::with(side, lengths, n));
        if narrower.strips() < usual.strips() {
            narrower
        } else {
            usual
        }
    }

    /// Columns of a side over the spacing of particles.
    fn with(side: f64, lengths: DVec3, n: usize) -> Self {
        let n = n.max(1) as f64;
        let most = (CELLS_PER_PARTICLE * n).max(SMALLEST_GRID);
        let side = side * (lengths.element_product() / n).cbrt();
        let count = |length: f64| (length / side).round().clamp(1.0, most.sqrt());
        let across = [count(lengths.x), count(lengths.y)];
        let columns = across[0] * across[1];
        let slices = (n / PARTICLES_PER_SLICE / columns).ceil();
        let in_reach = (f64::from(REACH) * columns / n - APART_ALONG_Y) / APART_ALONG_X;
        let widest = in_reach.max(NARROWEST_STRIP).floor();
        // As wide as each other, more or less.
        let strips = (across[1] / widest).ceil();
        let strip = (across[1] / strips).ceil() as u32;
        Self {
            strip,
            strip_inverse: (1_u64 << 32).div_ceil(u64::from(strip)),
            across: across.map(|c| c as u32),
            slices: slices.clamp(1.0, (most / columns).max(1.0)) as u32,
        }
    }

    fn strips(&self) -> u32 {
        self.across[1].div_ceil(self.strip)
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
        let [nx, ny] = self.across;
        // Exact, since y times the width of a strip is less than 2³².
        let number = ((u64::from(y) * self.strip_inverse) >> 32) as u32;
        let begin = number * self.strip;
        let width = (ny - begin).min(self.strip);
        let x = if number % 2 == 1 { nx - 1 - x } else { x };
        let y = y - begin;
        let y = if x % 2 == 1 { width - 1 - y } else { y };
        begin * nx + x * width + y
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

impl ColumnTable {
    /// Whether all particles are so near to home that their images leave fixed coordinates as they are.
    #[must_use]
    pub fn is_near_home(&self) -> bool {
        self.image.is_empty()
    }

    /// The particle at `place`, which is at `r`, in fixed point; see [`to_fixed`].
    #[inline(always)]
    #[must_use]
    pub fn fixed(&self, place: usize, r: DVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
        let image = self.image.get(place).copied().unwrap_or_default();
        to_fixed(r, image, lengths, units)
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.particle.capacity() * 4
            + self.image.capacity() * size_of::<IVec3>()
            + self
                .at
                .iter()
                .map(|axis| 4 * axis.capacity())
                .sum::<usize>()
            + self.standing.bytes()
    }

    /// How many places later the last one comes, in an even fluid, that is within `radius` σ.
    pub(crate) fn ahead(&self, cell: &PeriodicBox, radius: f64) -> usize {
        let Columns { across, strip, .. } = self.grid;
        let [x, y] = [0, 1].map(|axis| {
            let side = cell.lengths()[axis] / f64::from(across[axis]);
            (radius / side).ceil() as usize
        });
        let [nx, ny] = across.map(|count| count as usize);
        // One column more: every other one is walked from its end.
        let columns = x * ny.min(strip as usize) + y + 1;
        columns * self.particle.len() / (nx * ny)
    }

    /// Which of the positions that were sorted stands at each place, `[N]`.
    #[must_use]
    pub fn from(&self) -> &[u32] {
        &self.standing.from
    }

    /// Sorts positions.
    ///
    /// # Errors
    /// [`GridError::BadPosition`] where a position cannot be placed; the table is then unusable.
    pub fn sort(&mut self, cell: &PeriodicBox, given: Given<'_>) -> Result<(), GridError> {
        let positions = given.positions();
        let n = positions.len();
        let lengths = cell.lengths();
        let units = FIXED_UNITS / lengths;
        let (near, far) = (lengths * NEAR_IMAGE, lengths * FARTHEST_IMAGE);
        self.grid = Columns::choose(lengths, n);
        let grid = self.grid;
        let (all_near, all_usable) = (AtomicBool::new(true), AtomicBool::new(true));
        self.standing.home.resize(n, 0);
        for_each_piece(&mut self.standing.home, |first, chunk| {
            for (home, r) in chunk.iter_mut().zip(&positions[first..]) {
                // The comparisons are false for NaN.
                let is_near = r.abs().cmple(near).all();
                let image = if is_near {
                    IVec3::ZERO
                } else {
                    all_near.store(false, Ordering::Relaxed);
                    if !r.abs().cmple(far).all() {
                        all_usable.store(false, Ordering::Relaxed);
                    }
                    fold(*r, lengths).1
                };
                *home = grid.cell_of(to_fixed(*r, image, lengths, units)) as u32;
            }
        });
        if !all_usable.into_inner()
            && let Some(bad) = positions.iter().position(|r| !r.abs().cmple(far).all())
        {
            let particle = given.particle_of(bad, &self.particle);
            return Err(GridError::BadPosition { particle });
        }
        self.standing.sort(grid.cells(), &mut self.particle, given);
        let from = &self.standing.from;
        self.image.clear();
        if !all_near.into_inner() {
            self.image.resize(n, IVec3::ZERO);
            for_each_piece(&mut self.image, |first, images| {
                for (image, from) in images.iter_mut().zip(&from[first..]) {
                    let r = positions[*from as usize];
                    if !r.abs().cmple(near).all() {
                        *image = fold(r, lengths).1;
                    }
                }
            });
        }
        self.fill(positions, lengths, units);
        Ok(())
    }

    /// Fills the coordinates of the places.
    fn fill(&mut self, positions: &[DVec3], lengths: DVec3, units: DVec3) {
        let n = self.particle.len();
        let mut at = std::mem::take(&mut self.at);
        for axis in &mut at {
            axis.resize(n + PADDING, 0);
        }
        let [x, y, z] = &mut at;
        for_each_piece_of_three(&mut x[..n], &mut y[..n], &mut z[..n], |first, x, y, z| {
            for (k, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
                let place = first + k;
                let r = positions[self.standing.from[place] as usize];
                [*x, *y, *z] = self.fixed(place, r, lengths, units);
            }
        });
        self.at = at;
    }

    /// The places of the particles of a column from one slice to another, both included.
    #[inline(always)]
    pub(crate) fn places_of(&self, column: u32, slices: [u32; 2]) -> Range<u32> {
        let (a, b) = (
            self.grid.cell(column, slices[0]),
            self.grid.cell(column, slices[1]),
        );
        let first = &self.standing.first;
        first[a.min(b)]..first[a.max(b) + 1]
    }
}

impl Cells for ColumnTable {
    fn count(&self) -> [u32; 3] {
        let [x, y] = self.grid.across;
        [x, y, self.grid.slices]
    }

    #[inline(always)]
    fn places(&self, x: u32, y: u32, slices: [u32; 2]) -> Range<u32> {
        self.places_of(self.grid.column(x, y), slices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_column_of_any_strip_has_a_number_and_neighbors_in_it_follow_each_other() {
        for (x, y, n) in [(3.0, 700.0, 40_000), (90.0, 95.0, 700_000), (9.0, 9.0, 600)] {
            let grid = Columns::choose(DVec3::new(x, y, 100.0), n);
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
        // As many columns across as there can be, in strips as narrow and as wide as there can be.
        for (x, z, strip) in [(1.0, 1.0, 8..9), (1e9, 1e-9, 16_384..16_385)] {
            let grid = Columns::choose(DVec3::new(x, 1e9, z), 1 << 28);
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
        let grid = Columns::choose(DVec3::splat(104.137), n);
        assert_eq!((grid.across, grid.strips()), ([60, 60], 2));
        let wider = Columns::with(COLUMN_OVER_SPACING[0], DVec3::splat(104.137), n);
        assert_eq!((wider.across, wider.strips()), ([58, 58], 3));
        assert_eq!(wider.strip, 20, "as wide as each other");
        for (x, y) in (0..56).flat_map(|x| (0..27).map(move |y| (x, y))) {
            let apart = grid.column(x, y).abs_diff(grid.column(x + 4, y + 3));
            assert!(apart * n as u32 / 3600 <= REACH, "{apart} columns");
        }
    }

    #[test]
    fn places_of_a_column_hold_its_particles_and_every_particle_has_one_place() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 8.0, 10.0)).unwrap();
        let positions: Vec<DVec3> = (0..601)
            .map(|i| DVec3::new(0.819, 0.671, 0.5497) * f64::from(i) * 9.7 - DVec3::splat(500.0))
            .collect();
        let mut table = ColumnTable::default();
        table.sort(&cell, Given::ByParticle(&positions)).unwrap();
        let mut seen = vec![false; 601];
        for particle in &table.particle {
            assert!(!std::mem::replace(&mut seen[*particle as usize], true));
        }
        let units = FIXED_UNITS / cell.lengths();
        for (place, particle) in table.particle.iter().enumerate() {
            let r = positions[*particle as usize];
            let [x, y, z] = table.fixed(place, r, cell.lengths(), units);
            assert_eq!([x, y, z], [0, 1, 2].map(|axis| table.at[axis][place]));
            let grid = &table.grid;
            let column = grid.column(
                Columns::part(x, grid.across[0]),
                Columns::part(y, grid.across[1]),
            );
            let slice = Columns::part(z, grid.slices);
            let places = table.places_of(column, [slice, slice]);
            assert!(places.contains(&(place as u32)));
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
