//! Full Verlet lists in chunks of constant size.

use std::ops::Range;

use glam::DVec3;
use lennard_core::parallel::part;
use lennard_core::tasks::for_each_item;
use lennard_core::{Exclusions, PeriodicBox};

use super::chunk::{ATOMS_PER_CHUNK, Images, ListChunk};
use super::fill::{Filler, Scratch};
use crate::clusters::Reach;
use crate::pair_list::{OwnChunks, PairList, slots_of};
use crate::scanner::Scanner;
use crate::sort::{Cells, GridError, Positions, RowTable};

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
    own_chunks: OwnChunks,
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
            own_chunks: OwnChunks::default(),
        }
    }

    /// The same list, from which each build leaves these pairs out.
    #[must_use]
    pub fn excluding(self, exclusions: Exclusions) -> Self {
        Self { exclusions, ..self }
    }

    /// The chunks whose lists are kept.
    #[must_use]
    pub fn own(&self) -> Range<usize> {
        self.own_chunks.of(self.chunks.len())
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

    fn order(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError> {
        self.table.order(cell, positions, reach.r_list)
    }

    fn place(&mut self, cell: &PeriodicBox, runs: &[Range<usize>], at: &[DVec3]) {
        self.table.place(cell, runs, |slot| at[slot]);
    }

    fn fill(&mut self, scanner: &dyn Scanner, cell: &PeriodicBox, reach: Reach) {
        self.table.show(cell);
        let margin = self.table.search_margin();
        let radius2 = (reach.r_list + margin).powi(2) as f32 * (1.0 + 4.0 * f32::EPSILON);
        let n = self.table.particle.len();
        self.chunks.resize_with(n.div_ceil(ATOMS_PER_CHUNK), ListChunk::default);
        let filler = Filler {
            table: &self.table,
            radius2,
            images: self.images,
            lanes: self.lanes,
            scanner,
            exclusions: self.exclusions,
        };
        let own = self.own();
        let chunks = self.chunks[own.clone()].iter_mut();
        for_each_item(chunks, |scratch: &mut Scratch, c, chunk| {
            let slots = part(own.start + c, ATOMS_PER_CHUNK, n);
            filler.fill(slots, scratch, chunk);
        });
    }

    fn is_valid(&self) -> bool {
        let targets = self.targets() as u64;
        let own = self.own();
        let of_own = slots_of(&own, self.table.particle.len());
        let mut slots = of_own.start;
        for chunk in &self.chunks[own] {
            let padded = |count: &u32| (*count as usize).next_multiple_of(self.lanes);
            let used: usize = chunk.counts.iter().map(padded).sum();
            let fits = chunk.first_slot as usize == slots && used <= chunk.entries.len();
            let reaches = |entry: u32| u64::from(chunk.base) + u64::from(entry) < targets;
            if !fits || !chunk.entries.offsets(0..used).into_iter().all(reaches) {
                return false;
            }
            slots += chunk.counts.len();
        }
        slots == of_own.end
    }

    fn keep(&mut self, own: Range<usize>) {
        self.own_chunks = OwnChunks::alone(own, &mut self.chunks);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ScalarScanner, rows::Entries};
    use glam::DVec3;

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
