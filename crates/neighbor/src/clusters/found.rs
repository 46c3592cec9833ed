//! The neighbors of one cluster, as the search finds them.

use std::ops::Range;

use super::excluded::Excluded;
use super::format::{BLOCK, BLOCK_REACH, CLUSTER};
use super::group::GroupCandidates;
use crate::sort::PADDING;

/// The most excluded slots of a cluster: two for each member.
pub(super) const MOST_EXCLUDED: usize = 2 * CLUSTER;

/// Index in [`ClusterNeighbors`]: near to a member of the first half and to a member of the second half.
pub const ALL_MEMBERS: usize = 0;
/// Index in [`ClusterNeighbors`]: near to a member of the first half, and to no member of the second half.
pub const FIRST_HALF: usize = 1;
/// Index in [`ClusterNeighbors`]: near to a member of the second half, and to no member of the first half.
pub const SECOND_HALF: usize = 2;

/// The neighbors of a cluster, sorted by the members that they are near to.
#[derive(Debug, Default, Clone)]
pub struct ClusterNeighbors {
    /// Slots, by [`ALL_MEMBERS`], [`FIRST_HALF`] and [`SECOND_HALF`].
    pub slots: [Vec<u32>; 3],
    /// Count of slots of each kind; elements behind them have no meaning.
    pub len: [usize; 3],
    /// Scratch of [`ClusterNeighbors::near_first`].
    far: Vec<u32>,
}

impl ClusterNeighbors {
    /// Makes room for all candidates, and begins with the members themselves.
    pub(super) fn begin(&mut self, members: Range<u32>, candidates: &GroupCandidates) {
        let room = CLUSTER + MOST_EXCLUDED + candidates.len + PADDING;
        for slots in &mut self.slots {
            if slots.len() < room {
                slots.resize(room, 0);
            }
        }
        self.len = [members.len(), 0, 0];
        for (slot, member) in self.slots[ALL_MEMBERS].iter_mut().zip(members) {
            *slot = member;
        }
    }

    /// Checks that there is room for all candidates and one register more, and that one register behind the last
    /// candidate can be read.
    ///
    /// # Panics
    /// Where an array is too short: that is a bug of the caller.
    pub fn check(&self, candidates: &GroupCandidates) {
        for axis in &candidates.at {
            assert!(axis.len() >= candidates.len + PADDING);
        }
        assert!(candidates.square.len() >= candidates.len + PADDING);
        assert!(candidates.slot.len() >= candidates.len + PADDING);
        for (slots, len) in self.slots.iter().zip(self.len) {
            assert!(slots.len() >= len + candidates.len + PADDING);
        }
    }

    /// The slots of one kind.
    pub(super) fn of(&self, kind: usize) -> &[u32] {
        &self.slots[kind][..self.len[kind]]
    }

    /// The next slots of one kind, from an element on, and the number of them that count.
    pub(super) fn next_of(&self, kind: usize, from: usize) -> (&[u32; BLOCK], usize) {
        const { assert!(BLOCK <= PADDING) };
        let next = self.slots[kind][from..].first_chunk().expect("room");
        (next, (self.len[kind] - from).min(BLOCK))
    }

    /// Reorders the neighbors of all members: the members and the slots that one base reaches first, the others last.
    ///
    /// The others are in ascending order. Returns the number of slots in the first part, and the base.
    pub(super) fn near_first(&mut self) -> (usize, u32) {
        let slots = &mut self.slots[ALL_MEMBERS][..self.len[ALL_MEMBERS]];
        let (low, high) =
            slots.iter().fold((u32::MAX, 0), |(low, high), p| (low.min(*p), high.max(*p)));
        if high.saturating_sub(low) <= BLOCK_REACH {
            return (slots.len(), low);
        }
        let around_the_members = slots[0].saturating_sub(BLOCK_REACH / 2);
        let base = around_the_members.min(high - BLOCK_REACH).max(low);
        self.far.clear();
        let mut near = 0;
        for at in 0..slots.len() {
            let slot = slots[at];
            // A slot below the base wraps around to a number beyond any reach.
            if slot.wrapping_sub(base) <= BLOCK_REACH {
                slots[near] = slot;
                near += 1;
            } else {
                self.far.push(slot);
            }
        }
        self.far.sort_unstable();
        slots[near..].copy_from_slice(&self.far);
        (near, base)
    }

    /// Moves the excluded slots that are no members right behind the members, among the neighbors of all members.
    ///
    /// A slot that was not near is added: the loop then knows of each excluded pair.
    pub(super) fn bring_forward(&mut self, members: usize, excluded: &Excluded) {
        for (to, slot) in (members..).zip(excluded.slots()) {
            for kind in [FIRST_HALF, SECOND_HALF] {
                let len = self.len[kind];
                let slots = &mut self.slots[kind];
                if let Some(at) = slots[..len].iter().position(|near| *near == *slot) {
                    slots.copy_within(at + 1..len, at);
                    self.len[kind] -= 1;
                }
            }
            let slots = &mut self.slots[ALL_MEMBERS];
            let len = self.len[ALL_MEMBERS];
            let at = match slots[..len].iter().position(|near| *near == *slot) {
                Some(at) => at,
                None => {
                    slots[len] = *slot;
                    self.len[ALL_MEMBERS] += 1;
                    len
                }
            };
            slots[to..=at].rotate_right(1);
        }
    }

    /// Takes excluded slots off the neighbors of all members, from an element on, and returns them.
    pub(super) fn take_excluded(&mut self, from: usize, excluded: &Excluded) -> Vec<u32> {
        let len = self.len[ALL_MEMBERS];
        let slots = &mut self.slots[ALL_MEMBERS];
        let (mut kept, mut taken) = (from, Vec::new());
        for at in from..len {
            let slot = slots[at];
            if excluded.slots().contains(&slot) {
                taken.push(slot);
            } else {
                slots[kept] = slot;
                kept += 1;
            }
        }
        self.len[ALL_MEMBERS] = kept;
        taken
    }

    /// Appends the neighbors of one half, from an element on, to the neighbors of all members.
    pub(super) fn give_to_all(&mut self, half: usize, from: usize) {
        let [for_all, halves @ ..] = &mut self.slots;
        let rest = self.len[half] - from;
        // Whole registers are copied: both arrays have room for one register more.
        for at in (0..rest).step_by(PADDING) {
            let some: &[u32; PADDING] = halves[half - 1][from + at..].first_chunk().expect("room");
            let to = self.len[ALL_MEMBERS] + at;
            for_all[to..to + PADDING].copy_from_slice(some);
        }
        self.len[ALL_MEMBERS] += rest;
    }
}
