//! The counting sort by cell, which both kinds of tables use.
//!
//! ```text
//!   1  each task counts its positions in each range of cells
//!   2  each task writes its positions to its slots of each range:  | range 0: task 0, task 1, ... | range 1: task 0, ...
//!   3  each range is sorted by cell, and each cell by the number of the particle
//! ```
//!
//! All three steps use all threads. One thread alone, or few positions, have one range and the third step. The order is the same.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use lennard_core::parallel::{CHUNK, equal_parts, for_each_piece};
use lennard_core::tasks::{for_each_item, map_tasks};

use super::positions::{GridError, Positions};

/// Positions per task, where there are not too many tasks for it.
const POSITIONS_PER_TASK: usize = 4 * CHUNK;
/// The most tasks. Each has slots of its own in each range of cells.
const MOST_TASKS: usize = 128;
/// The most ranges of cells: a range of a large system fits a cache, and many threads have a range each.
const MOST_RANGES: usize = 128;

/// Consecutive cells that are sorted together.
#[derive(Clone, Copy)]
struct Ranges {
    count: usize,
    /// A range has 2 to this power cells: a shift takes less time than a division.
    power: u32,
}

impl Ranges {
    /// The ranges of so many cells with `n` positions.
    fn of(cells: usize, n: usize) -> Self {
        let is_alone = rayon::current_num_threads() == 1;
        let most = if is_alone { 1 } else { n.div_ceil(CHUNK).clamp(1, MOST_RANGES) };
        let power = cells.div_ceil(most).next_power_of_two().trailing_zeros();
        Self { count: cells.div_ceil(1 << power), power }
    }

    /// Number of cells of a range; the last one may have fewer.
    fn cells(self) -> usize {
        1 << self.power
    }

    /// The range of a cell.
    #[inline(always)]
    fn of_cell(self, cell: u32) -> usize {
        (cell >> self.power) as usize
    }
}

/// The result of a counting sort: which of the given positions belongs to each slot.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellSort {
    /// The cell of each position, in the order of the positions, `[N]`. A sort takes their room.
    pub home: Vec<u32>,
    /// The first slot of each cell, and the end, `[cells + 1]`.
    pub first: Vec<u32>,
    /// The index of the position that belongs to each slot, `[N]`.
    pub source: Vec<u32>,
}

impl CellSort {
    /// Sorts positions by the cells that `cell_of` gives, and tells whether one is not near: beyond `near` along an axis.
    ///
    /// # Errors
    /// [`GridError`] where a position is not finite, or beyond `far`.
    pub fn order(
        &mut self,
        cells: usize,
        particle: &mut Vec<u32>,
        positions: Positions<'_>,
        [near, far]: [DVec3; 2],
        cell_of: impl Fn(DVec3) -> usize + Sync,
    ) -> Result<bool, GridError> {
        let values = positions.values();
        let (all_near, all_usable) = (AtomicBool::new(true), AtomicBool::new(true));
        self.home.resize(values.len(), 0);
        for_each_piece(&mut self.home, |first, chunk| {
            for (home, r) in chunk.iter_mut().zip(&values[first..]) {
                // The comparisons are false for NaN.
                if !r.abs().cmple(near).all() {
                    all_near.store(false, Ordering::Relaxed);
                    if !r.abs().cmple(far).all() {
                        all_usable.store(false, Ordering::Relaxed);
                    }
                }
                *home = cell_of(*r) as u32;
            }
        });
        if !all_usable.into_inner() {
            let bad = values.iter().position(|r| !r.abs().cmple(far).all()).unwrap_or_default();
            return Err(GridError::BadPosition { particle: positions.particle(bad, particle) });
        }
        self.sort(cells, particle, positions);
        Ok(!all_near.into_inner())
    }

    /// Sorts positions whose cells are in `home` into `cells` cells. Inside a cell, particles are in ascending order.
    ///
    /// `particle` holds the particle at each slot: of the last sort on entry, of this sort on return.
    fn sort(&mut self, cells: usize, particle: &mut Vec<u32>, positions: Positions<'_>) {
        let ranges = Ranges::of(cells, self.home.len());
        let slots = if ranges.count > 1 { self.distribute(ranges) } else { vec![self.home.len()] };
        let Self { home, first, source } = self;
        source.resize(home.len(), 0);
        first.resize(cells + 1, 0);
        first[cells] = home.len() as u32;
        let number = match positions {
            // The positions of a cell have the order of their particles already.
            Positions::ById(_) => None,
            Positions::BySlot(_) => Some(&particle[..]),
        };
        let starts: Vec<usize> =
            slots.iter().scan(0, |end, n| Some(std::mem::replace(end, *end + n))).collect();
        let parts = first[..cells].chunks_mut(ranges.cells()).zip(cut(source, slots.into_iter()));
        for_each_item(parts, |scratch: &mut Vec<u32>, range, (first, source)| {
            let first_cell = range * ranges.cells();
            let cell = |position: u32| home[position as usize] as usize - first_cell;
            if ranges.count == 1 {
                sort_range(first, source, 0..home.len() as u32, cell);
            } else {
                scratch.clear();
                scratch.extend_from_slice(source);
                sort_range(first, source, scratch.iter().copied(), cell);
            }
            if let Some(number) = number {
                order_cells(first, source, number);
            }
            let start = starts[range] as u32;
            first.iter_mut().for_each(|first| *first += start);
        });
        if number.is_none() {
            particle.clone_from(source);
            return;
        }
        // The cells of the positions have served, and give their room.
        std::mem::swap(home, particle);
        let before = &*home;
        for_each_piece(particle, |first, particles| {
            for (particle, position) in particles.iter_mut().zip(&source[first..]) {
                *particle = before[*position as usize];
            }
        });
    }

    /// Writes to `source` the positions of each range of cells, in their own order, and returns the number of each range.
    ///
    /// Each task takes some positions, and has slots of its own in each range.
    fn distribute(&mut self, ranges: Ranges) -> Vec<usize> {
        let Self { home, source, .. } = self;
        let n = home.len();
        let tasks = equal_parts(n, n.div_ceil(POSITIONS_PER_TASK).clamp(1, MOST_TASKS));
        let counts: Vec<Vec<usize>> = map_tasks(tasks.len(), |(): &mut (), task| {
            let mut counts = vec![0; ranges.count];
            for home in &home[tasks[task].clone()] {
                counts[ranges.of_cell(*home)] += 1;
            }
            counts
        });
        source.resize(n, 0);
        let each = || (0..ranges.count).flat_map(|range| counts.iter().map(move |c| c[range]));
        let mut slots = cut(source, each()).into_iter();
        let mut of_tasks: Vec<Vec<_>> = tasks.iter().map(|_| Vec::new()).collect();
        for _ in 0..ranges.count {
            for (of_task, slots) in of_tasks.iter_mut().zip(&mut slots) {
                of_task.push(slots.iter_mut());
            }
        }
        let items = of_tasks.into_iter().zip(&tasks);
        for_each_item(items, |(): &mut (), _, (mut slots, task)| {
            for (position, home) in task.clone().zip(&home[task.clone()]) {
                let slot =
                    slots[ranges.of_cell(*home)].next().expect("a slot for each counted position");
                *slot = position as u32;
            }
        });
        (0..ranges.count).map(|range| counts.iter().map(|c| c[range]).sum()).collect()
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.home.capacity() + self.first.capacity() + self.source.capacity())
    }
}

/// Sorts the positions of some cells by cell, and writes the first slot of each cell among theirs.
///
/// Positions of a cell keep their order. `cell` gives the number of the cell of a position among these cells.
fn sort_range(
    first: &mut [u32],
    source: &mut [u32],
    positions: impl DoubleEndedIterator<Item = u32> + Clone,
    cell: impl Fn(u32) -> usize,
) {
    first.fill(0);
    for position in positions.clone() {
        first[cell(position)] += 1;
    }
    let mut end = 0;
    for first in &mut *first {
        end += *first;
        *first = end;
    }
    // Counted down from its end, the slots of a cell end at the first one.
    for position in positions.rev() {
        let slot = &mut first[cell(position)];
        *slot -= 1;
        source[*slot as usize] = position;
    }
}

/// Orders the positions of each of some cells by the number of the particle.
fn order_cells(first: &[u32], source: &mut [u32], number: &[u32]) {
    let end = source.len() as u32;
    let ends = first.iter().skip(1).chain([&end]);
    for (begin, end) in first.iter().zip(ends) {
        if end - begin > 1 {
            let of_cell = &mut source[*begin as usize..*end as usize];
            of_cell.sort_unstable_by_key(|position| number[*position as usize]);
        }
    }
}

/// The first parts of an array, of these lengths.
pub(super) fn cut<T>(mut items: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let part = |length| items.split_off_mut(..length).unwrap_or_default();
    lengths.map(part).collect()
}

#[cfg(test)]
mod tests {
    use lennard_core::parallel::pool;

    use super::*;

    /// Cells and the number of the particle, as a comparison sort orders them.
    fn compare(cells: usize, home: Vec<u32>, numbers: Option<Vec<u32>>) {
        let n = home.len();
        let number = |k: u32| numbers.as_ref().map_or(k, |numbers| numbers[k as usize]);
        let mut wanted: Vec<u32> = (0..n as u32).collect();
        wanted.sort_by_key(|k| (home[*k as usize], number(*k)));
        let places = vec![DVec3::ZERO; n];
        let positions = match numbers {
            None => Positions::ById(&places),
            Some(_) => Positions::BySlot(&places),
        };
        for threads in [1, 2, 3, 8] {
            let mut sort = CellSort { home: home.clone(), ..CellSort::default() };
            let mut particle = numbers.clone().unwrap_or_default();
            let pool = pool(threads).unwrap();
            pool.install(|| sort.sort(cells, &mut particle, positions));
            assert_eq!(sort.source, wanted, "{threads} threads");
            let particles: Vec<u32> = wanted.iter().map(|k| number(*k)).collect();
            assert_eq!(particle, particles, "{threads} threads");
            let before = |cell: u32| home.iter().filter(|home| **home < cell).count();
            let ends = [0, cells / 3, cells - 1, cells];
            assert!(ends.iter().all(|c| sort.first[*c] as usize == before(*c as u32)));
            assert_eq!(sort.first.len(), cells + 1);
        }
    }

    #[test]
    fn the_order_is_by_cell_and_number_on_any_number_of_threads() {
        for (n, cells) in [(0, 1), (1, 5), (700, 64), (5000, 9973), (40_000, 80_001), (40_000, 1)] {
            let scattered = |k: usize, size: usize| (k * 7919 + k * k % 977) % size;
            let home: Vec<u32> = (0..n).map(|k| scattered(k, cells) as u32).collect();
            let mut numbers: Vec<u32> = (0..n as u32).collect();
            numbers.sort_by_key(|k| scattered(*k as usize, 4099));
            compare(cells, home.clone(), None);
            compare(cells, home, Some(numbers.clone()));
            // Nearly all in one cell, as in a droplet.
            let drop = (0..n).map(|k| if k % 50 == 0 { scattered(k, cells) } else { cells / 2 });
            compare(cells, drop.map(|cell| cell as u32).collect(), Some(numbers));
        }
    }
}
