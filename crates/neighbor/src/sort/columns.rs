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
use std::slice;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;
use lennard_core::parallel::{for_each_piece, for_each_piece_of_three};

use super::cell_sort::CellSort;
use super::cells::Cells;
use super::column_grid::ColumnGrid;
use super::coordinates::PADDING;
use super::fixed::{FIXED_UNITS, FixedRow, to_fixed};
use super::fold::{FARTHEST_IMAGE, fold};
use super::positions::{GridError, Positions};

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
    sort: CellSort,
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

    /// Number of bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.particle.capacity() * 4
            + self.image.capacity() * size_of::<IVec3>()
            + self.room.capacity() * size_of::<FixedRow>()
            + self.sort.bytes()
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
        let (values, known) = (positions.values(), positions.known());
        let n = values.len();
        let lengths = cell.lengths();
        let units = FIXED_UNITS / lengths;
        let (near, far) = (lengths * NEAR_IMAGE, lengths * FARTHEST_IMAGE);
        self.grid = ColumnGrid::choose(lengths, n);
        let grid = self.grid;
        let (all_near, all_usable) = (AtomicBool::new(true), AtomicBool::new(true));
        self.sort.home.resize(n, 0);
        let own = &values[known.clone()];
        for_each_piece(&mut self.sort.home[known.clone()], |first, chunk| {
            for (home, r) in chunk.iter_mut().zip(&own[first..]) {
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
        let bad = (!all_usable.into_inner())
            .then(|| known.clone().find(|k| !values[*k].abs().cmple(far).all()));
        let (bad, some_are_far) = positions.agree(bad.flatten(), !all_near.into_inner());
        if let Some(bad) = bad {
            let particle = positions.particle(bad, &self.particle);
            return Err(GridError::BadPosition { particle });
        }
        positions.make_numbers_known(&mut self.sort.home);
        self.sort.sort(grid.cells(), &mut self.particle, positions);
        self.image.clear();
        if some_are_far {
            let mut images = vec![DVec3::ZERO; n];
            for (image, r) in images[known].iter_mut().zip(own) {
                if !r.abs().cmple(near).all() {
                    *image = fold(*r, lengths).1.as_dvec3();
                }
            }
            positions.make_vectors_known(&mut images);
            let of_slots = self.sort.source.iter().map(|k| images[*k as usize]);
            self.image.extend(of_slots.map(|image| image.as_ivec3()));
        }
        Ok(())
    }

    /// Places all particles of the last order, whose positions are known.
    pub(crate) fn place_all(&mut self, cell: &PeriodicBox, positions: Positions<'_>) {
        let source = std::mem::take(&mut self.sort.source);
        let all = 0..source.len();
        self.place(cell, slice::from_ref(&all), positions.by_slot(&source));
        self.sort.source = source;
    }

    /// Fills the coordinates of some runs of slots, where `at` gives the position at a slot, σ.
    pub fn place(
        &mut self,
        cell: &PeriodicBox,
        runs: &[Range<usize>],
        at: impl Fn(usize) -> DVec3 + Sync,
    ) {
        let (lengths, units) = (cell.lengths(), FIXED_UNITS / cell.lengths());
        let n = self.particle.len();
        let mut room = std::mem::take(&mut self.room);
        room.reserve_exact((n + PADDING).saturating_sub(room.len()));
        room.resize(n + PADDING, FixedRow::default());
        for run in runs {
            let (x, rest) = room.as_flattened_mut().split_at_mut(n + PADDING);
            let (y, z) = rest.split_at_mut(n + PADDING);
            let [x, y, z] = [x, y, z].map(|axis| &mut axis[run.clone()]);
            for_each_piece_of_three(x, y, z, |first, x, y, z| {
                for (k, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
                    let slot = run.start + first + k;
                    [*x, *y, *z] = self.fixed(slot, at(slot), lengths, units);
                }
            });
        }
        self.room = room;
    }

    /// The slots of a column between two slices, both included.
    #[inline(always)]
    pub(crate) fn slots_of(&self, column: u32, slices: [u32; 2]) -> Range<u32> {
        let (a, b) = (self.grid.cell(column, slices[0]), self.grid.cell(column, slices[1]));
        let first = &self.sort.first;
        first[a.min(b)]..first[a.max(b) + 1]
    }
}

impl Cells for ColumnTable {
    fn count(&self) -> [u32; 3] {
        let [x, y] = self.grid.across;
        [x, y, self.grid.slices]
    }

    fn across(&self, slot: usize, r: DVec3, lengths: DVec3) -> [f64; 2] {
        let at = self.fixed(slot, r, lengths, FIXED_UNITS / lengths);
        [0, 1].map(|axis| {
            let part = f64::from(at[axis] as u32) / FIXED_UNITS;
            part * f64::from(self.grid.across[axis])
        })
    }

    #[inline(always)]
    fn slots(&self, x: u32, y: u32, slices: [u32; 2]) -> Range<u32> {
        self.slots_of(self.grid.column(x, y), slices)
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
}
