//! Full Verlet lists in chunks of constant size.

use std::ops::Range;

use glam::DVec3;
use lennard_core::tasks::for_each_item;
use lennard_core::{Exclusions, PeriodicBox};

use crate::chunk_slots::{ATOMS_PER_CHUNK, ChunkSlots};
use crate::clusters::Reach;
use crate::pair_list::PairList;
use crate::room::refill;
use crate::rows::chunk::{Candidates, Center, Entries, Images, ListChunk, Numbering};
use crate::scanner::{Found, Scanner};
use crate::sort::{Belongs, Cells, Columns, GridError, PADDING, Positions, RowTable};

/// A full Verlet list: for each particle, all particles within the list radius.
///
/// The search radius is larger by a margin for rounding errors. A pair inside the margin may be listed for one of its
/// two particles only.
#[derive(Debug, Clone)]
pub struct NeighborList {
    images: Images,
    lanes: usize,
    exclusions: Exclusions,
    table: RowTable,
    chunks: Vec<ListChunk>,
}

impl NeighborList {
    /// An empty list, with the entries of each particle padded to a multiple of `lanes`.
    #[must_use]
    pub fn new(images: Images, lanes: usize) -> Self {
        Self {
            images,
            lanes: lanes.max(1),
            exclusions: Exclusions::NONE,
            table: RowTable::default(),
            chunks: Vec::new(),
        }
    }

    /// The same list, from which each build leaves these pairs out.
    #[must_use]
    pub fn excluding(self, exclusions: Exclusions) -> Self {
        Self { exclusions, ..self }
    }

    /// The sorted rows.
    #[must_use]
    pub fn table(&self) -> &RowTable {
        &self.table
    }

    /// The neighbors, chunk by chunk.
    #[must_use]
    pub fn chunks(&self) -> &[ListChunk] {
        &self.chunks
    }

    /// Entries of a particle are padded to a multiple of this number.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// The upper limit, exclusive, of base + entry.
    #[must_use]
    pub fn targets(&self) -> usize {
        match self.images {
            Images::Ghosts => self.table.rows(),
            Images::Folded => self.table.particle.len(),
        }
    }

    /// The number that entries use for the particle at `slot`.
    #[must_use]
    pub fn target_of(&self, slot: usize) -> u32 {
        match self.images {
            Images::Ghosts => self.table.row[slot],
            Images::Folded => slot as u32,
        }
    }

    /// Builds the list for positions in a box, with list radius `radius`, σ.
    ///
    /// The result is a pure function of the arguments and of the settings given to [`NeighborList::new`].
    ///
    /// # Errors
    /// [`GridError`] where a position is not a usable number.
    pub fn build(
        &mut self,
        cell: &PeriodicBox,
        radius: f64,
        positions: Positions<'_>,
        scanner: &dyn Scanner,
    ) -> Result<(), GridError> {
        let reach = Reach { r_cut: radius, r_list: radius };
        self.order(cell, reach, positions)?;
        self.table.place_all(cell, positions);
        self.fill(scanner, cell, reach);
        Ok(())
    }
}

impl PairList for NeighborList {
    fn cells(&self) -> Cells<'_> {
        Cells::Rows(&self.table)
    }

    fn particles(&self) -> &[u32] {
        &self.table.particle
    }

    fn source(&self) -> &[u32] {
        self.table.source()
    }

    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32> {
        let slots = self.table.slots();
        self.table.ghosts.iter().map(|ghost| slots[ghost.row as usize])
    }

    fn chunk_slots(&self) -> &ChunkSlots {
        &self.table.chunks
    }

    fn order(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError> {
        self.table.order(cell, positions, reach.r_list)
    }

    fn place(&mut self, cell: &PeriodicBox, at: &[DVec3]) {
        self.table.place(cell, |slot| at[slot]);
    }

    fn begin_part(&mut self, cell: &PeriodicBox, reach: Reach, whole: usize) -> Columns {
        self.table.begin_part(cell, whole, reach.r_list)
    }

    fn column_at(&self, cell: &PeriodicBox, r: DVec3) -> [u32; 2] {
        self.table.column_at(cell, r)
    }

    fn take_part(&mut self, belongs: &dyn Fn([u32; 2]) -> Belongs, numbers: &[u32]) {
        self.table.take_part(belongs, numbers);
    }

    fn whole(&self) -> usize {
        self.table.whole()
    }

    fn fill(&mut self, scanner: &dyn Scanner, cell: &PeriodicBox, reach: Reach) {
        self.table.show(cell);
        let margin = self.table.search_margin();
        let radius2 = (reach.r_list + margin).powi(2) as f32 * (1.0 + 4.0 * f32::EPSILON);
        self.chunks.resize_with(self.table.chunks.count(), ListChunk::default);
        let filler = Filler {
            table: &self.table,
            radius2,
            images: self.images,
            lanes: self.lanes,
            scanner,
            exclusions: self.exclusions,
        };
        // Room for the counts is taken together, ahead of all entries. Between entries it would part the room that they give back.
        for chunk in &mut self.chunks {
            chunk.counts.clear();
            chunk.counts.reserve_exact(ATOMS_PER_CHUNK);
        }
        for_each_item(self.chunks.iter_mut(), |scratch: &mut Scratch, c, chunk| {
            filler.fill(filler.table.chunks.of(c..c + 1), scratch, chunk);
        });
    }

    fn is_valid(&self) -> bool {
        let targets = self.targets() as u64;
        let slots_of = &self.table.chunks;
        for (c, chunk) in self.chunks.iter().enumerate() {
            let padded = |count: &u32| (*count as usize).next_multiple_of(self.lanes);
            let used: usize = chunk.counts.iter().map(padded).sum();
            let slots = slots_of.of(c..c + 1);
            let fits = chunk.first_slot as usize == slots.start
                && chunk.counts.len() == slots.len()
                && used <= chunk.entries.len();
            let reaches = |entry: u32| u64::from(chunk.base) + u64::from(entry) < targets;
            if !fits || !chunk.entries.offsets(0..used).into_iter().all(reaches) {
                return false;
            }
        }
        self.chunks.len() == slots_of.count()
    }

    fn pairs(&self) -> u64 {
        let entries: u64 = self.chunks.iter().flat_map(|c| &c.counts).map(|n| u64::from(*n)).sum();
        entries / 2
    }

    fn lanes_computed(&self) -> u64 {
        let padded = |count: &u32| u64::from(count.next_multiple_of(self.lanes as u32));
        self.chunks.iter().flat_map(|c| &c.counts).map(padded).sum()
    }

    fn bytes(&self) -> usize {
        let chunks: usize = self
            .chunks
            .iter()
            .map(|c| c.entries.bytes() + 4 * c.counts.capacity() + size_of::<ListChunk>())
            .sum();
        chunks + self.table.bytes()
    }

    fn list_bytes(&self) -> usize {
        self.bytes() - self.table.bytes()
    }

    fn neighbors(&self) -> Vec<Vec<u32>> {
        let mut all = vec![Vec::new(); self.table.particle.len()];
        for chunk in &self.chunks {
            let mut start = 0;
            for (offset, count) in chunk.counts.iter().enumerate() {
                let count = *count as usize;
                let slot = chunk.first_slot as usize + offset;
                let neighbors = &mut all[self.table.particle[slot] as usize];
                for entry in chunk.entries.offsets(start..start + count) {
                    let target = entry + chunk.base;
                    let slot = match self.images {
                        Images::Ghosts => self.table.slots()[target as usize],
                        Images::Folded => target,
                    };
                    neighbors.push(self.table.particle[slot as usize]);
                }
                neighbors.sort_unstable();
                start += count.next_multiple_of(self.lanes);
            }
        }
        all
    }

    /// # Panics
    /// Where entries number slots: such lists are not shared.
    fn for_each_slot(&self, chunk: usize, name: &mut dyn FnMut(u32)) {
        assert_eq!(self.images, Images::Ghosts, "entries number rows");
        let chunk = &self.chunks[chunk];
        // Padding names the slot itself.
        let padded = |count: &u32| (*count as usize).next_multiple_of(self.lanes);
        let used: usize = chunk.counts.iter().map(padded).sum();
        for entry in chunk.entries.offsets(0..used) {
            name(self.table.slots()[(chunk.base + entry) as usize]);
        }
    }
}

// The search that fills the chunks of a neighbor list.

/// Buffers that one thread reuses while it fills chunks.
#[derive(Default)]
pub struct Scratch {
    runs: Vec<Range<u32>>,
    candidates: Candidates,
    /// Entries of one chunk, which move into room that fits.
    narrow: Vec<u16>,
    wide: Vec<u32>,
}

/// Fills chunks; all chunks of a build share it.
pub struct Filler<'a> {
    pub table: &'a RowTable,
    /// The square of the search radius, σ².
    pub radius2: f32,
    pub images: Images,
    /// Entries of a slot are padded to a multiple of this number.
    pub lanes: usize,
    pub scanner: &'a dyn Scanner,
    /// Pairs that are left out.
    pub exclusions: Exclusions,
}

impl Filler<'_> {
    /// Writes the neighbors of `slots` to a chunk without counts.
    pub fn fill(&self, slots: Range<usize>, scratch: &mut Scratch, chunk: &mut ListChunk) {
        chunk.first_slot = slots.start as u32;
        let targets = match self.images {
            Images::Ghosts => self.table.rows_near(&slots),
            Images::Folded => 0..self.table.particle.len() as u32,
        };
        chunk.base = targets.start;
        let narrow = targets.end - targets.start <= u32::from(u16::MAX) + 1;
        let counts = &mut chunk.counts;
        let Scratch { runs, candidates, narrow: aside, wide } = scratch;
        let around = (runs, candidates);
        let old = std::mem::replace(&mut chunk.entries, Entries::Wide(Vec::new()));
        chunk.entries = if narrow {
            let mut entries = if let Entries::Narrow(entries) = old { entries } else { Vec::new() };
            let to: fn(&mut [_]) -> Found<'_> = |found| Found::Narrow(found);
            let how = (|number| number as u16, to);
            refill(&mut entries, self.write(slots, chunk.base, around, counts, aside, how));
            Entries::Narrow(entries)
        } else {
            let mut entries = if let Entries::Wide(entries) = old { entries } else { Vec::new() };
            let to: fn(&mut [_]) -> Found<'_> = |found| Found::Wide(found);
            let how = (|number| number, to);
            refill(&mut entries, self.write(slots, chunk.base, around, counts, wide, how));
            Entries::Wide(entries)
        };
    }

    /// Closes up entries over the particles that the particle at `slot` does not interact with; returns the count left.
    fn leave_out<E: Copy + Into<u32>>(&self, slot: usize, base: u32, found: &mut [E]) -> usize {
        let particle = &self.table.particle;
        let own = particle[slot] as usize;
        let mut kept = 0;
        for at in 0..found.len() {
            let entry = found[at];
            let other = match self.images {
                Images::Ghosts => self.table.slots()[(base + entry.into()) as usize],
                Images::Folded => entry.into(),
            };
            if !self.exclusions.exclude(own, particle[other as usize] as usize) {
                found[kept] = entry;
                kept += 1;
            }
        }
        kept
    }

    /// Writes the entries of `slots` over the ones of another chunk, and returns them.
    ///
    /// `of` gives the entry of a number, and `to` says how long entries are.
    fn write<'e, E: Copy + Default + Into<u32>>(
        &self,
        slots: Range<usize>,
        base: u32,
        (runs, candidates): (&mut Vec<Range<u32>>, &mut Candidates),
        counts: &mut Vec<u32>,
        entries: &'e mut Vec<E>,
        (of, to): (impl Fn(u32) -> E, for<'a> fn(&'a mut [E]) -> Found<'a>),
    ) -> &'e [E] {
        let table = self.table;
        let numbering = match self.images {
            Images::Ghosts => Numbering::Rows { base },
            Images::Folded => Numbering::Slots(table.padded_slots()),
        };
        let mut written = 0;
        let mut first = slots.start;
        while first < slots.end {
            let end = table.group_end(first, slots.end);
            table.runs_near(first, end - 1, runs);
            self.scanner.gather_rows(&table.coordinates, numbering, runs, candidates);
            for slot in first..end {
                let row = table.row[slot];
                let center =
                    Center { at: table.coordinates.at(row as usize), number: numbering.of(row) };
                let room = written + candidates.len + 2 * PADDING;
                if entries.len() < room {
                    entries.resize(room, E::default());
                }
                let found = &mut entries[written..];
                let mut count =
                    self.scanner.near(candidates, center, self.radius2, to(&mut *found));
                if !self.exclusions.are_none() {
                    count = self.leave_out(slot, base, &mut found[..count]);
                }
                let padded = count.next_multiple_of(self.lanes);
                found[count..padded].fill(of(center.number));
                counts.push(count as u32);
                written += padded;
            }
            first = end;
        }
        &entries[..written]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::ScalarScanner;
    use crate::rows::Entries;

    use super::*;

    #[test]
    fn a_list_with_an_entry_beyond_its_rows_is_not_valid() {
        let cell = PeriodicBox::new(DVec3::splat(9.0)).unwrap();
        let positions: Vec<DVec3> =
            (0..100).map(|k| DVec3::new(0.82, 0.67, 0.55) * f64::from(k)).collect();
        let mut list = NeighborList::new(Images::Ghosts, 4);
        list.build(&cell, 2.5, Positions::ById(&positions), &ScalarScanner).unwrap();
        assert!(list.is_valid());
        let good = list.clone();
        list.chunks[1].first_slot += 1;
        assert!(!list.is_valid());
        list = good.clone();
        list.chunks[0].counts[3] += 10_000;
        assert!(!list.is_valid());
        list = good;
        let beyond = (list.targets() - list.chunks[0].base as usize) as u16;
        let Entries::Narrow(entries) = &mut list.chunks[0].entries else {
            panic!("100 particles need no wide entries");
        };
        entries[2] = beyond;
        assert!(!list.is_valid());
    }
}
