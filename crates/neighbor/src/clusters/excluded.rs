//! The pairs of a cluster that do not interact, besides each member with itself.

use std::ops::Range;

use lennard_core::Exclusions;

use super::block::Block;
use super::format::{BLOCK, CLUSTER};

/// The entries of a block that each member of a cluster does not look at, one bit each.
pub type ExcludedEntries = [u16; CLUSTER];

/// The entries that members do not look at in the first masked block where no pair is excluded: themselves.
pub const THEMSELVES: ExcludedEntries = [0b0001, 0b0010, 0b0100, 0b1000];

/// The slots that the members of one cluster do not interact with.
#[derive(Debug, Default, Clone)]
pub struct Excluded {
    /// Member and slot of each excluded pair, itself among them.
    pairs: Vec<(usize, u32)>,
    /// The slots that are no members, each once.
    slots: Vec<u32>,
}

impl Excluded {
    /// Finds the excluded pairs of the cluster at `members`.
    pub fn find(
        &mut self,
        exclusions: &Exclusions,
        members: Range<u32>,
        particle: &[u32],
        slot_of: &[u32],
    ) {
        self.pairs.clear();
        self.slots.clear();
        for (member, own) in members.clone().enumerate() {
            self.pairs.push((member, own));
            for other in exclusions.of(particle[own as usize]) {
                let slot = slot_of[other as usize];
                self.pairs.push((member, slot));
                if !members.contains(&slot) && !self.slots.contains(&slot) {
                    self.slots.push(slot);
                }
            }
        }
    }

    /// The slots that are no members, each once.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// The entries of a block that each member does not look at.
    pub fn entries(&self, block: &Block) -> ExcludedEntries {
        let mut excluded = [0; CLUSTER];
        for k in 0..BLOCK {
            let Some(slot) = block.slot(k) else { continue };
            for (member, other) in &self.pairs {
                if *other == slot {
                    excluded[*member] |= 1 << k;
                }
            }
        }
        excluded
    }
}
