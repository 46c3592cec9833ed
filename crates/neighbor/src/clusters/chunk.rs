//! The part of a cluster list that one task reads.
//!
//! ```text
//!   slots     | s  s+1 s+2 s+3 | s+4 ...        4 consecutive slots are a cluster: 2 + 2 members in halves
//!   clusters  |   cluster 0    |  cluster 1 ...
//!
//!   blocks of cluster k, between the ends that its span stores:
//!
//!   begin        first_half    second_half      masked           end
//!     |  for members  |  for members  |  for all,     |  for all,     |
//!     |  0 and 1      |  2 and 3      |  with a mask  |  every entry  |
//!
//!   The first masked block begins with the members themselves, so that each member can be excluded from its own list.
//!   Where particles are bonded, the other ends of the members' bonds come next, and each masked block has a mask per member.
//! ```

use std::ops::Range;

use super::block::{Block, pack, push, worthwhile};
use super::format::{BLOCK, BLOCK_REACH, CLUSTER};
use super::found::{
    ALL_MEMBERS, ClusterNeighbors, Excluded, ExcludedEntries, FIRST_HALF, SECOND_HALF,
};
use crate::room::{give_back, make_room, refill};

/// The ends of the blocks of one cluster, by kind, among the blocks of its chunk.
///
/// Each kind begins where the kind before it ends. The first kind begins at the end of the cluster before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// End of the blocks for the first two members; not every entry counts.
    pub first_half: u32,
    /// End of the blocks for the last two members; not every entry counts.
    pub second_half: u32,
    /// End of the blocks for all members in which not every entry counts. The first one begins with the members.
    pub masked: u32,
    /// End of the blocks for all members in which every entry counts.
    pub end: u32,
    /// Whether a loop may take all coordinates relative to the [`cluster_center`](super::cluster_center).
    ///
    /// The members are close together and the box is wide: no neighbor lies more than half a box from the center.
    pub compact: bool,
}

impl Span {
    /// Number of blocks for all members in which not every entry counts.
    #[must_use]
    pub fn masked_blocks(&self) -> usize {
        (self.masked - self.second_half) as usize
    }
}

/// The lists of up to [`crate::ATOMS_PER_CHUNK`] consecutive slots.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ClusterChunk {
    /// The first slot.
    pub first_slot: u32,
    /// The end of the slots. The last cluster may have fewer members than the others.
    pub end_slot: u32,
    /// Whether one sum can serve all members of each cluster.
    ///
    /// The last cluster has four members, or a loop can place the ones that it lacks far away, since it is compact. Small systems
    /// keep sums of each member there.
    pub sums_in_common: bool,
    /// The ends of each cluster's blocks.
    pub spans: Vec<Span>,
    /// The blocks of one cluster after another, and a last one that belongs to no cluster.
    pub blocks: Vec<Block>,
    /// The entries that each member does not look at, one set per masked block of the chunk.
    ///
    /// It is empty where no pairs are excluded but each member with itself.
    pub excluded: Vec<ExcludedEntries>,
}

/// The blocks of one cluster by kind.
#[derive(Debug, Clone, Copy)]
pub struct ClusterBlocks<'a> {
    /// For the first two members; not every entry counts.
    pub first_half: &'a [Block],
    /// For the last two members; not every entry counts.
    pub second_half: &'a [Block],
    /// For all members; not every entry counts.
    pub masked: &'a [Block],
    /// For all members; every entry counts.
    pub plain: &'a [Block],
}

impl ClusterBlocks<'_> {
    /// The blocks that one member looks at.
    pub fn for_member(&self, member: usize) -> impl Iterator<Item = &Block> {
        let half = if 2 * member < CLUSTER { self.first_half } else { self.second_half };
        half.iter().chain(self.masked).chain(self.plain)
    }

    /// Number of lanes that a loop computes.
    #[must_use]
    pub fn lanes(&self) -> usize {
        let for_half = self.first_half.len() + self.second_half.len();
        let for_all = self.masked.len() + self.plain.len();
        BLOCK * (CLUSTER / 2 * for_half + CLUSTER * for_all)
    }
}

impl ClusterChunk {
    /// The blocks of cluster `k`.
    #[must_use]
    fn list(&self, k: usize) -> ClusterBlocks<'_> {
        let span = &self.spans[k];
        let begin = if k == 0 { 0 } else { self.spans[k - 1].end };
        let between = |from: u32, to: u32| &self.blocks[from as usize..to as usize];
        ClusterBlocks {
            first_half: between(begin, span.first_half),
            second_half: between(span.first_half, span.second_half),
            masked: between(span.second_half, span.masked),
            plain: between(span.masked, span.end),
        }
    }

    /// The slots and the blocks of each cluster.
    pub fn lists(&self) -> impl Iterator<Item = (Range<usize>, ClusterBlocks<'_>)> {
        let slots = self.first_slot as usize..self.end_slot as usize;
        let firsts = slots.step_by(CLUSTER).zip(0..self.spans.len());
        firsts
            .map(|(first, k)| (first..(first + CLUSTER).min(self.end_slot as usize), self.list(k)))
    }

    /// The number of the cluster of a slot, and the number of the slot among the members.
    fn address(&self, slot: u32) -> [usize; 2] {
        let in_chunk = (slot - self.first_slot) as usize;
        [in_chunk / CLUSTER, in_chunk % CLUSTER]
    }

    /// Whether the list for the member at a slot contains another slot.
    pub(super) fn contains(&self, own: u32, slot: u32) -> bool {
        let [k, member] = self.address(own);
        self.list(k).for_member(member).any(|block| block.contains(slot))
    }

    /// Inserts a slot into the list of the cluster of another slot, for all members; one member does not have it yet.
    ///
    /// Where `is_one_base`, one base reaches all slots: no block has parts, and a free entry takes the slot. Elsewhere the numbers of
    /// slots decide where blocks have parts, and which blocks are masked. The order of the sums must not depend on it: whole blocks
    /// go behind the first masked one.
    pub(super) fn insert(&mut self, own: u32, slot: u32, is_one_base: bool) {
        let [k, _] = self.address(own);
        let begin = if k == 0 { 0 } else { self.spans[k - 1].end as usize };
        let Span { first_half, second_half, masked, .. } = self.spans[k];
        let [first_half, second_half, masked] =
            [first_half, second_half, masked].map(|end| end as usize);
        let end = if is_one_base { masked } else { self.end_of_parts(second_half, masked) };
        if let Some(block) = (begin..second_half).find(|block| self.blocks[*block].contains(slot)) {
            // One half has the slot. Its block becomes a masked one, which all members look at.
            let of_first = block < first_half;
            let start = (begin..=block).rfind(|block| self.blocks[*block].is_first_part());
            let start = start.expect("a half begins with a whole block");
            let next = self.end_of_parts(start, if of_first { first_half } else { second_half });
            self.blocks[start..end].rotate_left(next - start);
            let moved = (next - start) as u32;
            let span = &mut self.spans[k];
            span.first_half -= if of_first { moved } else { 0 };
            span.second_half -= moved;
            self.look_at_all_of(k, end - (next - start)..end);
            return;
        }
        if is_one_base
            && self.blocks[second_half..masked].iter_mut().any(|block| block.insert(slot))
        {
            return;
        }
        make_room(&mut self.blocks, 1);
        self.blocks.insert(end, Block::of(slot, &[slot]));
        let span = &mut self.spans[k];
        span.masked += 1;
        span.end += 1;
        for span in &mut self.spans[k + 1..] {
            span.first_half += 1;
            span.second_half += 1;
            span.masked += 1;
            span.end += 1;
        }
        self.look_at_all_of(k, end..end + 1);
    }

    /// The end of the parts of a whole block that begins with one of the blocks, before an end of such blocks.
    fn end_of_parts(&self, first: usize, end: usize) -> usize {
        let mut others = first + 1..end;
        others.find(|block| self.blocks[*block].is_first_part()).unwrap_or(end)
    }

    /// Inserts empty masks for new masked blocks of cluster `k`, by their places among all blocks.
    fn look_at_all_of(&mut self, k: usize, blocks: Range<usize>) {
        if !self.excluded.is_empty() {
            let before: usize = self.spans[..k].iter().map(Span::masked_blocks).sum();
            let first = before + blocks.start - self.spans[k].second_half as usize;
            let none = blocks.map(|_| ExcludedEntries::default());
            self.excluded.splice(first..first, none);
        }
    }

    /// Removes all lists, and makes room for the ends of so many.
    pub(super) fn clear(&mut self, clusters: usize) {
        self.spans.clear();
        self.blocks.clear();
        self.excluded.clear();
        self.spans.reserve_exact(clusters);
    }

    /// Takes the room of other blocks for a build, and lends its own room meanwhile. No room holds blocks.
    pub(super) fn move_to(&mut self, aside: &mut Vec<Block>) {
        aside.clear();
        std::mem::swap(&mut self.blocks, aside);
    }

    /// Moves blocks that were built aside to the room of before, or to new room that fits.
    pub(super) fn move_back(&mut self, aside: &mut Vec<Block>) {
        std::mem::swap(&mut self.blocks, aside);
        refill(&mut self.blocks, aside);
    }

    /// Adds the list of a cluster, whose neighbors in columns that share no blocks with it are `far`.
    ///
    /// `base` is a base that is known to reach all of its other neighbors, if there is one.
    /// `excluded` has the pairs that do not interact, where there are other pairs than each member with itself.
    pub(super) fn push(
        &mut self,
        (found, far): (&mut ClusterNeighbors, &[u32]),
        compact: bool,
        base: Option<u32>,
        excluded: Option<&Excluded>,
    ) {
        let [blocks_of_first, blocks_of_second] = worthwhile(found.len);
        self.push_half(found, FIRST_HALF, blocks_of_first, base);
        let first_half = self.blocks.len();
        self.push_half(found, SECOND_HALF, blocks_of_second, base);
        let second_half = self.blocks.len();
        let head = CLUSTER + excluded.map_or(0, |e| e.slots().len());
        // Excluded slots may lie beyond all near ones.
        let base = base.filter(|base| {
            excluded.is_none_or(|e| {
                e.slots().iter().all(|slot| slot.wrapping_sub(*base) <= BLOCK_REACH)
            })
        });
        let masked = pack([found.of(ALL_MEMBERS), far], base, head, &mut self.blocks);
        if let Some(excluded) = excluded {
            let blocks = &self.blocks[second_half..masked];
            self.excluded.extend(blocks.iter().map(|block| excluded.entries(block)));
        }
        self.spans.push(Span {
            first_half: first_half as u32,
            second_half: second_half as u32,
            masked: masked as u32,
            end: self.blocks.len() as u32,
            compact,
        });
    }

    /// Writes at most `blocks` blocks of the neighbors of one half, and moves the rest to the neighbors of all members.
    fn push_half(
        &mut self,
        found: &mut ClusterNeighbors,
        half: usize,
        blocks: usize,
        base: Option<u32>,
    ) {
        let mut used = 0;
        for _ in 0..blocks {
            let (slots, count) = found.next_of(half, used);
            match base {
                Some(base) => self.blocks.push(Block::of_first(slots, count, base)),
                None => push(&slots[..count], None, &mut self.blocks),
            }
            used += count;
        }
        found.give_to_all(half, used);
    }

    /// Ends the lists with a block that belongs to no cluster, for loops that read one block ahead.
    pub(super) fn finish(&mut self) {
        self.blocks.push(Block::of(self.first_slot, &[self.first_slot]));
    }

    /// Gives back room that the blocks do not need.
    pub(super) fn give_back(&mut self) {
        give_back(&mut self.blocks);
    }

    /// Number of bytes held beyond the structure itself.
    pub(super) fn bytes(&self) -> usize {
        self.spans.capacity() * size_of::<Span>()
            + self.blocks.capacity() * size_of::<Block>()
            + self.excluded.capacity() * size_of::<ExcludedEntries>()
    }

    /// Whether spans ascend to the last block, and every entry numbers a slot below `n`.
    pub(super) fn is_valid(&self, n: usize) -> bool {
        let mut end = 0;
        for span in &self.spans {
            let ends = [end, span.first_half, span.second_half, span.masked, span.end];
            if !ends.is_sorted() {
                return false;
            }
            end = span.end;
        }
        let in_range = |block: &Block| block.highest_slot() < n as u64;
        let masked: usize = self.spans.iter().map(Span::masked_blocks).sum();
        (self.excluded.is_empty() || self.excluded.len() == masked)
            && end as usize + 1 == self.blocks.len()
            && self.blocks.iter().all(in_range)
    }
}
