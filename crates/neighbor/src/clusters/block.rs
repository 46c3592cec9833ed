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

use super::format::{BLOCK, BLOCK_REACH, ENTRY_SCALE};

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
