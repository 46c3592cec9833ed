//! Cluster lists: one full list per cluster of four particles.
//!
//! ```text
//!   cluster         members at 4 consecutive slots: a b c d
//!   its list        every particle, by its nearest image, within r_list of a, b, c or d; each once
//!
//!   for all         | block | block | block | ...    each of a, b, c, d looks at all entries
//!   first half      | block |                        near to a or b, and to neither c nor d
//!   second half     | block |                        near to c or d, and to neither a nor b
//! ```
//!
//! The loop reads a block of sixteen neighbors once and computes it with all members: *cluster × single*.

use std::ops::Range;

use glam::DVec3;
use lennard_core::tasks::for_each_item;
use lennard_core::{Exclusions, PeriodicBox};

use super::block::Block;
use super::chunk::{ClusterBlocks, ClusterChunk};
use super::format::{CLUSTER, Reach};
use super::search::{Scratch, Search};
use crate::chunk_slots::{ATOMS_PER_CHUNK, ChunkSlots};
use crate::pair_list::PairList;
use crate::scanner::Scanner;
use crate::sort::{Belongs, Cells, ColumnTable, Columns, FixedRow, GridError, Positions};

/// Full lists in fixed point, one per cluster.
///
/// A list contains every particle within the list radius of a member once, by its nearest image. A particle near to
/// one half of the cluster alone is kept apart where that saves work: the other half does not look at it.
#[derive(Debug, Clone, Default)]
pub struct ClusterList {
    table: ColumnTable,
    chunks: Vec<ClusterChunk>,
    slots_ahead: usize,
    exclusions: Exclusions,
    /// The slot of each particle, `[N]`, where pairs are excluded.
    slot_of: Vec<u32>,
}

impl ClusterList {
    /// The same list, in which each build leaves these pairs out.
    #[must_use]
    pub fn excluding(self, exclusions: Exclusions) -> Self {
        Self { exclusions, ..self }
    }

    /// Lends the room of rows to a build, or takes it back; see [`ColumnTable::swap_room`].
    pub fn swap_room(&mut self, rows: &mut Vec<FixedRow>) {
        self.table.swap_room(rows);
    }

    /// The sorted particles.
    #[must_use]
    pub fn table(&self) -> &ColumnTable {
        &self.table
    }

    /// The lists, chunk by chunk.
    #[must_use]
    pub fn chunks(&self) -> &[ClusterChunk] {
        &self.chunks
    }

    /// The approximate distance in slots from a cluster to its last neighbor: rows farther ahead can be prefetched.
    #[must_use]
    pub fn slots_ahead(&self) -> usize {
        self.slots_ahead
    }

    /// Builds the lists for positions in a box: a pure function of the arguments.
    ///
    /// The list radius is at most half the shortest side of the box.
    ///
    /// # Errors
    /// [`GridError`] where a position is not a usable number.
    pub fn build(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
        scanner: &dyn Scanner,
    ) -> Result<(), GridError> {
        self.order(cell, reach, positions)?;
        self.table.place_all(cell, positions);
        self.fill(scanner, cell, reach);
        Ok(())
    }
}

impl PairList for ClusterList {
    const INSERTS: bool = true;

    /// Distances in fixed point are off by about one unit of the longest side, and singles by their last place.
    fn rounding(cell: &PeriodicBox, r_cut: f64) -> f64 {
        4.0 * cell.lengths().max_element() * f64::from(f32::EPSILON) / 256.0
            + 4.0 * r_cut * f64::from(f32::EPSILON)
    }

    fn cells(&self) -> Cells<'_> {
        Cells::Columns(&self.table)
    }

    fn particles(&self) -> &[u32] {
        &self.table.particle
    }

    fn source(&self) -> &[u32] {
        self.table.source()
    }

    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32> {
        std::iter::empty()
    }

    fn chunk_slots(&self) -> &ChunkSlots {
        &self.table.chunks
    }

    fn order(
        &mut self,
        cell: &PeriodicBox,
        _reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError> {
        self.table.order(cell, positions)
    }

    fn place(&mut self, cell: &PeriodicBox, at: &[DVec3]) {
        self.table.place(cell, |slot| at[slot]);
    }

    fn begin_part(&mut self, cell: &PeriodicBox, _reach: Reach, whole: usize) -> Columns {
        self.table.begin_part(cell, whole)
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
        let n = self.table.particle.len();
        self.slots_ahead = self.table.grid.slots_ahead(cell.lengths(), reach.r_list, self.whole());
        self.chunks.resize_with(self.table.chunks.count(), ClusterChunk::default);
        if !self.exclusions.are_none() {
            self.slot_of.resize(n, 0);
            for (slot, particle) in (0..).zip(&self.table.particle) {
                self.slot_of[*particle as usize] = slot;
            }
        }
        let exclusions = (&self.exclusions, &self.slot_of[..]);
        let search = Search::new(&self.table, cell, reach, scanner, exclusions);
        let slots_of = &self.table.chunks;
        // Room for the ends is taken together, ahead of all blocks. Between blocks it would part the room that they give back.
        for chunk in &mut self.chunks {
            chunk.clear(ATOMS_PER_CHUNK / CLUSTER);
        }
        for_each_item(self.chunks.iter_mut(), |scratch: &mut Scratch, c, chunk| {
            search.fill(slots_of.of(c..c + 1), scratch, chunk);
        });
    }

    fn is_valid(&self) -> bool {
        let n = self.table.particle.len();
        let fits = |(c, chunk): (usize, &ClusterChunk)| {
            let slots = self.table.chunks.of(c..c + 1);
            chunk.first_slot as usize == slots.start
                && chunk.end_slot as usize == slots.end
                && chunk.spans.len() == slots.len().div_ceil(CLUSTER)
                && chunk.is_valid(n)
        };
        self.chunks.len() == self.table.chunks.count() && self.chunks.iter().enumerate().all(fits)
    }

    fn key(&self, slot: u32) -> [u32; 2] {
        self.table.key(slot)
    }

    /// An end that has no list here counts as listed.
    fn contains(&self, [a, b]: [u32; 2]) -> bool {
        [(a, b), (b, a)].into_iter().all(|(own, other)| {
            own as usize >= self.own()
                || self.chunks[self.table.chunks.chunk_of(own)].contains(own, other)
        })
    }

    fn insert(&mut self, [a, b]: [u32; 2]) {
        for (own, other) in [(a, b), (b, a)] {
            if own as usize >= self.own() {
                continue;
            }
            let chunk = &mut self.chunks[self.table.chunks.chunk_of(own)];
            if !chunk.contains(own, other) {
                chunk.insert(own, other, self.table.grid.all_in_reach);
            }
        }
    }

    fn pairs(&self) -> u64 {
        let lists = self.chunks.iter().flat_map(ClusterChunk::lists);
        let of_cluster = |(slots, list): (Range<usize>, ClusterBlocks<'_>)| -> u64 {
            (0..slots.len())
                .flat_map(|member| list.for_member(member))
                .map(|block| u64::from(block.valid.count_ones()))
                .sum()
        };
        // Members are entries of their own lists, and so are the particles that they do not interact with.
        let members = &self.table.particle[..self.own()];
        let excluded = members.iter().map(|i| self.exclusions.of(*i).count());
        let not_pairs = members.len() + excluded.sum::<usize>();
        (lists.map(of_cluster).sum::<u64>() - not_pairs as u64) / 2
    }

    fn lanes_computed(&self) -> u64 {
        let lists = self.chunks.iter().flat_map(ClusterChunk::lists);
        lists.map(|(_, list)| list.lanes() as u64).sum()
    }

    fn bytes(&self) -> usize {
        let chunks: usize = self.chunks.iter().map(ClusterChunk::bytes).sum();
        self.table.bytes()
            + 4 * self.slot_of.capacity()
            + chunks
            + self.chunks.capacity() * size_of::<ClusterChunk>()
    }

    fn list_bytes(&self) -> usize {
        self.bytes() - self.table.bytes()
    }

    /// A neighbor of one member is listed for other members too, near or not.
    fn neighbors(&self) -> Vec<Vec<u32>> {
        let particle = &self.table.particle;
        let mut all = vec![Vec::new(); particle.len()];
        for chunk in &self.chunks {
            for (cluster, list) in chunk.lists() {
                for own in cluster.clone() {
                    let neighbors = &mut all[particle[own] as usize];
                    let slots = list.for_member(own - cluster.start).flat_map(Block::slots);
                    let others = slots.filter(|slot| {
                        let (own, other) =
                            (particle[own] as usize, particle[*slot as usize] as usize);
                        own != other && !self.exclusions.exclude(own, other)
                    });
                    neighbors.extend(others.map(|slot| particle[slot as usize]));
                    neighbors.sort_unstable();
                }
            }
        }
        all
    }

    fn for_each_slot(&self, chunk: usize, name: &mut dyn FnMut(u32)) {
        let chunk = &self.chunks[chunk];
        let end = chunk.spans.last().map_or(0, |span| span.end as usize);
        let named = chunk.blocks[..end].iter().flat_map(Block::slots);
        named.for_each(name);
    }
}
