//! Lists that four particles share: each names all that is near to one of the four.

use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::for_each_with;

use crate::columns::{ColumnTable, FIXED_UNITS};
use crate::grid::GridError;
use crate::list::ATOMS_PER_CHUNK;
use crate::scan::PADDING;

/// Particles that share a list: those at consecutive places.
pub const SHARERS: usize = 4;
/// Entries of a block.
pub const BLOCK: usize = 16;
/// What entries count in: eight times an entry is then the distance in bytes to a row of sixteen of them, which an
/// address reaches without a shift.
pub const ENTRY: u16 = 2;
/// How far places of a block may lie apart.
const REACH: u32 = (u16::MAX / ENTRY) as u32;
/// Particles whose surroundings are gathered together.
const GROUP: usize = 16;
const _: () = assert!(GROUP.is_multiple_of(SHARERS) && ATOMS_PER_CHUNK.is_multiple_of(GROUP));
/// Rounding of coordinates and distances in single precision, in last places of the farthest that counts: half
/// a place for each conversion, product and difference on three axes, and as much again for safety.
const LAST_PLACES: f64 = 8.0;

/// 1.5·2²³: added to a number below 2²² and taken off again, it leaves the nearest whole number.
const ROUNDING: f32 = 12_582_912.0;

/// Some neighbors of the sharers of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// What is added to each entry to give a place.
    pub base: u32,
    /// Which of the entries count, a bit each; the others name some place.
    pub valid: u16,
    /// [`ENTRY`] times the places less the base.
    pub entries: [u16; BLOCK],
}

impl Block {
    /// A block of [`BLOCK`] places.
    fn full(base: u32, places: &[u32; BLOCK]) -> Self {
        Self {
            base,
            valid: u16::MAX,
            entries: places.map(|place| (place - base) as u16 * ENTRY),
        }
    }

    /// A block of fewer places, at least one.
    fn of(base: u32, places: &[u32]) -> Self {
        let mut all = [base; BLOCK];
        all[..places.len()].copy_from_slice(places);
        Self {
            valid: u16::MAX >> (BLOCK - places.len()),
            ..Self::full(base, &all)
        }
    }

    /// The places that count.
    pub fn places(&self) -> impl Iterator<Item = u32> {
        let Self {
            base,
            valid,
            entries,
        } = *self;
        (0..BLOCK)
            .filter(move |k| valid >> k & 1 == 1)
            .map(move |k| base + u32::from(entries[k] / ENTRY))
    }
}

/// The lists of up to [`ATOMS_PER_CHUNK`] consecutive places.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SharedChunk {
    /// The first place.
    pub first_place: u32,
    /// Where the blocks of each list begin, and the end, `[lists + 1]`.
    pub starts: Vec<u32>,
    /// How many blocks of each list, those that come first, have entries that do not count for all sharers. The first
    /// of them begins with the sharers themselves.
    pub masked: Vec<u32>,
    /// The blocks of one list after another.
    pub blocks: Vec<Block>,
}

/// The box around a group of particles, and what is near to it.
#[derive(Debug, Clone, Copy)]
pub struct Around {
    /// The middle of the box, in fixed point.
    pub middle: [i32; 3],
    /// From the middle to the faces along each axis, σ, rounded up.
    pub half: [f32; 3],
    /// Length of a unit along each axis, σ.
    pub scale: [f32; 3],
    /// Sides of the periodic box, σ, where distances from the middle must be folded; otherwise none.
    pub folds: Option<[f32; 3]>,
    /// What is near, σ², with a margin for all rounding.
    pub radius2: f32,
}

impl Around {
    /// Coordinates in fixed point as seen from the middle, σ.
    #[inline(always)]
    #[must_use]
    pub fn relative(&self, at: [i32; 3]) -> [f32; 3] {
        let axis = |axis: usize| at[axis].wrapping_sub(self.middle[axis]) as f32 * self.scale[axis];
        [axis(0), axis(1), axis(2)]
    }
}

/// The surroundings of a group, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct Gathered {
    /// Coordinates along each axis as seen from the middle of the group, σ.
    pub at: [Vec<f32>; 3],
    /// Place of each.
    pub place: Vec<u32>,
    /// How many there are; what lies beyond them means nothing.
    pub len: usize,
}

impl Gathered {
    /// Makes room for the places of `runs` and two registers more, and checks that runs are places.
    ///
    /// # Panics
    /// Where a run is not one of places: that is a bug of the caller.
    pub fn make_room(&mut self, table: &ColumnTable, runs: &[Range<u32>]) {
        let places = table.particle.len();
        for axis in &table.at {
            assert!(axis.len() >= places + PADDING, "padded");
        }
        let mut total = 2 * PADDING;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= places);
            total += (run.end - run.start) as usize;
        }
        if self.place.len() < total {
            for axis in &mut self.at {
                axis.resize(total, 0.0);
            }
            self.place.resize(total, 0);
        }
    }

    /// Checks that a register beyond the last element can be read, and that `found` has room for a register more than
    /// may be found.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn check(&self, found: &[u32]) {
        for axis in &self.at {
            assert!(axis.len() >= self.len + PADDING);
        }
        assert!(self.place.len() >= self.len + PADDING);
        assert!(found.len() >= self.len + PADDING);
    }
}

/// The innermost loops of the search, for an instruction set.
pub trait SharedScanner: Sync {
    /// Gathers the places of `runs` that lie within the radius of the box.
    fn gather(
        &self,
        table: &ColumnTable,
        around: &Around,
        runs: &[Range<u32>],
        gathered: &mut Gathered,
    );

    /// Writes to `found` the places within the radius of one of the sharers, which are at `own` as seen from the
    /// middle, without those of the sharers, which begin with `first`; returns how many they are. `found` has room for
    /// [`PADDING`] more than were gathered.
    fn near(
        &self,
        gathered: &Gathered,
        around: &Around,
        own: [[f32; 3]; SHARERS],
        first: u32,
        found: &mut [u32],
    ) -> usize;
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarSharedScanner;

impl SharedScanner for ScalarSharedScanner {
    fn gather(
        &self,
        table: &ColumnTable,
        around: &Around,
        runs: &[Range<u32>],
        gathered: &mut Gathered,
    ) {
        gathered.make_room(table, runs);
        let mut len = 0;
        for place in runs.iter().cloned().flatten() {
            let at = [0, 1, 2].map(|axis| table.at[axis][place as usize]);
            let at = around.relative(at);
            let mut gap2 = 0.0;
            for (at, half) in at.iter().zip(around.half) {
                let gap = (at.abs() - half).max(0.0);
                gap2 += gap * gap;
            }
            for (to, at) in gathered.at.iter_mut().zip(at) {
                to[len] = at;
            }
            gathered.place[len] = place;
            // Written always, counted only if near: no branch to mispredict.
            len += usize::from(gap2 <= around.radius2);
        }
        gathered.len = len;
    }

    fn near(
        &self,
        gathered: &Gathered,
        around: &Around,
        own: [[f32; 3]; SHARERS],
        first: u32,
        found: &mut [u32],
    ) -> usize {
        let [x, y, z] = gathered.at.each_ref().map(|axis| &axis[..gathered.len]);
        let mut count = 0;
        for (k, place) in gathered.place[..gathered.len].iter().enumerate() {
            let mut is_near = false;
            for own in own {
                let mut r2 = 0.0;
                for (axis, at) in [x[k], y[k], z[k]].into_iter().enumerate() {
                    let mut d = at - own[axis];
                    if let Some(lengths) = around.folds {
                        // The nearest whole number, without a call.
                        let boxes = d * (1.0 / lengths[axis]) + ROUNDING;
                        d -= lengths[axis] * (boxes - ROUNDING);
                    }
                    r2 += d * d;
                }
                is_near |= r2 <= around.radius2;
            }
            found[count] = *place;
            count += usize::from(is_near & (place.wrapping_sub(first) >= SHARERS as u32));
        }
        count
    }
}

/// Full lists in fixed point, one for every four particles at consecutive places: everything, by the nearest image,
/// within the list radius of one of them is named once.
#[derive(Debug, Clone)]
pub struct SharedList {
    cell: PeriodicBox,
    radius: f64,
    table: ColumnTable,
    chunks: Vec<SharedChunk>,
}

impl SharedList {
    /// An empty list for a box and a list radius r_list in σ, at most half the shortest side.
    #[must_use]
    pub fn new(cell: PeriodicBox, radius: f64) -> Self {
        Self {
            cell,
            radius,
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

    /// Number of blocks.
    #[must_use]
    pub fn blocks(&self) -> u64 {
        self.chunks.iter().map(|c| c.blocks.len() as u64).sum()
    }

    /// Number of pairs in the list, each counted once.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        let blocks = self.chunks.iter().flat_map(|c| &c.blocks);
        let entries: u64 = blocks.map(|b| u64::from(b.valid.count_ones())).sum();
        // Sharers are entries of their own lists.
        let sharers = SHARERS as u64;
        (sharers * entries).saturating_sub(self.table.particle.len() as u64) / 2
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let chunks = self.chunks.iter().map(|c| {
            4 * (c.starts.capacity() + c.masked.capacity())
                + c.blocks.capacity() * size_of::<Block>()
                + size_of::<SharedChunk>()
        });
        self.table.bytes() + chunks.sum::<usize>()
    }

    /// Builds the lists for `positions` (unwrapped, σ): a pure function of them.
    ///
    /// # Errors
    /// [`GridError`] where a position cannot be placed.
    pub fn build(
        &mut self,
        positions: &[DVec3],
        scanner: &dyn SharedScanner,
    ) -> Result<(), GridError> {
        self.table.sort(&self.cell, positions)?;
        let n = positions.len();
        self.chunks
            .resize_with(n.div_ceil(ATOMS_PER_CHUNK), SharedChunk::default);
        let search = Search::new(self.cell.lengths(), self.radius, &self.table, scanner);
        for_each_with(&mut self.chunks, |scratch: &mut Scratch, c, chunk| {
            let places = c * ATOMS_PER_CHUNK..((c + 1) * ATOMS_PER_CHUNK).min(n);
            search.fill(places, scratch, chunk);
        });
        Ok(())
    }

    /// The particles listed for each particle, `[N]`, ascending: for tests and for observers, not for force loops.
    /// What is listed for one of the sharers is listed for all, near or not.
    #[must_use]
    pub fn neighbors(&self) -> Vec<Vec<u32>> {
        let particle = &self.table.particle;
        let mut all = vec![Vec::new(); particle.len()];
        for chunk in &self.chunks {
            for (k, span) in chunk.starts.windows(2).enumerate() {
                let first = chunk.first_place as usize + k * SHARERS;
                for own in first..(first + SHARERS).min(particle.len()) {
                    let neighbors = &mut all[particle[own] as usize];
                    let blocks = &chunk.blocks[span[0] as usize..span[1] as usize];
                    let places = blocks.iter().flat_map(Block::places);
                    let others = places.filter(|place| *place as usize != own);
                    neighbors.extend(others.map(|place| particle[place as usize]));
                    neighbors.sort_unstable();
                }
            }
        }
        all
    }
}

/// What one thread needs while it fills chunks.
#[derive(Default)]
struct Scratch {
    xs: Vec<Part>,
    ys: Vec<Part>,
    runs: Vec<Range<u32>>,
    gathered: Gathered,
    found: Vec<u32>,
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
    /// Whether places themselves fit into entries.
    narrow: bool,
}

impl<'a> Search<'a> {
    fn new(
        lengths: DVec3,
        radius: f64,
        table: &'a ColumnTable,
        scanner: &'a dyn SharedScanner,
    ) -> Self {
        Self {
            table,
            scanner,
            lengths: lengths.to_array(),
            scale: (lengths / FIXED_UNITS).to_array(),
            radius: radius + 4.0 * lengths.max_element() / FIXED_UNITS,
            narrow: table.particle.len() <= REACH as usize + 1,
        }
    }

    fn fill(&self, places: Range<usize>, scratch: &mut Scratch, chunk: &mut SharedChunk) {
        chunk.first_place = places.start as u32;
        chunk.starts.clear();
        chunk.masked.clear();
        chunk.blocks.clear();
        for group in places.clone().step_by(GROUP) {
            let group = group..(group + GROUP).min(places.end);
            let around = self.around(group.clone());
            self.find_runs(&around, scratch);
            let Scratch {
                runs,
                gathered,
                found,
                ..
            } = scratch;
            self.scanner.gather(self.table, &around, runs, gathered);
            if found.len() < gathered.len + SHARERS + PADDING {
                found.resize(gathered.len + SHARERS + PADDING, 0);
            }
            for first in group.clone().step_by(SHARERS) {
                let last = group.end - 1;
                let own: [[f32; 3]; SHARERS] = std::array::from_fn(|k| {
                    // A list of fewer particles repeats its last one.
                    around.relative(self.at((first + k).min(last)))
                });
                let sharers = (group.end - first).min(SHARERS);
                let first = first as u32;
                for (found, place) in found.iter_mut().zip(first..).take(sharers) {
                    *found = place;
                }
                let others = &mut found[sharers..];
                let count = self.scanner.near(gathered, &around, own, first, others);
                chunk.starts.push(chunk.blocks.len() as u32);
                let masked = self.pack(&found[..sharers + count], &mut chunk.blocks);
                chunk.masked.push(masked);
            }
        }
        let len = chunk.blocks.len();
        chunk.starts.push(len as u32);
        // What growth took too much of is given back, but for room for the next list.
        if chunk.blocks.capacity() > len + len / 4 {
            chunk.blocks.shrink_to(len + len / 16);
        }
    }

    fn at(&self, place: usize) -> [i32; 3] {
        [0, 1, 2].map(|axis| self.table.at[axis][place])
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
        let radius = self.radius + LAST_PLACES * f64::from(f32::EPSILON) * (self.radius + farthest);
        around.radius2 = (radius * radius) as f32 * (1.0 + 4.0 * f32::EPSILON);
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
                let (slices, around_the_end) = self.slices(around.middle[2], reach);
                runs.push(self.table.places_of(column, slices));
                if let Some(slices) = around_the_end {
                    runs.push(self.table.places_of(column, slices));
                }
            }
        }
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
            let number = if k < 0 {
                k + count
            } else if k >= count {
                k - count
            } else {
                k
            };
            parts.push(Part {
                number: number as u32,
                gap2: gap * gap,
            });
        }
    }

    /// The slices of a column within `reach` units of a point along z, in one run or two.
    #[inline(always)]
    fn slices(&self, middle: i32, reach: i64) -> ([u32; 2], Option<[u32; 2]>) {
        let count = i64::from(self.table.grid.slices);
        let middle = i64::from(middle as u32);
        // Up to 2³⁴ times the number of slices, which is far below 2²⁹.
        let part = |z: i64| (z * count) >> 32;
        let (first, last) = (part(middle - reach), part(middle + reach));
        if last - first + 1 >= count {
            return ([0, count as u32 - 1], None);
        }
        // The box is longer than the run, and the run begins or ends in it.
        let around = |slice: i64| {
            let slice = if slice < 0 { slice + count } else { slice };
            (if slice >= count { slice - count } else { slice }) as u32
        };
        let (a, b) = (around(first), around(last));
        if a <= b {
            ([a, b], None)
        } else {
            ([a, count as u32 - 1], Some([0, b]))
        }
    }

    /// Writes the places of a list into blocks, those with entries that do not count for all sharers before the others,
    /// and returns how many these are.
    fn pack(&self, list: &[u32], blocks: &mut Vec<Block>) -> u32 {
        let begin = blocks.len();
        // The first block takes what does not fill whole ones, unless that is less than the sharers.
        let rest = list.len() % BLOCK;
        let lead = match rest {
            0 => BLOCK,
            1..SHARERS => (BLOCK + rest).min(list.len()),
            _ => rest,
        };
        let (lead, full) = list.split_at(lead);
        let mut masked = 0;
        for places in lead.chunks(BLOCK) {
            masked += if self.narrow {
                blocks.push(Block::of(0, places));
                1
            } else {
                pack_wide(places, begin + masked, masked == 0, blocks)
            };
        }
        let (full, none) = full.as_chunks::<BLOCK>();
        debug_assert!(none.is_empty(), "what is left fills whole blocks");
        for places in full {
            if self.narrow {
                blocks.push(Block::full(0, places));
            } else {
                masked += pack_wide(places, begin + masked, false, blocks);
            }
        }
        debug_assert!(
            blocks[begin + masked..].iter().all(|b| b.valid == u16::MAX),
            "blocks behind the masked ones are full"
        );
        masked as u32
    }
}

/// Writes up to [`BLOCK`] places into one block if their numbers lie within 16 bits, into several otherwise: a full
/// one at the end, others, and what `leads`, at `masked`. Returns how many went there.
fn pack_wide(places: &[u32], masked: usize, leads: bool, blocks: &mut Vec<Block>) -> usize {
    let low = places.iter().copied().min().unwrap_or_default();
    let high = places.iter().copied().max().unwrap_or_default();
    if high - low <= REACH {
        let block = Block::of(low, places);
        if places.len() == BLOCK && !leads {
            blocks.push(block);
            return 0;
        }
        blocks.insert(masked, block);
        return 1;
    }
    // Sharers follow each other in number, and stay together.
    let least = if leads { SHARERS } else { 1 };
    let (first, second) = places.split_at((places.len() / 2).max(least));
    let written = pack_wide(first, masked, leads, blocks);
    written + pack_wide(second, masked + written, false, blocks)
}

/// A column along an axis, and how far it is from a box.
struct Part {
    number: u32,
    /// The square of the distance, σ².
    gap2: f64,
}
