//! Lists that four particles share: each names all that is near to one of the four.

use std::ops::Range;

use lennard_core::PeriodicBox;
use lennard_core::parallel::part;
use lennard_core::tasks::for_each_item;

use crate::blocks::{Block, REACH, SharedBlocks, SharedChunk, amid};
use crate::columns::{ColumnTable, FIXED_UNITS};
use crate::counting::Given;
use crate::criterion::Limits;
use crate::grid::GridError;
use crate::list::ATOMS_PER_CHUNK;
use crate::reach::{Reach, home};
use crate::shared_scan::{Around, Found, Gathered, SHARERS, SharedScanner};

/// Particles whose surroundings are gathered together.
const GROUP: usize = 16;
const _: () = assert!(GROUP.is_multiple_of(SHARERS) && ATOMS_PER_CHUNK.is_multiple_of(GROUP));
/// Rounding of coordinates, distances and their squares in single precision, in last places of the farthest that counts:
/// half a place for each conversion, product and difference on three axes, and as much again for safety.
const LAST_PLACES: f64 = 8.0;
/// How far a sharer may lie from the point amid all, σ, along each axis: coordinates as seen from there are rounded to
/// single precision, and differences of small ones alone are good to its last places.
const TOGETHER: f64 = 3.0;

/// Full lists in fixed point, one for every four particles at consecutive places: everything, by the nearest image,
/// within the list radius of one of them is named once. What is near to the first two of them alone, or to the last two,
/// is kept apart as far as that saves work, since two particles need not look at it.
#[derive(Debug, Clone)]
pub struct SharedList {
    cell: PeriodicBox,
    radius: f64,
    /// The cutoff, σ.
    r_cut: f64,
    table: ColumnTable,
    chunks: Vec<SharedChunk>,
}

impl SharedList {
    /// An empty list for a box, a cutoff, and a list radius r_list in σ, at most half the shortest side.
    #[must_use]
    pub fn new(cell: PeriodicBox, r_cut: f64, radius: f64) -> Self {
        Self {
            cell,
            radius,
            r_cut,
            table: ColumnTable::default(),
            chunks: Vec::new(),
        }
    }

    /// The sorted particles.
    #[must_use]
    pub fn table(&self) -> &ColumnTable {
        &self.table
    }

    /// The lists, chunk by chunk.
    #[must_use]
    pub fn chunks(&self) -> &[SharedChunk] {
        &self.chunks
    }

    /// How many places after its own a list reaches, more or less: a loop may ask for what comes into reach there.
    #[must_use]
    pub fn reaches_ahead(&self) -> usize {
        self.table.ahead(&self.cell, self.radius)
    }

    /// Number of lanes that a loop over all lists computes.
    #[must_use]
    pub fn lanes(&self) -> u64 {
        let lists = self.chunks.iter().flat_map(SharedChunk::lists);
        lists.map(|(_, list)| list.lanes() as u64).sum()
    }

    /// Number of pairs in the list, each counted once.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        let n = self.table.particle.len();
        let lists = self.chunks.iter().flat_map(SharedChunk::lists);
        let of_sharer = |(first, list): (usize, SharedBlocks<'_>)| -> u64 {
            (0..(n - first).min(SHARERS))
                .flat_map(|sharer| list.of(sharer))
                .map(|block| u64::from(block.valid.count_ones()))
                .sum()
        };
        // Sharers are entries of their own lists.
        (lists.map(of_sharer).sum::<u64>() - n as u64) / 2
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let chunks: usize = self.chunks.iter().map(SharedChunk::bytes).sum();
        self.table.bytes() + chunks + self.chunks.capacity() * size_of::<SharedChunk>()
    }

    /// Builds the lists for positions: a pure function of them.
    ///
    /// # Errors
    /// [`GridError`] where a position cannot be placed.
    pub fn build(
        &mut self,
        given: Given<'_>,
        scanner: &dyn SharedScanner,
    ) -> Result<(), GridError> {
        self.table.sort(&self.cell, given)?;
        let n = self.table.particle.len();
        self.chunks
            .resize_with(n.div_ceil(ATOMS_PER_CHUNK), SharedChunk::default);
        let mut chunks = std::mem::take(&mut self.chunks);
        let search = Search::new(self, scanner);
        for_each_item(chunks.iter_mut(), |scratch: &mut Scratch, c, chunk| {
            let places = part(c, ATOMS_PER_CHUNK, n);
            search.fill(places, scratch, chunk);
        });
        self.chunks = chunks;
        Ok(())
    }

    /// Whether the lists of both of the particles at two places name the other one.
    #[must_use]
    pub fn names(&self, [a, b]: [u32; 2]) -> bool {
        [(a, b), (b, a)].into_iter().all(|(own, other)| {
            let (chunk, k, sharer) = whose(own);
            self.chunks[chunk].names(k, sharer, other)
        })
    }

    /// Names each of the particles at two places in the list of the other one, where it does not yet.
    ///
    /// Forces are those of a list that named the pair when it was built, but for the order in which they are summed.
    pub fn name(&mut self, [a, b]: [u32; 2]) {
        for (own, other) in [(a, b), (b, a)] {
            let (chunk, k, sharer) = whose(own);
            let chunk = &mut self.chunks[chunk];
            if !chunk.names(k, sharer, other) {
                chunk.name(k, other);
            }
        }
    }

    /// The particles listed for each particle, `[N]`, ascending: for tests and for observers, not for force loops.
    /// What is listed for one of the sharers is listed for others too, near or not.
    #[must_use]
    pub fn neighbors(&self) -> Vec<Vec<u32>> {
        let particle = &self.table.particle;
        let mut all = vec![Vec::new(); particle.len()];
        for chunk in &self.chunks {
            for (first, list) in chunk.lists() {
                for own in first..(first + SHARERS).min(particle.len()) {
                    let neighbors = &mut all[particle[own] as usize];
                    let places = list.of(own - first).flat_map(Block::places);
                    let others = places.filter(|place| *place as usize != own);
                    neighbors.extend(others.map(|place| particle[place as usize]));
                    neighbors.sort_unstable();
                }
            }
        }
        all
    }
}

/// The chunk of a place, which list of it is that of the place, and which of the sharers stands there.
fn whose(place: u32) -> (usize, usize, usize) {
    let place = place as usize;
    let of_chunk = place % ATOMS_PER_CHUNK;
    let chunk = place / ATOMS_PER_CHUNK;
    (chunk, of_chunk / SHARERS, of_chunk % SHARERS)
}

/// What one thread needs while it fills chunks.
#[derive(Default)]
struct Scratch {
    xs: Vec<Part>,
    ys: Vec<Part>,
    runs: Vec<Range<u32>>,
    gathered: Gathered,
    found: Found,
}

/// What the search has in common for all groups.
struct Search<'a> {
    table: &'a ColumnTable,
    scanner: &'a dyn SharedScanner,
    lengths: [f64; 3],
    /// Length of a unit along each axis, σ.
    scale: [f64; 3],
    /// The list radius with what coordinates in fixed point are off by, σ.
    radius: f64,
    /// How far from each other two were at most, at the build, that are within the cutoff while the list is in use, σ.
    farthest: f64,
}

impl<'a> Search<'a> {
    fn new(list: &'a SharedList, scanner: &'a dyn SharedScanner) -> Self {
        let lengths = list.cell.lengths();
        let rounding = 4.0 * lengths.max_element() / FIXED_UNITS;
        let together = Limits::of(list.table.particle.len()).farthest_together;
        Self {
            table: &list.table,
            scanner,
            lengths: lengths.to_array(),
            scale: (lengths / FIXED_UNITS).to_array(),
            radius: list.radius + rounding,
            farthest: list.r_cut + together * (list.radius - list.r_cut) + rounding,
        }
    }

    fn fill(&self, places: Range<usize>, scratch: &mut Scratch, chunk: &mut SharedChunk) {
        chunk.first_place = places.start as u32;
        chunk.clear();
        for group in places.clone().step_by(GROUP) {
            let group = group..(group + GROUP).min(places.end);
            let around = self.around(group.clone());
            self.find_runs(&around, scratch);
            let base = self.base(&mut scratch.runs);
            let Scratch {
                runs,
                gathered,
                found,
                ..
            } = scratch;
            self.scanner.gather(self.table, &around, runs, gathered);
            for first in group.clone().step_by(SHARERS) {
                let end = (first + SHARERS).min(group.end);
                // A list of fewer particles repeats its last one.
                let sharers: [[i32; 3]; SHARERS] =
                    std::array::from_fn(|k| self.at((first + k).min(end - 1)));
                found.begin(first as u32..end as u32, gathered);
                let own = sharers.map(|at| around.relative(at));
                self.scanner
                    .near(gathered, &around, own, first as u32, found);
                chunk.push(found, self.are_together(&sharers), base);
            }
        }
        chunk.finish();
    }

    /// Whether all coordinates may be taken as seen from the point amid the sharers; see [`crate::Span::together`].
    fn are_together(&self, sharers: &[[i32; 3]; SHARERS]) -> bool {
        let amid = amid(sharers[1], sharers[2]);
        (0..3).all(|axis| {
            let apart = |a: [i32; 3], b: [i32; 3]| {
                let units = a[axis].wrapping_sub(b[axis]).unsigned_abs();
                f64::from(units) * self.scale[axis]
            };
            let farthest = sharers
                .iter()
                .map(|at| apart(*at, amid))
                .fold(0.0, f64::max);
            // All may move by a skin, the point amid them too. Nobody near may come to lie beyond half a box, and the two
            // may not, whose way to each other the point halves.
            let reach = farthest.max(apart(sharers[1], sharers[2])) + self.farthest;
            farthest <= TOGETHER && reach < 0.5 * self.lengths[axis]
        })
    }

    #[inline(always)]
    fn at(&self, place: usize) -> [i32; 3] {
        let [x, y, z] = &self.table.at;
        [x[place], y[place], z[place]]
    }

    /// The box around the particles of some places.
    fn around(&self, places: Range<usize>) -> Around {
        let first = self.at(places.start);
        let mut low = [0_i32; 3];
        let mut high = [0_i32; 3];
        for place in places {
            let at = self.at(place);
            for axis in 0..3 {
                let from_first = at[axis].wrapping_sub(first[axis]);
                low[axis] = low[axis].min(from_first);
                high[axis] = high[axis].max(from_first);
            }
        }
        let mut around = Around {
            middle: first,
            half: [0.0; 3],
            scale: self.scale.map(|s| s as f32),
            folds: None,
            radius2: 0.0,
        };
        let mut farthest = 0.0_f64;
        for axis in 0..3 {
            let (low, high) = (i64::from(low[axis]), i64::from(high[axis]));
            let middle = (low + high) >> 1;
            around.middle[axis] = first[axis].wrapping_add(middle as i32);
            let half = (high - middle + 1) as f64 * self.scale[axis] * (1.0 + 1e-6);
            around.half[axis] = half as f32;
            let reach = half + self.radius;
            // With some care: nothing that is near may appear on the other side.
            if reach * 1.001 >= 0.5 * self.lengths[axis] {
                around.folds = Some(self.lengths.map(|l| l as f32));
            }
            farthest = farthest.max(reach.min(self.lengths[axis]));
        }
        let last_places = LAST_PLACES * f64::from(f32::EPSILON);
        let radius = self.radius + last_places * (self.radius + farthest);
        // Squares of distances from the middle, |c|² and |o|², are taken from each other: (|c| + |o|)² bounds them.
        let [x, y, z] = around.half.map(f64::from);
        let both = self.radius + 2.0 * (x * x + y * y + z * z).sqrt();
        let radius2 = radius * radius + last_places * both * both;
        around.radius2 = radius2 as f32 * (1.0 + 4.0 * f32::EPSILON);
        around
    }

    /// Finds the runs of places in columns, and parts of them, that come within the radius of a box. No two of them
    /// have a place in common.
    fn find_runs(&self, around: &Around, scratch: &mut Scratch) {
        let Scratch { xs, ys, runs, .. } = scratch;
        self.parts(around, 0, xs);
        self.parts(around, 1, ys);
        runs.clear();
        let radius2 = f64::from(around.radius2);
        let half = f64::from(around.half[2]);
        let units = 1.0 / self.scale[2];
        for x in &*xs {
            for y in &*ys {
                let left = radius2 - x.gap2 - y.gap2;
                if left < 0.0 {
                    continue;
                }
                let column = self.table.grid.column(x.number, y.number);
                // Two units more than what is left: coordinates are rounded.
                let reach = ((half + left.sqrt()) * units) as i64 + 2;
                for slices in self.slices(around.middle[2], reach) {
                    runs.push(self.table.places_of(column, slices));
                }
            }
        }
    }

    /// A base from which entries reach the places of all runs. Where there is none, puts the runs in order, so that blocks
    /// seldom reach from one strip of columns to the next.
    fn base(&self, runs: &mut [Range<u32>]) -> Option<u32> {
        let n = self.table.particle.len() as u32;
        if n <= REACH + 1 {
            return Some(0);
        }
        let low = runs.iter().map(|run| run.start).min()?;
        let high = runs.iter().map(|run| run.end).max()?;
        if high - low <= REACH + 1 {
            return Some(low);
        }
        runs.sort_unstable_by_key(|run| run.start);
        None
    }

    /// The columns along an axis that come within the radius of a box.
    fn parts(&self, around: &Around, axis: usize, parts: &mut Vec<Part>) {
        parts.clear();
        let count = i64::from(self.table.grid.across[axis]);
        let edge = self.lengths[axis] / count as f64;
        let middle = f64::from(around.middle[axis] as u32) * self.scale[axis];
        let half = f64::from(around.half[axis]);
        let radius = f64::from(around.radius2).sqrt();
        let (low, high) = (middle - half, middle + half);
        let first = ((low - radius) / edge).floor() as i64;
        let last = ((high + radius) / edge).floor() as i64;
        if last - first + 1 >= count {
            // Where all columns come near, each may stand for several images: no distance is safe to claim.
            let all = (0..count).map(|number| Part {
                number: number as u32,
                gap2: 0.0,
            });
            parts.extend(all);
            return;
        }
        for k in first..=last {
            let below = k as f64 * edge - high;
            let above = low - (k + 1) as f64 * edge;
            // Places were found in fixed point: a last place of care.
            let gap = below.max(above).max(0.0) * (1.0 - 1e-9);
            parts.push(Part {
                number: home(k, count as u32),
                gap2: gap * gap,
            });
        }
    }

    /// The slices of a column within `reach` units of a point along z, in one run or two.
    #[inline(always)]
    fn slices(&self, middle: i32, reach: i64) -> impl Iterator<Item = [u32; 2]> {
        let slices = self.table.grid.slices;
        let middle = i64::from(middle as u32);
        // Up to 2³⁴ times the number of slices, which is far below 2²⁹.
        let part = |z: i64| (z * i64::from(slices)) >> 32;
        let (first, last) = (part(middle - reach), part(middle + reach));
        Reach { first, last }.runs(slices)
    }
}

/// A column along an axis, and how far it is from a box.
struct Part {
    number: u32,
    /// The square of the distance, σ².
    gap2: f64,
}
