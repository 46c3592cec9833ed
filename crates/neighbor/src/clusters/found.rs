//! The neighbors of one cluster, as the search finds them, around a group of particles and without excluded pairs.

use std::ops::Range;

use lennard_core::Exclusions;

use crate::clusters::block::Block;
use crate::clusters::format::{BLOCK, CLUSTER};
use crate::sort::{ColumnTable, PADDING};

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
    #[inline(always)]
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

    /// Closes up the neighbors over the members, which stay at the beginning alone.
    pub(super) fn leave_out(&mut self, members: &Range<u32>) {
        for (kind, slots) in self.slots.iter_mut().enumerate() {
            let first = if kind == ALL_MEMBERS { members.len() } else { 0 };
            let mut kept = first;
            for at in first..self.len[kind] {
                let slot = slots[at];
                slots[kept] = slot;
                kept += usize::from(!members.contains(&slot));
            }
            self.len[kind] = kept;
        }
    }

    /// Moves the neighbors in runs of far columns, which follow all others, to `far`, neighbors of all members first.
    pub(super) fn part(&mut self, far_runs: &[Range<u32>], far: &mut Vec<u32>) {
        let is_near = |slot: &u32| !far_runs.iter().any(|run| run.contains(slot));
        for (slots, len) in self.slots.iter().zip(&mut self.len) {
            let slots = &slots[..*len];
            *len = slots.partition_point(is_near);
            far.extend_from_slice(&slots[*len..]);
        }
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

// The pairs of a cluster that do not interact, besides each member with itself.

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

// The bounds of a group of particles, and the candidates around it.

/// The bounding box of a group of particles, and the search radius around it.
#[derive(Debug, Clone, Copy)]
pub struct GroupBounds {
    /// The middle of the bounding box, in fixed point.
    pub middle: [i32; 3],
    /// Distance from the middle to the faces along each axis, σ, rounded up.
    pub half: [f32; 3],
    /// Length of a fixed-point unit along each axis, σ.
    pub scale: [f32; 3],
    /// Sides of the periodic box, σ, where distances from the middle must be folded; otherwise none.
    pub folds: Option<[f32; 3]>,
    /// The square of the search radius, σ², with a margin for all rounding.
    pub radius2: f32,
}

impl GroupBounds {
    /// A point in fixed point relative to the middle, σ.
    #[inline(always)]
    #[must_use]
    pub fn relative(&self, at: [i32; 3]) -> [f32; 3] {
        let axis = |axis: usize| at[axis].wrapping_sub(self.middle[axis]) as f32 * self.scale[axis];
        [axis(0), axis(1), axis(2)]
    }

    /// The search sphere around a point o relative to the middle, as t = −2·o and the limit R² − |o|².
    ///
    /// A candidate c lies in it where |c|² + t·c is at most the limit. This holds where nothing is folded.
    #[inline(always)]
    #[must_use]
    pub fn sphere(&self, [x, y, z]: [f32; 3]) -> ([f32; 3], f32) {
        let limit = self.radius2 - (x * x + y * y + z * z);
        ([-2.0 * x, -2.0 * y, -2.0 * z], limit)
    }
}

/// The candidates around a group, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct GroupCandidates {
    /// Coordinates along each axis relative to the middle of the group, σ.
    pub at: [Vec<f32>; 3],
    /// Square of the distance from the middle of the group, σ².
    pub square: Vec<f32>,
    /// Slot of each candidate.
    pub slot: Vec<u32>,
    /// Count of candidates; elements behind them have no meaning.
    pub len: usize,
}

impl GroupCandidates {
    /// Makes room for the slots of `runs` and two registers more, and checks that the runs contain slots only. Coordinates
    /// of the table have a register of padding.
    ///
    /// # Panics
    /// Where a run contains something else than slots: that is a bug of the caller.
    pub fn make_room(&mut self, table: &ColumnTable, runs: &[Range<u32>]) {
        let slots = table.particle.len();
        let mut total = 2 * PADDING;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= slots);
            total += (run.end - run.start) as usize;
        }
        if self.slot.len() < total {
            for axis in &mut self.at {
                axis.resize(total, 0.0);
            }
            self.square.resize(total, 0.0);
            self.slot.resize(total, 0);
        }
    }
}
