//! Blocks: sixteen neighbors in the format that the cluster loop reads.
//!
//! ```text
//!   Block, 38 bytes:
//!   +------+-------+----+----+----+-- ... --+-----+
//!   | base | valid | e0 | e1 | e2 |         | e15 |
//!   +------+-------+----+----+----+-- ... --+-----+
//!     u32    16 bits  16 entries of 16 bits
//!
//!   slot of entry k = base + ek / ENTRY_SCALE
//!   entry k counts where bit k of `valid` is set; an entry that does not count numbers any slot that exists
//! ```

use crate::clusters::format::{BLOCK, BLOCK_REACH, CLUSTER, ENTRY_SCALE};

/// Up to [`BLOCK`] neighbors of a cluster.
///
/// It has no padding behind its end: lists are the largest part of the memory of a large system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C, packed(2))]
pub struct Block {
    /// The number that is added to each entry to give a slot.
    pub base: u32,
    /// The entries that count, one bit each; every other entry numbers any slot that exists.
    pub valid: u16,
    /// [`ENTRY_SCALE`] times the slots minus the base.
    pub entries: [u16; BLOCK],
}

impl Block {
    /// A block of [`BLOCK`] slots.
    pub(super) fn full(base: u32, slots: &[u32; BLOCK]) -> Self {
        Self {
            base,
            valid: u16::MAX,
            entries: slots.map(|slot| (slot - base) as u16 * ENTRY_SCALE),
        }
    }

    /// A block of the first `count` of some slots, which a base reaches.
    pub(super) fn of_first(slots: &[u32; BLOCK], count: usize, base: u32) -> Self {
        let mut entries = [0; BLOCK];
        for ((entry, slot), k) in entries.iter_mut().zip(slots).zip(0..) {
            // There is no branch: an entry that does not count numbers the base.
            let counts = if k < count as u16 { u16::MAX } else { 0 };
            *entry = (slot.wrapping_sub(base) as u16).wrapping_mul(ENTRY_SCALE) & counts;
        }
        Self { base, valid: u16::MAX >> (BLOCK - count), entries }
    }

    /// A block of 1 to [`BLOCK`] slots, which a base reaches.
    pub(super) fn of(base: u32, slots: &[u32]) -> Self {
        let mut all = [base; BLOCK];
        all[..slots.len()].copy_from_slice(slots);
        Self { valid: u16::MAX >> (BLOCK - slots.len()), ..Self::full(base, &all) }
    }

    /// Whether the block contains a slot.
    pub(super) fn contains(&self, slot: u32) -> bool {
        self.slots().any(|contained| contained == slot)
    }

    /// Whether it is a whole block or the first part of one: later parts have no entry in the first lane.
    pub(super) fn is_first_part(&self) -> bool {
        self.valid & 1 == 1
    }

    /// Inserts a slot where an entry is free; returns whether one was. All slots have to be in reach of each other: the base becomes
    /// lower where the slot is. So it does not depend on the numbers of slots which entry takes it.
    pub(super) fn insert(&mut self, slot: u32) -> bool {
        let free = self.valid.trailing_ones() as usize;
        if free == BLOCK {
            return false;
        }
        let base = self.base.min(slot);
        let lower = (self.base - base) as u16 * ENTRY_SCALE;
        self.entries = { self.entries }.map(|entry| entry + lower);
        self.base = base;
        self.valid |= 1 << free;
        self.entries[free] = (slot - base) as u16 * ENTRY_SCALE;
        true
    }

    /// The slot of entry `k`; `None` where it does not count.
    pub(super) fn slot(&self, k: usize) -> Option<u32> {
        (self.valid >> k & 1 == 1).then(|| self.base + u32::from(self.entries[k] / ENTRY_SCALE))
    }

    /// The slots that count.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        let block = *self;
        (0..BLOCK).filter_map(move |k| block.slot(k))
    }

    /// The highest slot that an entry numbers, whether it counts or not.
    pub(super) fn highest_slot(&self) -> u64 {
        let highest = self.entries.iter().copied().max().unwrap_or(0);
        u64::from(self.base) + u64::from(highest / ENTRY_SCALE)
    }
}

/// The base of a block of some slots: the lowest of them. `None` where it does not reach the highest.
fn base_of(slots: &[u32]) -> Option<u32> {
    let low = slots.iter().copied().min().unwrap_or_default();
    let high = slots.iter().copied().max().unwrap_or_default();
    (high - low <= BLOCK_REACH).then_some(low)
}

// How neighbors of a cluster are distributed over blocks.

/// How many blocks for the first half, and how many for the second half, save operations of the loop.
///
/// The arguments are the numbers of neighbors of all members, of the first half alone and of the second half alone.
/// A partly filled block for a half can cost more than room for the same neighbors in a block for all.
/// No block of the result would be empty.
pub(super) fn worthwhile([for_all, of_first, of_second]: [usize; 3]) -> [usize; 2] {
    // Operations of the loop: 28 to read and convert a block, and 20 per member that looks at it.
    const FOR_HALF: usize = 28 + 20 * CLUSTER / 2;
    const FOR_ALL: usize = 28 + 20 * CLUSTER;
    let (mut best, mut least) = ([0; 2], usize::MAX);
    // Full blocks always save operations.
    for first in of_first / BLOCK..=of_first.div_ceil(BLOCK) {
        for second in of_second / BLOCK..=of_second.div_ceil(BLOCK) {
            let beyond =
                of_first.saturating_sub(first * BLOCK) + of_second.saturating_sub(second * BLOCK);
            let operations =
                (first + second) * FOR_HALF + (for_all + beyond).div_ceil(BLOCK) * FOR_ALL;
            if operations < least {
                (best, least) = ([first, second], operations);
            }
        }
    }
    best
}

/// Writes neighbors into blocks, near ones and far ones into blocks of their own, and masked blocks before full ones.
///
/// Returns the end of the masked blocks. They hold at least the first `head` slots: the members, and what they do not interact
/// with. `base` is a base that is known to reach all near slots, if there is one. No other number of a slot changes which slots
/// share a block, in which lanes, and in which order.
pub(super) fn pack(
    [near, far]: [&[u32]; 2],
    base: Option<u32>,
    head: usize,
    blocks: &mut Vec<Block>,
) -> usize {
    // The first block takes the slots that do not fill whole blocks.
    let rest = near.len() % BLOCK;
    let lead = match rest {
        0 => BLOCK,
        rest if rest < head => (BLOCK + rest).min(near.len()),
        _ => rest,
    };
    let (lead, full) = near.split_at(lead);
    let (far_lead, far_full) = far.split_at(far.len() % BLOCK);
    if let (Some(base), Some(slots), true) = (base, near.first_chunk(), lead.len() < BLOCK) {
        // An entry that does not count may number any slot.
        let mut block = Block::full(base, slots);
        block.valid = u16::MAX >> (BLOCK - lead.len());
        blocks.push(block);
    } else {
        lead.chunks(BLOCK).for_each(|slots| push(slots, base, blocks));
    }
    push(far_lead, None, blocks);
    let mut masked = blocks.len();
    let (full, none) = full.as_chunks();
    debug_assert!(none.is_empty(), "the rest fills whole blocks");
    let (far_full, _) = far_full.as_chunks();
    for (full, base) in [(full, base), (far_full, None)] {
        for slots in full {
            if let Some(base) = base.or_else(|| base_of(slots)) {
                blocks.push(Block::full(base, slots));
            } else {
                // The parts of a block are masked, and so are the blocks before it: the order stays.
                part(slots, blocks);
                masked = blocks.len();
            }
        }
    }
    masked
}

/// Writes at most [`BLOCK`] slots: as one block where one base reaches them, and elsewhere as parts of it.
///
/// `base` is a base that is known to reach them, if there is one.
pub(super) fn push(slots: &[u32], base: Option<u32>, blocks: &mut Vec<Block>) {
    match base.or_else(|| base_of(slots)) {
        _ if slots.is_empty() => {}
        Some(base) => blocks.push(Block::of(base, slots)),
        None => part(slots, blocks),
    }
}

/// Writes the parts of a block of slots that no one base reaches.
///
/// Each slot counts in one part, in its lane. All other lanes of a part add nothing, so that sums have the bits of one block.
/// The first part has the members, where the first slots are they.
#[cold]
fn part(slots: &[u32], blocks: &mut Vec<Block>) {
    let mut left = u16::MAX >> (BLOCK - slots.len());
    while left != 0 {
        let members = slots[left.trailing_zeros() as usize] + CLUSTER as u32 - 1;
        let lanes = || slots.iter().enumerate().filter(|(k, _)| left >> k & 1 == 1);
        let in_reach = lanes().map(|(_, slot)| *slot).filter(|slot| slot + BLOCK_REACH >= members);
        let base = in_reach.min().expect("the first one that is left");
        let mut block = Block { base, valid: 0, entries: [0; BLOCK] };
        for (k, slot) in lanes().filter(|(_, slot)| (base..=base + BLOCK_REACH).contains(slot)) {
            block.valid |= 1 << k;
            block.entries[k] = (slot - base) as u16 * ENTRY_SCALE;
        }
        left &= !block.valid;
        blocks.push(block);
    }
}

#[cfg(test)]
mod tests {
    use crate::clusters::{Block, ClusterChunk, ClusterNeighbors, ENTRY_SCALE};
    use crate::sort::PADDING;

    use super::*;

    /// Slots in this order: members and neighbors of all, then of the first half, then of the second half.
    fn found(len: [usize; 3]) -> ClusterNeighbors {
        let room = len.iter().sum::<usize>() + PADDING;
        let mut first = 0;
        let slots = len.map(|len| {
            let mut slots: Vec<u32> = (first..first + len as u32).collect();
            first += len as u32;
            // Elements behind the count have no meaning.
            slots.resize(room, u32::MAX);
            slots
        });
        let mut found = ClusterNeighbors::default();
        (found.slots, found.len) = (slots, len);
        found
    }

    #[test]
    fn no_other_numbers_of_blocks_for_halves_take_fewer_operations() {
        assert_eq!(worthwhile([68, 28, 28]), [1, 2]);
        assert_eq!(worthwhile([68, 28, 13]), [1, 1]);
        assert_eq!(worthwhile([60, 16, 4]), [1, 0], "four find room");
        assert_eq!(worthwhile([64, 33, 12]), [2, 0], "thirteen fill one block for all");
        for len in [[4, 0, 0], [4, 1, 0], [70, 26, 31], [61, 16, 48], [90, 5, 47]] {
            let cost = |[first, second]: [usize; 2]| {
                let rest = |len: usize, blocks: usize| len.saturating_sub(blocks * BLOCK);
                let for_all = len[0] + rest(len[1], first) + rest(len[2], second);
                (first + second) * 68 + for_all.div_ceil(BLOCK) * 108
            };
            let chosen = worthwhile(len);
            let others = (0..5).flat_map(|first| (0..5).map(move |second| [first, second]));
            assert!(others.map(cost).all(|other| cost(chosen) <= other), "{len:?}");
            assert!(chosen[0] <= len[1].div_ceil(BLOCK) && chosen[1] <= len[2].div_ceil(BLOCK));
        }
    }

    /// The lanes that a member looks at, in the order of its sums: parts are put together.
    fn lanes_of(
        chunk: &ClusterChunk,
        member: usize,
        number: impl Fn(u32) -> u32,
    ) -> Vec<Vec<Option<u32>>> {
        let mut whole: Vec<Vec<Option<u32>>> = Vec::new();
        for block in chunk.lists().next().unwrap().1.for_member(member) {
            let lanes = (0..BLOCK).map(|k| block.slot(k).map(&number));
            match whole.last_mut() {
                Some(whole) if !block.is_first_part() => {
                    whole.iter_mut().zip(lanes).for_each(|(lane, other)| *lane = lane.or(other));
                }
                _ => whole.push(lanes.collect()),
            }
        }
        whole
    }

    #[test]
    fn insertions_keep_the_order_of_sums_whatever_the_numbers_of_slots() {
        // Each third neighbor is out of reach of the others: its block has parts.
        let far =
            |slot: u32| if slot >= 6 && slot.is_multiple_of(3) { slot + 90_000 } else { slot };
        let near = |slot: u32| if slot >= 90_000 { slot - 90_000 } else { slot };
        for len in [[68, 28, 28], [64, 33, 12], [70, 16, 48], [5, 33, 40], [90, 5, 47]] {
            let chunks = [&(|slot| slot) as &dyn Fn(u32) -> u32, &far].map(|slot_of| {
                let mut chunk =
                    ClusterChunk { end_slot: CLUSTER as u32, ..ClusterChunk::default() };
                let mut found = found(len);
                found.slots.iter_mut().flatten().for_each(|slot| {
                    if *slot != u32::MAX {
                        *slot = slot_of(*slot);
                    }
                });
                chunk.push((&mut found, &[]), false, None, None);
                chunk.finish();
                // Neighbors of a half, and slots that no member lists.
                let [all, first, second] = len.map(|len| len as u32);
                let inserted = [all + 1, 500, all + first + 2, 501, 720, all + first + second - 1];
                for slot in inserted.map(slot_of) {
                    for own in [0, 2] {
                        if !chunk.contains(own, slot) {
                            chunk.insert(own, slot, false);
                        }
                    }
                }
                assert!(chunk.is_valid(100_000));
                chunk
            });
            assert!(chunks[1].blocks.len() > chunks[0].blocks.len());
            for member in 0..CLUSTER {
                let [a, b] = chunks.each_ref().map(|chunk| lanes_of(chunk, member, near));
                assert_eq!(a, b, "{len:?}, {member}");
                let lists = |slot| a.iter().flatten().any(|lane| *lane == Some(slot));
                assert!(lists(500) && lists(501) && lists(720));
            }
        }
    }

    #[test]
    fn a_list_contains_each_slot_once_for_every_member_that_it_is_near_to() {
        for len in [[4, 0, 0], [68, 28, 28], [64, 33, 12], [70, 16, 48], [5, 3, 1], [90, 5, 47]] {
            // One base for all blocks, and a base of its own for each block.
            for base in [Some(0), None] {
                let mut chunk =
                    ClusterChunk { end_slot: CLUSTER as u32, ..ClusterChunk::default() };
                chunk.push((&mut found(len), &[]), false, base, None);
                chunk.finish();
                let total = len.iter().sum();
                assert!(chunk.is_valid(total) && !chunk.is_valid(total - 1));
                let mut cut = chunk.clone();
                cut.spans[0].end += 1;
                assert!(!cut.is_valid(total));
                let (_, list) = chunk.lists().next().unwrap();
                let [all, first, second] = len.map(|len| len as u32);
                for member in 0..CLUSTER {
                    let mut listed: Vec<u32> =
                        list.for_member(member).flat_map(Block::slots).collect();
                    listed.sort_unstable();
                    assert!(listed.is_sorted_by(|a, b| a < b), "{len:?}: {listed:?}");
                    assert!(listed.iter().all(|slot| *slot < all + first + second));
                    let own = if member < 2 {
                        all..all + first
                    } else {
                        all + first..all + first + second
                    };
                    for slot in (0..all).chain(own) {
                        assert!(listed.contains(&slot), "{len:?}: {slot} for {member}");
                    }
                }
                let halves = [list.first_half.len(), list.second_half.len()];
                assert_eq!(halves, worthwhile(len));
                let entries = chunk.blocks.iter().flat_map(|block| block.entries);
                assert!(
                    entries
                        .into_iter()
                        .all(|entry| u32::from(entry / ENTRY_SCALE) < all + first + second)
                );
            }
        }
    }

    #[test]
    fn a_block_that_one_base_does_not_reach_is_parted_and_each_slot_keeps_its_lane() {
        let apart = |k: u32| (k % 3) * 40_000 + k;
        let slots: Vec<u32> = (50_000..50_004).chain((4..BLOCK as u32).map(apart)).collect();
        for len in 1..=BLOCK {
            let mut blocks = Vec::new();
            push(&slots[..len], None, &mut blocks);
            for (k, slot) in slots.iter().enumerate() {
                let found: Vec<u32> = blocks.iter().filter_map(|block| block.slot(k)).collect();
                assert_eq!(found, if k < len { vec![*slot] } else { vec![] });
            }
            let members = len.min(CLUSTER);
            assert_eq!(blocks[0].slots().take(members).collect::<Vec<_>>(), slots[..members]);
        }
        // Near and far ones in full blocks: what is parted is masked, with all before it.
        let near: Vec<u32> = (0..40).collect();
        let far: Vec<u32> = (0..51).map(|k| 50_000 + k + u32::from(k >= 20) * 50_000).collect();
        let mut blocks = Vec::new();
        let masked = pack([&near, &far], Some(0), CLUSTER, &mut blocks);
        assert_eq!((masked, blocks.len()), (7, 8));
        let lanes: Vec<u32> = blocks.iter().map(|block| block.valid.count_ones()).collect();
        assert_eq!(lanes, [8, 3, 16, 16, 16, 1, 15, 16]);
    }
}
