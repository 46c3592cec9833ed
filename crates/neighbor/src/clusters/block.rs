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

    /// A block of the first `count` of some slots.
    ///
    /// `base` is a base that is known to reach them all. Without it, the block takes their lowest slot as its base.
    /// `None` where that base does not reach them.
    pub(super) fn of_first(slots: &[u32; BLOCK], count: usize, base: Option<u32>) -> Option<Self> {
        let base = base.or_else(|| base_of(&slots[..count]))?;
        let mut entries = [0; BLOCK];
        for ((entry, slot), k) in entries.iter_mut().zip(slots).zip(0..) {
            // There is no branch: an entry that does not count numbers the base.
            let counts = if k < count as u16 { u16::MAX } else { 0 };
            *entry = (slot.wrapping_sub(base) as u16).wrapping_mul(ENTRY_SCALE) & counts;
        }
        Some(Self { base, valid: u16::MAX >> (BLOCK - count), entries })
    }

    /// A block of 1 to [`BLOCK`] slots.
    pub(super) fn of(base: u32, slots: &[u32]) -> Self {
        let mut all = [base; BLOCK];
        all[..slots.len()].copy_from_slice(slots);
        Self { valid: u16::MAX >> (BLOCK - slots.len()), ..Self::full(base, &all) }
    }

    /// Whether the block contains a slot.
    pub(super) fn contains(&self, slot: u32) -> bool {
        self.slots().any(|contained| contained == slot)
    }

    /// Inserts a slot where an entry is free and the base reaches it; returns whether it did.
    pub(super) fn insert(&mut self, slot: u32) -> bool {
        let free = self.valid.trailing_ones() as usize;
        let reaches = (self.base..=self.base + BLOCK_REACH).contains(&slot);
        if free < BLOCK && reaches {
            self.valid |= 1 << free;
            self.entries[free] = (slot - self.base) as u16 * ENTRY_SCALE;
        }
        free < BLOCK && reaches
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

/// Writes slots that a base reaches into blocks, masked blocks before full ones; returns the end of the masked blocks.
///
/// The masked blocks hold at least the first `head` slots: the members, and what they do not interact with.
pub(super) fn pack(list: &[u32], base: u32, head: usize, blocks: &mut Vec<Block>) -> usize {
    // The first block takes the slots that do not fill whole blocks.
    let rest = list.len() % BLOCK;
    let lead = match rest {
        0 => BLOCK,
        rest if rest < head => (BLOCK + rest).min(list.len()),
        _ => rest,
    };
    let (lead, full) = list.split_at(lead);
    if lead.len() < BLOCK
        && let Some(slots) = list.first_chunk()
    {
        // An entry that does not count may number any slot.
        let mut block = Block::full(base, slots);
        block.valid = u16::MAX >> (BLOCK - lead.len());
        blocks.push(block);
    } else {
        blocks.extend(lead.chunks(BLOCK).map(|slots| Block::of(base, slots)));
    }
    let masked = blocks.len();
    let (full, none) = full.as_chunks();
    debug_assert!(none.is_empty(), "the rest fills whole blocks");
    blocks.extend(full.iter().map(|slots| Block::full(base, slots)));
    masked
}

/// Writes ascending slots into further blocks, each with a base of its own.
///
/// `masked` is the end of the masked blocks of [`pack`]; the result is their new end.
pub(super) fn pack_far(mut list: &[u32], mut masked: usize, blocks: &mut Vec<Block>) -> usize {
    while let Some(base) = list.first() {
        let (within_reach, beyond) =
            list.split_at(list.partition_point(|slot| slot - base <= BLOCK_REACH));
        let (full, rest) = within_reach.as_chunks();
        blocks.extend(full.iter().map(|slots| Block::full(*base, slots)));
        if !rest.is_empty() {
            blocks.insert(masked, Block::of(*base, rest));
            masked += 1;
        }
        list = beyond;
    }
    masked
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

    #[test]
    fn a_list_contains_each_slot_once_for_every_member_that_it_is_near_to() {
        for len in [[4, 0, 0], [68, 28, 28], [64, 33, 12], [70, 16, 48], [5, 3, 1], [90, 5, 47]] {
            // One base for all blocks, and a base of its own for each block.
            for base in [Some(0), None] {
                let mut chunk = ClusterChunk::default();
                chunk.push(&mut found(len), false, base, None);
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
}
